#!/usr/bin/env python3
"""The check of the hard cases finds each thing that it is there to find. Usage: check_test.py SOURCE"""

import copy
import importlib.util
import json
import sys
import unittest
from pathlib import Path

SOURCE = Path(sys.argv.pop(1))
spec = importlib.util.spec_from_file_location("hard_cases", SOURCE / "scripts/document-hard-cases.py")
hard_cases = importlib.util.module_from_spec(spec)
spec.loader.exec_module(hard_cases)


class Check(unittest.TestCase):
    def setUp(self):
        self.cases = json.loads(hard_cases.MANIFEST.read_text())
        # A build that has what is named.
        self.tests = {p.replace("*", "a"): {"fast", "hard"} for p in hard_cases.patterns_of(self.cases)}
        self.tests["Other.Test"] = {"fast"}

    def test_nothing_where_nothing_is(self):
        self.assertEqual([], list(hard_cases.faults_of_manifest(self.cases)))
        self.assertEqual([], list(hard_cases.faults_of_build(self.cases, self.tests)))

    def test_a_case_without_sub_case_or_test(self):
        for place, case in enumerate(self.cases):
            without = copy.deepcopy(self.cases)
            without[place]["sub_cases"] = []
            self.assertEqual([f"case {case['case']} has no sub-case"], list(hard_cases.faults_of_manifest(without)))
        del self.cases[4]
        self.assertIn("case 5 is there 0 times", list(hard_cases.faults_of_manifest(self.cases)))
        self.cases[0]["sub_cases"][0]["tests"] = []
        self.assertIn("has no test", " ".join(hard_cases.faults_of_manifest(self.cases)))

    def test_a_case_found_since_may_be_missing_but_not_twice(self):
        last = self.cases[-1]
        self.assertGreater(last["case"], hard_cases.CASES)
        self.assertEqual([], list(hard_cases.faults_of_manifest(self.cases[:-1])))
        twice = self.cases + [last]
        self.assertEqual([f"case {last['case']} is there 2 times"], list(hard_cases.faults_of_manifest(twice)))

    def test_a_name_that_is_no_test(self):
        for name in ["DensityMapThreads.GiveTheSameBits", "Simulation/TipsDoNotFly.a"]:
            renamed = dict(self.tests)
            del renamed[name]
            self.assertEqual(1, len(list(hard_cases.faults_of_build(self.cases, renamed))), name)

    def test_a_label_too_few_or_too_many(self):
        self.tests["DensityMapThreads.GiveTheSameBits"] = {"fast"}
        self.tests["Other.Test"] = {"hard"}
        self.assertEqual(["DensityMapThreads.GiveTheSameBits lacks the label hard",
                          "Other.Test has the label hard and is in no case"],
                         list(hard_cases.faults_of_build(self.cases, self.tests)))

    def test_a_table_that_is_another(self):
        table = hard_cases.document(self.cases, lambda tests: "1 of 2 skipped")
        self.assertEqual([], list(hard_cases.faults_of_table(self.cases, table)))
        self.assertEqual(1, len(list(hard_cases.faults_of_table(self.cases, table.replace("T = 1", "T = 2", 1)))))
        self.assertEqual(1, len(list(hard_cases.faults_of_table(self.cases, table.replace("skipped", "failed", 1)))))
        self.cases[0]["sub_cases"][0]["what"] += " and more"
        self.assertEqual(1, len(list(hard_cases.faults_of_table(self.cases, table))))

    def test_verdicts(self):
        results = {"A.b": "passed", "P/C.d/0": "passed", "P/C.d/1": "skipped"}
        self.assertEqual("passed", hard_cases.verdict(["A.b"], results))
        self.assertEqual("1 of 3 skipped", hard_cases.verdict(["A.b", "P/C.d/*"], results))
        self.assertEqual("1 of 1 failed", hard_cases.verdict(["Not.run"], results))


if __name__ == "__main__":
    unittest.main()
