#!/usr/bin/env python3
"""Writes docs/hard-cases.md: every hard case, what is tested, what happens, by which tests, and whether they passed.

The cases are tests/hard/cases.json; ctest runs their tests under the label `hard`. Without options the tests are run;
--results reads what `ctest -L hard --output-junit FILE` wrote. --check runs nothing: it fails when a case has no test,
when a name is no test of the build, when other tests than these have the label, or when the table is not the manifest's.
"""

import argparse
import fnmatch
import json
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as xml
from pathlib import Path

SOURCE = Path(__file__).resolve().parent.parent
MANIFEST = SOURCE / "tests/hard/cases.json"
TABLE = SOURCE / "docs/hard-cases.md"
CASES = 32  # that must be there
LAST = 41   # of those found since, which are there once they have tests

HEAD = """# Hard cases
What breaks, and what happens instead: the table is `tests/hard/cases.json`, its last column the run of `ctest -L hard` by
which `scripts/document-hard-cases.py` wrote this file. `*` stands for every instance of a parametrised test.
"""


def bare(name):
    """Without what GoogleTest's discovery adds of a parameter's value."""
    return name.split("  # GetParam()")[0]


def tests_of(build):
    """Name -> labels of every test that ctest knows in `build`."""
    answer = subprocess.run(["ctest", "--show-only=json-v1"], cwd=build, check=True, capture_output=True, text=True)
    found = {}
    for test in json.loads(answer.stdout)["tests"]:
        labels = [p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"]
        found[bare(test["name"])] = set(labels[0]) if labels else set()
    return found


def matching(pattern, names):
    return fnmatch.filter(names, pattern.replace("[", "[[]"))


def patterns_of(cases):
    return {pattern for case in cases for sub_case in case["sub_cases"] for pattern in sub_case["tests"]}


def faults_of_manifest(cases):
    """What the manifest lacks by itself."""
    numbers = [case["case"] for case in cases]
    for number in range(1, LAST + 1):
        count = numbers.count(number)
        if count > 1 or (count == 0 and number <= CASES):
            yield f"case {number} is there {count} times"
    if numbers != sorted(numbers) or set(numbers) - set(range(1, LAST + 1)):
        yield f"cases are not 1 to {LAST} in order"
    for case in cases:
        if not case["sub_cases"]:
            yield f"case {case['case']} has no sub-case"
        for sub_case in case["sub_cases"]:
            name = f"case {case['case']}, \"{sub_case['what']}\""
            if not sub_case["tests"]:
                yield name + " has no test"
            if not sub_case["outcome"]:
                yield name + " has no outcome"
            if len(set(sub_case["tests"])) != len(sub_case["tests"]):
                yield name + " names a test twice"


def faults_of_build(cases, tests):
    """What manifest and build do not agree about."""
    wanted = set()
    for pattern in sorted(patterns_of(cases)):
        found = matching(pattern, tests)
        if not found:
            yield f"{pattern} is no test of this build: renamed or deleted?"
        wanted.update(found)
    for name in sorted(wanted):
        if "hard" not in tests[name]:
            yield f"{name} lacks the label hard"
    for name, labels in sorted(tests.items()):
        if "hard" in labels and name not in wanted:
            yield f"{name} has the label hard and is in no case"


def run(build):
    """Runs the label; name -> status."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "results.xml"
        subprocess.run(["ctest", "-L", "^hard$", "--output-on-failure", "--output-junit", str(file)], cwd=build)
        return read_results(file)


def read_results(file):
    """Name -> passed, skipped or failed, of a JUnit file of ctest."""
    results = {}
    for case in xml.parse(file).getroot().iter("testcase"):
        skipped = case.find("skipped") is not None or case.get("status") == "notrun"
        failed = case.find("failure") is not None or case.get("status") == "fail"
        results[bare(case.get("name"))] = "failed" if failed else "skipped" if skipped else "passed"
    return results


def verdict(patterns, results):
    """"passed", or how many of how many were not."""
    states = [results.get(name, "failed") for pattern in patterns for name in matching(pattern, results) or [pattern]]
    bad = [f"{states.count(state)} of {len(states)} {state}" for state in ("failed", "skipped") if state in states]
    return ", ".join(bad) or "passed"


def rows(cases, result_of):
    yield "| case | what is tested | outcome | tests | result |"
    yield "|---|---|---|---|---|"
    for case in cases:
        for place, sub_case in enumerate(case["sub_cases"]):
            first = f"**{case['case']}** {case['title']}" if place == 0 else ""
            cells = [first, sub_case["what"], sub_case["outcome"],
                     ", ".join(f"`{t}`" for t in sub_case["tests"]), result_of(sub_case["tests"])]
            yield "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def document(cases, result_of):
    return HEAD + "\n" + "\n".join(rows(cases, result_of)) + "\n"


def without_results(text):
    return re.sub(r"\| [^|]* \|$", "| |", text, flags=re.MULTILINE)


def faults_of_table(cases, text):
    if without_results(text) != without_results(document(cases, lambda tests: "passed")):
        yield "docs/hard-cases.md is not what tests/hard/cases.json says: run scripts/document-hard-cases.py"
    if re.search(r"\d failed", text):
        yield "docs/hard-cases.md shows failed tests"


def check(cases, build):
    tests = tests_of(build)
    unbuilt = [name for name in tests if name.endswith("_NOT_BUILT")]
    faults = list(faults_of_manifest(cases))
    faults += faults_of_table(cases, TABLE.read_text() if TABLE.exists() else "")
    faults += [] if unbuilt else faults_of_build(cases, tests)
    for fault in faults:
        print(fault)
    if unbuilt and not faults:
        print(f"{', '.join(unbuilt)}: names of tests not looked at")
        return 77
    print(f"{len(cases)} cases, {sum(len(c['sub_cases']) for c in cases)} sub-cases, {len(faults)} faults")
    return 1 if faults else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default=SOURCE / "build/release", type=Path, help="build folder [build/release]")
    parser.add_argument("--results", type=Path, help="JUnit file of a run that has been")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    cases = json.loads(MANIFEST.read_text())
    if options.check:
        return check(cases, options.build)
    results = read_results(options.results) if options.results else run(options.build)
    TABLE.write_text(document(cases, lambda tests: verdict(tests, results)))
    failed = sorted(name for name, state in results.items() if state == "failed")
    print(f"{TABLE.relative_to(SOURCE)}: {len(results)} tests, {len(failed)} failed {' '.join(failed)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
