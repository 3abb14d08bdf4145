#!/usr/bin/env python3
"""ci/limits.py looks to either side of a limit, and counts what was seen there."""
import pathlib
import sys
import tempfile
import tomllib
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
        holes = [{"passes": 0.1}, {"passes": 0.4}, {"passes": 1.0}]
        kept = {"limits": rows, "holes": holes, "proposals": {}, "builds": {"a x86-64": True, "b x86-64": False}}
        self.assertEqual("| all 1 | 3 | 1 | 1 | 1 | 3 | 2 | 0.4 | 1 of 2 |", limits.table({"x/y": kept})[-1])

    def test_states_the_width_of_users_and_the_one_that_is_proposed(self):
        with tempfile.TemporaryDirectory() as folder:
            golden = limits.Golden(folder)
            golden.state("backlash/clamped", {"T": 0.003, "unheard_of": 0.01})
            said = tomllib.loads((golden.folder / "backlash/clamped.toml").read_text())["signal"]
            widths = {name: one["relative_width"] for name, one in said.items()}
            self.assertEqual({"T": 0.003, "unheard_of": 0.01}, {name: width for name, width in widths.items() if width != limits.WIDTH})
            self.assertGreater(len(widths), 4)

    def test_the_page_says_what_was_kept(self):
        with mock.patch.object(sys, "argv", ["limits.py", "--check"]):
            self.assertEqual(0, limits.main())


if __name__ == "__main__":
    unittest.main()
