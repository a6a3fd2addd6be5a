#!/usr/bin/env python3
"""The last line of scripts/test.sh: what it says, and when it fails."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop(1)).resolve()

GOOGLETEST_SKIP = """Note: Google Test filter = A.B
[ RUN      ] A.B
/somewhere/a_test.cpp:12: Skipped
../shared/data is not here:
get it

[  SKIPPED ] A.B (0 ms)
"""


def case(name, status, output=""):
    return f'<testcase name="{name}" status="{status}"><system-out>{output}</system-out></testcase>'


class Summary(unittest.TestCase):
    def summarize(self, cases, *options):
        with tempfile.TemporaryDirectory() as folder:
            report = Path(folder) / "tests.xml"
            if cases is not None:
                report.write_text(f'<?xml version="1.0"?><testsuite>{"".join(cases)}</testsuite>')
            done = subprocess.run([sys.executable, SOURCE / "scripts/summarize-tests.py", report, *options],
                                  capture_output=True, text=True)
            return done.returncode, done.stdout

    def test_counts_and_reasons_on_one_line(self):
        code, line = self.summarize([case("a", "run"), case("b", "run"), case("c", "notrun", GOOGLETEST_SKIP),
                                     case("d", "notrun", GOOGLETEST_SKIP), case("e", "notrun", "no dpkg here: skipped\n")],
                                    "--fuzzed", "60")
        self.assertEqual(code, 0)
        self.assertEqual(line, "tests: 2 run, 0 failed, 3 skipped (1: no dpkg here: skipped; 2: real grooms "
                               "are not in ../shared/data: docs/test-data.md says where to get them), readers fuzzed for 60 s each\n")

    def test_a_failure_fails(self):
        code, line = self.summarize([case("a", "run"), case("b", "fail")])
        self.assertEqual((code, line), (1, "tests: 2 run, 1 failed, 0 skipped, readers not fuzzed\n"))

    def test_nothing_run_is_a_failure(self):
        self.assertEqual(self.summarize([])[0], 1)
        self.assertEqual(self.summarize([case("a", "notrun")])[0], 1)
        code, line = self.summarize(None)
        self.assertEqual(code, 1)
        self.assertIn("none run", line)


if __name__ == "__main__":
    unittest.main()
