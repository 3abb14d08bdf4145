#!/usr/bin/env python3
"""bench/diagnosis.py compares cases that were drawn alike, and refuses others."""
import contextlib
import io
import json
import pathlib
import re
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "bench"))
import diagnosis  # noqa: E402

CASE = {"kind": "effect", "seed": 1, "number": 0, "scenario": "diagnose/fuel_gas", "noise": 0.01, "outcome": "right",
        "causes": [{"at": "output:p_g", "effect": "sensor_offset", "parameters": [-6957.087489016103]}],
        "found": "sensor_offset@output:p_g ", "unknown": "", "cpu_s": 1.0, "inside": 1, "of": 1}


def compared(after):
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as text:
        files = [pathlib.Path(folder) / name for name in ("before.json", "after.json")]
        for file, case in zip(files, (CASE, after)):
            file.write_text(json.dumps({"cases": [case]}))
        diagnosis.compare(*files)
    return text.getvalue()


class Compare(unittest.TestCase):
    def test_a_last_bit_is_no_other_case(self):
        causes = [CASE["causes"][0] | {"parameters": [-6957.087489016107]}]
        self.assertIn("all            1", compared(CASE | {"causes": causes, "noise": 0.010000000000000002}))

    def test_another_size_is_another_case(self):
        causes = [CASE["causes"][0] | {"parameters": [-6957.1]}]
        with self.assertRaisesRegex(SystemExit, "drawn differently"):
            compared(CASE | {"causes": causes})

    def test_another_place_or_fewer_causes_are_another_case(self):
        for causes in ([CASE["causes"][0] | {"at": "output:p"}], []):
            with self.assertRaisesRegex(SystemExit, "drawn differently"):
                compared(CASE | {"causes": causes})


class Quiet(unittest.TestCase):
    def test_each_effect_has_a_seed_of_its_own_that_stays(self):
        with tempfile.TemporaryDirectory() as build:
            program = pathlib.Path(build) / "dynoproof"

            def seeds(*names):
                program.write_text("#!/bin/sh\necho '%s'\n" % json.dumps({"effects": [{"name": name} for name in names]}))
                program.chmod(0o755)
                return {generator: seed for _, generator, _, _, seed in diagnosis.quiet(build)}

            names = (pathlib.Path(diagnosis.__file__).parents[1] / "tests/conformance/effects_test.cc").read_text()
            known = re.findall(r'^    \{"(\w+)",', names, re.M)
            self.assertGreater(len(known), 30)
            all_of_them = seeds(*known)
            self.assertEqual(len(set(all_of_them.values())), len(known))
            self.assertEqual(seeds("leakage")["quiet leakage"], all_of_them["quiet leakage"])

    def test_is_asked_of_the_blind_suite_without_noise(self):
        self.assertEqual(diagnosis.world("quiet leakage"), ["--generator", "reference", "--noise", "0", "--effect", "leakage"])


if __name__ == "__main__":
    unittest.main()
