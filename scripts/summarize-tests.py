#!/usr/bin/env python3
"""Prints one line about a test run: tests run, failed, skipped and why, seconds fuzzed.

Reads the JUnit file that ctest writes (--output-junit). Exits with 1 where a test failed, none ran, or there is no report.
"""

import argparse
import re
import sys
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

MISSING_DATA = "real grooms are not in ../shared/data: docs/test-data.md says where to get them"


def skip_reason(case):
    """The sentence that a skipped test printed: GoogleTest puts it below 'Skipped', the Python tests print it last."""
    output = case.findtext("system-out") or ""
    found = re.search(r": Skipped\n(.*?)\n\n?\[", output, re.DOTALL)
    lines = [line.strip() for line in (found[1] if found else output).splitlines() if line.strip()]
    reason = " ".join(lines) if found else (lines[-1] if lines else "no reason given")
    return MISSING_DATA if "shared/data" in reason else reason


def summary(report, fuzzed):
    """Returns the line and whether all is well."""
    cases = ElementTree.parse(report).getroot().findall("testcase")
    state = Counter(case.get("status") for case in cases)
    failed, skipped, run = state["fail"], state["notrun"] + state["disabled"], state["run"] + state["fail"]
    reasons = Counter(skip_reason(case) for case in cases if case.get("status") in ("notrun", "disabled"))
    why = "; ".join(f"{count}: {reason}" for reason, count in sorted(reasons.items()))
    line = f"tests: {run} run, {failed} failed, {skipped} skipped" + (f" ({why})" if why else "")
    line += f", readers fuzzed for {fuzzed} s each" if fuzzed else ", readers not fuzzed"
    return line, failed == 0 and run > 0


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("report", type=Path)
    parser.add_argument("--fuzzed", type=int, default=0, help="seconds that each reader was fuzzed [0]")
    options = parser.parse_args()
    if not options.report.exists():
        print(f"tests: none run: ctest wrote no {options.report}")
        return 1
    line, good = summary(options.report, options.fuzzed)
    print(line)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
