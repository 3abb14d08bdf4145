#!/usr/bin/env python3
"""bench/inexact.py counts each case in the row of all that is inexact in it, and its page is what it has kept."""
import json
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))
import inexact  # noqa: E402


def case(number, outcome, inexact, hidden=True):
    return {"seed": 1, "number": number, "kind": "effect" if hidden else "null", "scenario": "diagnose/fuel_gas", "inexact": inexact,
            "inexact_size": 1.0, "size": 9.0, "strength": 1.0, "noise": 0.01, "causes": [{"effect": "a", "at": "x"}] if hidden else [],
            "verdict": "main_cause", "found": "a@x ", "outcome": outcome, "cpu_s": float(number)}


CASES = [case(1, "right", ["hum"]), case(2, "wrong", ["hum", "fitted"]), case(3, "near", ["filtered"], False),
         case(4, "abstained", ["hum"], False), case(5, "stopped", ["fitted"])]


def kept(*files):
    with tempfile.TemporaryDirectory() as folder:
        paths = [pathlib.Path(folder) / f"{i}.json" for i in range(len(files))]
        for path, cases in zip(paths, files):
            path.write_text(json.dumps({"cases": cases}))
        return inexact.keep("0123abc", paths)


class Page(unittest.TestCase):
    def row(self, name):
        line = [one for one in inexact.page(kept(CASES)) if one.startswith(f"| {name} |")][0]
        return [cell.strip() for cell in line.split("|")[2:-1]]

    def test_a_case_stands_in_the_row_of_each_and_once_among_all(self):
        self.assertEqual(["2", "1", "", "", "", "1", "1", "1", "", "", ""], self.row("hum"))
        self.assertEqual(["2", "", "", "", "", "1", "0", "", "", "", "1"], self.row("three numbers fitted to the record"))
        self.assertEqual(["3", "1", "", "", "", "1", "2", "1", "1", "", "1"], self.row("all"))

    def test_every_kind_has_words(self):
        source = (inexact.ROOT / "tests/blind/inexact.cc").read_text()
        drawn = source[source.index("void DrawInexact"):source.index("bool MakeInexact")]
        for name in inexact.WORDS:
            self.assertIn(f'"{name}"', drawn)

    def test_a_case_in_two_files_counts_once_by_the_later(self):
        self.assertEqual(["wrong"], [one["outcome"] for one in kept([case(1, "right", ["hum"])], [case(1, "wrong", ["hum"])])["cases"]])

    def test_exact_cases_and_none_are_refused(self):
        with self.assertRaisesRegex(SystemExit, "exact"):
            kept([case(1, "right", [])])
        with self.assertRaisesRegex(SystemExit, "no case"):
            kept([])

    def test_the_page_is_what_is_kept(self):
        self.assertEqual(inexact.page(json.loads(inexact.FILE.read_text())), inexact.block.read(*inexact.PAGE))


if __name__ == "__main__":
    unittest.main()
