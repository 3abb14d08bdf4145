#!/usr/bin/env python3
"""`bisect` over histories of 64 commits, each with one change planted somewhere: the right commit, at most seven runs, and a sentence
that names the change. bisect_test.py PROGRAM"""
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = str(pathlib.Path(sys.argv[1]).resolve())
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "ci"))
import bisections  # noqa: E402
from bisections import GIT, git  # noqa: E402

# Of each kind one: a number, a part, what an input does, a control, words beside it, a limit, golden data. All of them: ci/bisections.py.
PLANTED = ["stiffness_2", "friction", "input_shape", "gain_P", "title_as_well", "limit", "golden_of_another_run"]


class Histories(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="bisect-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        git(self.folder, "init", "-q")
        subprocess.run([PROGRAM, "new", "scenario", "line"], cwd=self.folder, check=True, capture_output=True)
        line = self.folder / "line.toml"
        line.write_text(re.sub(r"\[\[check\]\][^#]*", "", line.read_text()).replace("duration_s = 2.0", "duration_s = 0.1"))
        (self.folder / ".gitignore").write_text("out/\n")

    def history(self, planted, at):
        return bisections.history(self.folder, planted, lambda k: None, at)

    def bisect(self, *words, code=0):
        done = subprocess.run([PROGRAM, "bisect", "line.toml", "--json", "b.json", *words], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(git(self.folder, "worktree", "list").count("\n"), 0, "no work tree is left behind")
        return json.loads((self.folder / "b.json").read_text()), done.stdout + done.stderr

    def test_each_planted_change_is_found_and_named(self):
        for one in bisections.PLANTED:
            if one["name"] not in PLANTED:
                continue
            with self.subTest(one["name"]):
                said = bisections.tried(one, PROGRAM)
                self.assertTrue(said.get("found"), said)
                self.assertLessEqual(said["looks"], bisections.LOOKS)
                self.assertEqual(said["builds"], 0, "no program is built where none is asked for")
                self.assertTrue(said["right"], said)

    def test_the_ten_lines_of_the_page(self):
        (script,) = re.findall(r"```sh\n(.*?)```", (ROOT / "engine/history/README.md").read_text(), re.S)
        self.assertEqual(len(script.splitlines()), 10)
        done = subprocess.run(["bash", "-e"], input=f"dynoproof() {{ {PROGRAM} \"$@\"; }}\n" + script, cwd=self.folder, text=True,
                              capture_output=True)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(done.stdout.count("Day 5\n"), 2, done.stdout)
        found = json.loads((self.folder / "out/bisect_me/first.json").read_text())
        self.assertEqual(found["sentence"], "the scenario: plant.inertia.I3 = 0.52 (was 0.5)")

    def test_a_check_alone_and_commits_that_cannot_run(self):
        line = self.folder / "line.toml"
        line.write_text(line.read_text() + '\n[[check]]\nkind = "peak"\nsignal = "T_shaft"\nfigure = "f"\nband_Hz = [1.0, 400.0]\n'
                        'between_Hz = [1.0, 400.0]\norigin = "all"\n')
        sound = line.read_text()
        hashes = []
        for k in range(12):
            # Another trace from 3 on, nothing that runs at 5 and 6, a check that fails from 7 on.
            text = sound.replace("I3 = 0.5 ", "I3 = 0.51 ") if k >= 3 else sound
            text = text.replace("between_Hz = [1.0, 400.0]", "between_Hz = [390.0, 400.0]") if k >= 7 else text
            line.write_text(f"[run {k}\n" if k in (5, 6) else text + f"# {k}\n")
            git(self.folder, "add", "-A")
            git(self.folder, "commit", "-q", "-m", f"Commit {k}")
            hashes.append(git(self.folder, "rev-parse", "HEAD"))
        name = next(iter(self.bisect("--good", hashes[0])[0]["checks"]), None)
        self.assertIsNone(name, "the first change is of the trace: no check minds it")
        self.assertEqual(self.bisect("--good", hashes[0])[0]["first"]["commit"], hashes[3])
        done = subprocess.run([PROGRAM, "run", "line.toml", "--json", "r.json"], cwd=self.folder, capture_output=True)
        self.assertEqual(done.returncode, 1)
        check = json.loads((self.folder / "r.json").read_text())["scenarios"][0]["checks"][0]["name"]
        found, output = self.bisect("--good", hashes[0], "--check", check)
        self.assertEqual(found["first"]["commit"], hashes[7], output)
        self.assertEqual(found["undecided"], 2, output)
        self.assertIn("or one of the 2 before it", output)
        self.assertIn("there is no check", self.bisect("--good", hashes[0], "--check", "nothing", code=2)[1])

    def test_nothing_to_find_and_nothing_to_look_at_are_said(self):
        hashes = self.history(lambda: None, 1)
        self.assertIn("there is nothing to find", self.bisect("--good", hashes[0], code=1)[1])
        self.assertIn("is no commit of this repository", self.bisect("--good", "nowhere", code=2)[1])
        self.assertIn("no commit comes after", self.bisect("--good", hashes[-1], code=2)[1])
        self.assertIn("wrote no result", self.bisect("--good", hashes[0], "--program", "false", code=2)[1])

    def test_a_program_is_built_at_each_commit_and_a_call_goes_on(self):
        program = self.folder / "program"

        def write(more):
            program.write_text(f'#!/bin/sh\nexec {PROGRAM} "$@" {more}\n')
            program.chmod(0o755)

        write("")
        hashes = self.history(lambda: write("--set plant.shaft.k2.damping_Nms_per_rad=5.5"), 20)
        words = ("--good", hashes[0], "--build", "cp program built && echo x >>" + str(self.folder / "count"), "--program", "./built")
        found, output = self.bisect(*words)
        self.assertEqual(found["first"]["commit"], hashes[20], output)
        self.assertEqual(found["builds"], (self.folder / "count").read_text().count("x"))
        self.assertLessEqual(found["builds"], 7)
        again, _ = self.bisect(*words)
        self.assertEqual(again["builds"], 0, "what was looked at is kept")
        self.assertEqual(again["first"], found["first"])


if __name__ == "__main__":
    for variable in ("CI", "DYNOPROOF_SCENARIOS", "DYNOPROOF_GOLDEN"):
        os.environ.pop(variable, None)
    unittest.main(argv=sys.argv[:1])
