#!/usr/bin/env python3
"""ci/spread.py: builds must come to the same verdicts, and their values lie apart by so much of the limit."""
import unittest

from scripts import call, check, run_of


class Spread(unittest.TestCase):
    def test_the_largest_spread_of_each_kind_over_its_limit(self):
        code, out, err = call("ci/spread.py", run_of(check("a", 1.0, 10.0), check("b", 3.0, 4.0), check("c", 1.0, 2.0, kind="tube")),
                              run_of(check("a", 2.0, 10.0), check("b", 1.0, 4.0), check("c", 1.0, 2.0, kind="tube")),
                              run_of(check("a", 6.0, 10.0), check("b", 2.0, 4.0), check("c", 1.0, 2.0, kind="tube")))
        self.assertEqual((code, err), (0, ""))
        lines = [line.split() for line in out.splitlines()]
        self.assertEqual(lines[0][:5], ["3", "checks", "of", "3", "builds;"])
        self.assertEqual(lines[1:], [["oracle", "0.5", "a/b:", "b"], ["tube", "0", "a/b:", "c"]])

    def fault(self, *runs):
        code, _, err = call("ci/spread.py", *runs)
        self.assertEqual(code, 1)
        return err

    def test_another_verdict_fails_however_close_the_values(self):
        err = self.fault(run_of(check("a", 1.0, 1.0)), run_of(check("a", 1.0000001, 1.0, "fail")))
        self.assertIn("a/b: a: verdict pass (1.0)", err)

    def test_another_limit_fails(self):
        self.assertIn("limit", self.fault(run_of(check("a", 1.0, 2.0)), run_of(check("a", 1.0, 3.0))))

    def test_a_check_or_scenario_that_is_missing_fails(self):
        both, one = run_of(check("a", 1.0, 2.0), check("b", 1.0, 2.0)), run_of(check("a", 1.0, 2.0))
        self.assertIn("a/b: b: not in", self.fault(both, one))
        self.assertIn("a/b: b: not in", self.fault(one, both))
        self.assertIn("c: a: not in", self.fault(one, run_of(check("a", 1.0, 2.0), scenario="c")))

    def test_a_check_that_is_made_twice_is_compared_twice(self):
        twice = run_of(check("a", 1.0, 2.0), check("a", 1.5, 2.0))
        self.assertEqual(call("ci/spread.py", twice, twice)[0], 0)
        self.assertIn("a/b: a: not in", self.fault(twice, run_of(check("a", 1.0, 2.0))))

    def test_no_number_in_one_build_alone_is_an_infinite_spread(self):
        _, out, _ = call("ci/spread.py", run_of(check("a", None, 1.0, "fail")), run_of(check("a", 2.0, 1.0, "fail")))
        self.assertIn("inf", out)

    def test_nothing_compared_is_no_success(self):
        self.fault(run_of(), run_of())
        self.assertEqual(call("ci/spread.py", run_of(check("a", 1.0, 2.0)))[0], 2, "one build alone")
        self.assertEqual(call("ci/spread.py", run_of(check("a", 1.0, 2.0)), "no JSON")[0], 2)


unittest.main()
