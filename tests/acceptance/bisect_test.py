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
COMMITS = 64
GIT = ["git", "-c", "user.name=test", "-c", "user.email=test@example.org", "-c", "commit.gpgsign=false"]
# What is planted, as text of the file; what the sentence has to say of it.
PLANTED = [
    (r"^I3 = 0\.5 ", "I3 = 0.51 ", "plant.inertia.I3 = 0.51 (was 0.5)"),
    (r"^I1 = 2\.0", "I1 = 2.02", "plant.inertia.I1 = 2.02 (was 2.0)"),
    (r"4\.0e5", "4.1e5", "plant.shaft.k1.stiffness_Nm_per_rad = 410000.0 (was 400000.0)"),
    (r"damping_Nms_per_rad = 6\.0", "damping_Nms_per_rad = 5.0", "plant.shaft.k2.damping_Nms_per_rad = 5.0 (was 6.0)"),
    (r"amplitude = 100\.0", "amplitude = 101.0", "input.T_airgap.source.amplitude = 101.0 (was 100.0)"),
    (r"\Z", '\n[[effect]]\nname = "coulomb_friction"\nat = "inertia:I2"\nparameters = { T_c = 0.5 }\n', "plant.load"),
    (r"2\.5e5", "2.45e5", "plant.shaft.k2.stiffness_Nm_per_rad = 245000.0 (was 250000.0)"),
    (r"damping_Nms_per_rad = 8\.0", "damping_Nms_per_rad = 8.8", "plant.shaft.k1.damping_Nms_per_rad = 8.8 (was 8.0)"),
    (r"^I2 = 0\.3 ", "I2 = 0.303 ", "plant.inertia.I2 = 0.303 (was 0.3)"),
    (r"rate_Hz_per_s = 200\.0", "rate_Hz_per_s = 202.0", "input.T_airgap.source.rate_Hz_per_s = 202.0 (was 200.0)"),
    (r'^on = "I1"', 'on = "I2"', 'plant.torque.T_airgap.on = "I2" (was "I1")'),
    (r'^of = "plant.I1.speed"', 'of = "plant.I2.speed"', 'output.omega_1.of = "plant.I2.speed" (was "plant.I1.speed")'),
]


def git(folder, *words):
    return subprocess.run([*GIT, *words], cwd=folder, check=True, capture_output=True, text=True).stdout.strip()


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
        """Commits that change nothing that a run shows, and one, the `at`-th, that does; all by one call of git."""
        branch = f"h{at}-{random.random()}"
        stream = b""
        for k in range(COMMITS + 1):
            (self.folder / "notes.txt").write_text(f"{k}\n")
            if k == at:
                planted()
            stream += (f"commit refs/heads/{branch}\nmark :{k + 1}\ncommitter test <test@example.org> {1700000000 + k} +0000\n"
                       f"data <<end\nCommit {k}\nend\n").encode()
            if k > 0:
                stream += f"from :{k}\n".encode()
            for file in self.folder.iterdir():
                if file.is_file() and file.name not in ("b.json", "count"):
                    content = file.read_bytes()
                    mode = "100755" if os.access(file, os.X_OK) else "100644"
                    stream += f"M {mode} inline {file.name}\ndata {len(content)}\n".encode() + content + b"\n"
        subprocess.run([*GIT, "fast-import", "--quiet"], input=stream, cwd=self.folder, check=True)
        git(self.folder, "checkout", "-q", "-f", branch)
        return git(self.folder, "rev-list", "--reverse", branch).split()

    def bisect(self, *words, code=0):
        done = subprocess.run([PROGRAM, "bisect", "line.toml", "--json", "b.json", *words], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        self.assertEqual(git(self.folder, "worktree", "list").count("\n"), 0, "no work tree is left behind")
        return json.loads((self.folder / "b.json").read_text()), done.stdout + done.stderr

    def test_each_planted_change_is_found_and_named(self):
        line = self.folder / "line.toml"
        sound = line.read_text()
        draw = random.Random(5)
        for pattern, text, said in PLANTED:
            at = draw.randrange(1, COMMITS + 1)
            with self.subTest(said, at=at):
                line.write_text(sound)
                hashes = self.history(lambda: line.write_text(re.sub(pattern, text, sound, count=1, flags=re.M)), at)
                found, output = self.bisect("--good", hashes[0])
                self.assertEqual(found["first"]["commit"], hashes[at], output)
                self.assertLessEqual(found["looks"], 7)
                self.assertEqual(found["builds"], 0, "no program is built where none is asked for")
                self.assertIn(said, found["sentence"])

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
