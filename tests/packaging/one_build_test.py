#!/usr/bin/env python3
"""Demo, tests and benches share one build: none compiles again what another has compiled, in whatever order they come.

Runs the scripts' own functions (scripts/common.sh) in a build folder of its own, with a compiler and a linker that write empty
files, so that a whole build takes seconds; then a dry run of ninja says what would be built again. Exit 77 without ninja.
"""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop(1)).resolve()

# Called as `launcher compiler arguments...`. Writes the output, a program that lists no tests, and its dependency file. What CMake
# asks the compiler while it configures is passed on.
LAUNCHER = """#!/bin/sh
case $PWD in */CMakeFiles/*) exec "$@" ;; esac
while [ $# -gt 0 ]; do
  case $1 in
    -o) output=$2 ;;
    -MF) dependencies=$2 ;;
    -MT) target=$2 ;;
  esac
  shift
done
printf '#!/bin/sh\\nexit 0\\n' > "$output" && chmod +x "$output"
if [ -n "$dependencies" ]; then printf '%s:\\n' "$target" > "$dependencies"; fi
"""


class OneBuild(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="pelage-one-build-"))
        self.addCleanup(shutil.rmtree, self.folder)
        launcher = self.folder / "launcher"
        launcher.write_text(LAUNCHER)
        launcher.chmod(0o755)
        self.environment = {
            **{k: v for k, v in os.environ.items() if not k.startswith(("CMAKE_", "CTEST_"))},
            "PELAGE_BUILD_ROOT": str(self.folder / "build"),
            "CMAKE_CXX_COMPILER_LAUNCHER": str(launcher),
            "CMAKE_CXX_LINKER_LAUNCHER": str(launcher),
        }

    def run_script(self, text):
        done = subprocess.run(["bash", "-c", f"source scripts/common.sh\n{text}"], cwd=SOURCE, env=self.environment,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr[-3000:])
        return done.stdout

    def compiled_by(self, text):
        """Objects of the programs, tests and benches that a build function compiles."""
        return [line.split()[-1] for line in self.run_script(text).splitlines() if "Building CXX object" in line]

    def dry_run(self, *targets):
        """What ninja would do for these targets, when nothing has changed."""
        return [line for line in self.run_script(f'ninja -n -C "$build_root/release" {" ".join(targets)}').splitlines()
                if "Building" in line or "Linking" in line]

    def products(self, objects):
        return [name for name in objects if not name.startswith("tests/")]

    def test_tests_and_benches_after_the_demo(self):
        first = self.compiled_by("build_programs")
        self.assertGreater(len(first), 100)
        self.assertEqual(first, self.products(first), "the demo compiles programs only")
        tests = self.compiled_by("build_tests")
        self.assertGreater(len(tests), 50)
        self.assertEqual(self.products(tests), [])
        self.assertEqual(self.products(self.compiled_by("build_benches")), [])
        self.assertEqual(self.compiled_by("build_programs"), [], "the demo again")
        self.assertEqual(self.compiled_by("build_tests"), [], "the tests again")
        self.assertEqual(self.dry_run("pelage", "pelage-bake"), [])

    def test_demo_after_the_tests_and_after_a_configuration_without_them(self):
        self.assertGreater(len(self.compiled_by("build_tests")), 150)
        self.assertEqual(self.compiled_by("build_programs"), [])
        self.run_script("configure release -DPELAGE_BUILD_TESTS=OFF && build release all")  # by hand
        self.assertEqual(self.dry_run("pelage", "pelage-bake"), [])
        self.assertEqual(self.compiled_by("build_tests"), [], "objects of the tests are kept")
        found = self.run_script('ctest --test-dir "$build_root/release" -N')
        self.assertIn("packaging.one_build", found, "the tests are registered again")


if __name__ == "__main__":
    if not shutil.which("ninja"):
        print("ninja is not here: skipped")
        sys.exit(77)
    unittest.main()
