#!/usr/bin/env python3
"""tests/mutants/mutants.py must be able to fail: with a fault that no check catches, and with a text that has moved on.
mutants_test.py PROGRAM"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

from scripts import ROOT

PROGRAM = os.path.abspath(sys.argv.pop())
TABLE = """[[mutant]]
name = "nothing"
what = "no fault at all"
file = "ci/build.sh"
text = '{text}'
replacement = "x"
scenario = "backlash/clamped"
check = "{check}"
"""


class Mutants(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.folder / "tests/mutants").mkdir(parents=True)
        for name in ("scenarios", "golden", "ci"):
            (self.folder / name).symlink_to(ROOT / name)
        shutil.copy(ROOT / "tests/mutants/mutants.py", self.folder / "tests/mutants")
        (self.folder / "mutant_nothing").symlink_to(PROGRAM)

    def call(self, *arguments, text="set -euo pipefail", check="solvers omega_1"):
        table = self.folder / "tests/mutants/mutants.toml"
        table.write_text(TABLE.format(text=text, check=check) if text else "mutant = []\n")
        return subprocess.run([self.folder / "tests/mutants/mutants.py", *arguments], capture_output=True, text=True)

    def run_with(self, program, **table):
        return self.call("run", "--program", program, "--mutants", str(self.folder), "--jobs", "1", **table)

    def test_a_fault_that_passes_is_a_failure(self):
        done = self.run_with(PROGRAM)
        self.assertEqual(done.returncode, 1)
        self.assertIn("nothing in backlash/clamped: ends with 0, not with 1", done.stderr)
        self.assertIn("| no fault at all | `build.sh` | backlash/clamped | solvers omega_1 |", done.stdout)

    def test_a_sound_program_that_fails_is_a_failure(self):
        done = self.run_with("/bin/false")
        self.assertIn("the sound program ends with 1 in backlash/clamped", done.stderr)

    def test_nothing_seeded_is_a_failure(self):
        self.assertEqual(self.run_with(PROGRAM, text="").returncode, 1)

    def test_the_text_must_stand_there_once(self):
        out = self.folder / "out.cc"
        self.assertEqual(self.call("make", "nothing", str(out)).returncode, 0)
        self.assertEqual(out.read_text(), (ROOT / "ci/build.sh").read_text().replace("set -euo pipefail", "x"))
        for text, times in (("no such text", 0), ("cmake", (ROOT / "ci/build.sh").read_text().count("cmake"))):
            done = self.call("make", "nothing", str(out), text=text)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(f"occurs {times} times in ci/build.sh", done.stderr)


unittest.main()
