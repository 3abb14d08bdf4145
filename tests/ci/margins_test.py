#!/usr/bin/env python3
"""ci/margins.py: which checks use hardly any of their tolerance, and which nearly all."""
import unittest

from scripts import call, check, run_of


def sections(out):
    """Names of the checks listed as too close to their limit, and as too far from it."""
    close, far = out.split("less than")
    return [[line.split(": ")[1].split(" (")[0] for line in part.splitlines() if line.startswith("   ")]
            for part in (close, far)]


class Margins(unittest.TestCase):
    def margins(self, *checks):
        code, out, err = call("ci/margins.py", run_of(*checks))
        self.assertEqual(code, 0, err)
        return sections(out)

    def test_lists_both_ends_worst_first_and_nothing_between(self):
        close, far = self.margins(check("half", 0.5, 1.0), check("tight", 0.7, 1.0), check("tighter", 9e-7, 1e-6),
                                  check("wide", 0.009, 1.0), check("usual", 0.1, 1.0), check("wider", 0.0, 1.0),
                                  check("one", 0.01, 1.0))
        self.assertEqual(close, ["tighter", "tight"])
        self.assertEqual(far, ["wider", "wide"])

    def test_an_exact_check_has_no_margin(self):
        self.assertEqual(self.margins(check("exact", 0.0, 0.0), check("usual", 0.1, 1.0)), [[], []])

    def test_a_check_that_must_exceed_its_limit_is_read_the_other_way_round(self):
        close, far = self.margins(*(check(*values, limit_is="at_least")
                                    for values in (("just", 0.11, 0.1), ("far above", 50.0, 0.1),
                                                   ("fell short", 0.09, 0.1, "fail"))))
        self.assertEqual((close, far), (["fell short", "just"], ["far above"]))

    def test_what_came_to_no_number_is_listed_first(self):
        self.assertEqual(self.margins(check("late", 2.0, 1.0, "fail"), check("none", None, 1.0, "fail"))[0],
                         ["none", "late"])

    def test_nothing_to_judge_is_no_success(self):
        self.assertEqual(call("ci/margins.py", run_of())[0], 4)
        self.assertEqual(call("ci/margins.py", run_of(check("exact", 0.0, 0.0)))[0], 4)
        for broken in ("", "{}", '{"scenarios": [{"id": "a"}]}', "[1]"):
            self.assertEqual(call("ci/margins.py", broken)[0], 2, broken)


unittest.main()
