#!/usr/bin/env python3
"""Does docs/plot_record.py read what the program reads? Usage: plot_record_test.py PELAGE_BAKE SOURCE

Bakes a small database of either storage, runs the script as a reader would, and compares its arrays with `pelage-bake
query` at the record's own angles. Exit 77 (skipped) without numpy or matplotlib.
"""

import json
import os
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ["MPLBACKEND"] = "Agg"
try:
    import matplotlib  # noqa: F401
    import numpy as np
except ImportError as absent:
    print(f"skipped: {absent} (install python3-numpy and python3-matplotlib)")
    sys.exit(77)

VIEWS, LIGHTS, RECORD = 8, 6, 3


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def check(bake, script, storage, folder):
    settings = {"version": 1, "sectors": 6, "views": VIEWS, "lights": LIGHTS, "samples": 16, "storage": storage}
    (folder / "bake.json").write_text(json.dumps(settings))
    database, picture = folder / f"{storage} 50% #1?.hrir", folder / f"{storage}.png"
    output_of(bake, "build", "--settings", str(folder / "bake.json"), "-o", str(database), "--progress", "never")
    sys.argv = ["plot_record.py", str(database), str(RECORD), str(picture)]
    read = runpy.run_path(str(script))
    assert picture.stat().st_size > 5000, "the picture is empty"
    for view, light in [(0, 0), (2, 5), (7, 1)]:
        said = json.loads(output_of(bake, "query", str(database), "--record", str(RECORD), "--view", str(360 * view / VIEWS),
                                    "--light", str(360 * light / LIGHTS)))
        assert said["records"] == [{"record": RECORD, "weight": 1.0}], said["records"]
        # 1e-5: angles in float, and halves as 16 bits of their largest
        np.testing.assert_allclose(read["tau"][view], said["tau"], atol=1e-5 * read["tau"].max() + 1e-7)
        np.testing.assert_allclose(read["re"][view, light], said["re"], atol=3e-5 * read["re"].max())


def main():
    bake, source = sys.argv[1], Path(sys.argv[2])
    script = source / "docs" / "plot_record.py"
    code = [line for line in script.read_text().splitlines() if line and not line.startswith(('"""', "import"))]
    assert len(code) == 10, f"{len(code)} lines, promised are ten"
    with tempfile.TemporaryDirectory() as folder:
        for storage in ("u8", "half"):
            check(bake, script, storage, Path(folder))


main()
