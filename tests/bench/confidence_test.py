#!/usr/bin/env python3
"""bench/confidence.py counts what was right by verdict, and what it has written is what it has kept."""
import json
import pathlib
import sys
import tempfile
import unittest
from unittest import mock

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))
import confidence  # noqa: E402


def case(number, verdict, found, *hidden, seed=1, kind="effect"):
    return {"kind": kind, "seed": seed, "number": number, "verdict": verdict, "found": found,
            "causes": [dict(zip(("effect", "at"), one.split("@"))) for one in hidden]}


CASES = [case(0, "effect_found", "a@x ", "a@x"), case(1, "effect_found", "a@x ", "a@y"), case(2, "effect_found", "b@y a@x ", "a@x", "b@y"),
         case(3, "effect_found", "a@x c@x ", "a@x", "b@y"), case(4, "main_cause", "a@x ", "a@x", "b@y"), case(5, "effect_found", "a@x "),
         case(6, "no_effect", ""), case(7, "broken", "", "a@x"), case(8, "unexplained", "", "a@x")]


class Count(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def counted(self, *files):
        paths = []
        for i, cases in enumerate(files):
            paths.append(pathlib.Path(self.folder.name) / f"{i}.json")
            paths[-1].write_text(json.dumps({"cases": cases}))
        return confidence.count("0123abc", paths)

    def test_right_is_where_all_that_is_shown_was_hidden(self):
        rows = {(row["verdict"], row["several"]): (row["cases"], row["right"]) for row in self.counted(CASES)["all"]}
        self.assertEqual({("effect_found", False): (3, 1), ("effect_found", True): (2, 1), ("main_cause", False): (1, 1)}, rows)

    def test_a_case_in_two_files_counts_once_by_the_later(self):
        later = [case(1, "effect_found", "a@y ", "a@y")]
        rows = {(row["verdict"], row["several"]): (row["cases"], row["right"]) for row in self.counted(CASES, later)["all"]}
        self.assertEqual((3, 2), rows["effect_found", False])

    def test_an_effect_and_a_null_of_one_number_are_two_cases(self):
        null = [case(1, "effect_found", "a@x ", kind="null")]
        rows = {(row["verdict"], row["several"]): (row["cases"], row["right"]) for row in self.counted(CASES, null)["all"]}
        self.assertEqual((4, 1), rows["effect_found", False])

    def test_halves_have_each_case_once(self):
        kept = self.counted(CASES)
        both = sum(row["cases"] for half in ("calibrating", "checking") for row in kept[half])
        self.assertEqual(sum(row["cases"] for row in kept["all"]), both)

    def test_what_the_program_and_its_page_say_is_what_was_kept(self):
        with mock.patch.object(sys, "argv", ["confidence.py", "check"]):
            self.assertEqual(0, confidence.main())


if __name__ == "__main__":
    unittest.main()
