#!/usr/bin/env python3
"""ci/limits.py looks to either side of a limit, and counts what was seen there."""
import pathlib
import sys
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "ci"))
import limits  # noqa: E402


class Limits(unittest.TestCase):
    def test_a_gain_is_moved_from_one_and_not_from_nothing(self):
        up = {"parameters": {"g": 1.05}, "direction": "+", "smallest": 0.05}
        down = {"parameters": {"g": 0.95}, "direction": "-", "smallest": 0.05}
        for limit, value in ((up, 1.06), (down, 0.94)):
            name, found = limits.at(limit, 1.2)
            self.assertEqual("g", name)
            self.assertAlmostEqual(value, found)

    def test_an_effect_that_only_grows_is_moved_from_nothing(self):
        self.assertAlmostEqual(0.8e-3, limits.at({"parameters": {"tau": 1e-3}, "direction": "+", "smallest": 1e-3}, 0.8)[1])

    def test_right_is_seen_above_and_not_below(self):
        rows = [{"seen_above": a, "seen_below": b} for a, b in ((True, False), (True, True), (False, False))]
        self.assertEqual("| all 1 | 3 | 1 | 1 | 1 |", limits.table({"x/y": rows})[-1])

    def test_the_page_says_what_was_kept(self):
        with mock.patch.object(sys, "argv", ["limits.py", "--check"]):
            self.assertEqual(0, limits.main())


if __name__ == "__main__":
    unittest.main()
