#!/usr/bin/env python3
"""The templates of ci/templates: they parse, say what a pipeline needs, and their commands are run here on a small part.
Every command must be known to this test: one that is not run stands in NOT_RUN with the reason.
templates_test.py PROGRAM"""
import glob
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import yaml

from scripts import ROOT

PROGRAM = os.path.abspath(sys.argv.pop())
GITHUB, GITLAB = "github-actions.yml", "gitlab-ci.yml"
RUN = ("./ci/setup.sh", "./ci/build.sh ", "./ci/run.sh ", "./ci/test.sh ", "cat out/report.md", "./build/dynoproof reproduce ")
NOT_RUN = {"apt-get ": "changes the machine", "git ": "changes the configuration or asks a server",
           "./ci/perf_gate.sh ": "builds two trees", "./ci/nightly.sh": "takes hours",
           "./build/dynoproof history ": "records what a night has measured"}
# What the templates leave to variables: one scenario of a second, one test of a millisecond. The test of the inner ctest
# calls nothing, and it works in a folder of its own, so that the two do not write one log.
SMALL = {"SCENARIOS": "backlash/clamped_damped", "CTEST_ARGUMENTS": "--test-dir build/tests -R ^base/CpuClass",
         "CLAIM": "A.1-highest", "BASE": "origin/main", "HISTORY": "history.sqlite", "CI": "true"}


def load(name):
    return yaml.safe_load((ROOT / "ci/templates" / name).read_text())


def github_steps(job):
    return load(GITHUB)["jobs"][job]["steps"]


def commands(job):
    """The commands of a job in both templates, in order, without what keeps GitLab's script going."""
    found = [step["run"] for step in github_steps(job) if "run" in step]
    table = load(GITLAB)[job]
    found += [line for part in ("before_script", "script", "after_script") for line in table.get(part, [])]
    return [line.removesuffix(" || failed=1") for line in found if line not in ("failed=0", "exit $failed")]


def bash(command, folder=ROOT, **variables):
    return subprocess.run(["bash", "-eo", "pipefail", "-c", command], cwd=folder, capture_output=True, text=True, timeout=1500,
                          env={**os.environ, **SMALL, **variables})


class Templates(unittest.TestCase):
    def test_each_has_the_three_jobs_and_when_they_run(self):
        github, gitlab = load(GITHUB), load(GITLAB)
        self.assertEqual(set(github["jobs"]), {"gate", "nightly", "reproduce"})
        triggers = github[True]  # YAML 1.1 reads the key "on" as a truth value
        self.assertEqual(set(triggers), {"pull_request", "schedule", "workflow_dispatch"})
        self.assertTrue(triggers["schedule"][0]["cron"])
        self.assertIn("claim", triggers["workflow_dispatch"]["inputs"])
        for job, event in (("gate", "pull_request"), ("nightly", "schedule"), ("reproduce", "workflow_dispatch")):
            table = github["jobs"][job]
            self.assertEqual(table["if"], f"github.event_name == '{event}'")
            self.assertEqual(table["container"], "debian:12")
            self.assertTrue(table["runs-on"] and table["timeout-minutes"])
            self.assertTrue(all(("run" in step) != ("uses" in step) for step in table["steps"]))
        self.assertEqual(set(gitlab) - {"image", "workflow", "variables"}, {"gate", "nightly", "reproduce"})
        self.assertEqual(gitlab["image"], "debian:12")
        for job, source in (("gate", "merge_request_event"), ("nightly", "schedule"), ("reproduce", "web")):
            self.assertEqual(gitlab[job]["rules"], [{"if": f'$CI_PIPELINE_SOURCE == "{source}"'}])
        for name in ("SCENARIOS", "CTEST_ARGUMENTS"):
            self.assertEqual((github["env"][name], gitlab["variables"][name]), ("", ""), "as they stand: everything")

    def test_results_are_kept(self):
        for job, files in (("gate", ("out/report.html", "out/junit.xml")), ("reproduce", ("out/atlas.html",)),
                           ("nightly", ("out/nightly/", "history/"))):
            upload = next(step for step in github_steps(job) if step.get("uses", "").startswith("actions/upload-artifact"))
            self.assertEqual(upload["if"], "${{ !cancelled() }}", "a red job needs its report most")
            kept = load(GITLAB)[job]["artifacts"]
            self.assertEqual(kept["when"], "always")
            for file in files:
                self.assertIn(file, upload["with"]["path"].split())
                self.assertTrue(any(file.startswith(path) for path in kept["paths"]), file)
        self.assertEqual(load(GITLAB)["gate"]["artifacts"]["reports"]["junit"], "out/junit.xml")
        cache = next(step for step in github_steps("nightly") if step.get("uses", "").startswith("actions/cache"))
        self.assertEqual((cache["with"]["path"], load(GITLAB)["nightly"]["cache"]["paths"]), ("history", ["history/"]))

    def test_every_command_is_known(self):
        self.assertFalse(load(GITHUB)["defaults"]["run"]["shell"] != "bash")
        for job in ("gate", "nightly", "reproduce"):
            for command in commands(job):
                self.assertTrue(command.startswith((*RUN, *NOT_RUN)), command)
                self.assertEqual(subprocess.run(["bash", "-n", "-c", command]).returncode, 0, command)
        for job, needed in (("gate", ("./ci/run.sh ", "./ci/test.sh ", './ci/perf_gate.sh "$BASE"')),
                            ("nightly", ("./ci/nightly.sh", "./build/dynoproof history add", "./build/dynoproof history check")),
                            ("reproduce", ("./build/dynoproof reproduce ",))):
            for start in needed:
                self.assertEqual(sum(command.startswith(start) for command in commands(job)), 2, f"{start} in both")

    def test_the_commands_work(self):
        with tempfile.TemporaryDirectory() as folder:
            summary, kept = pathlib.Path(folder, "summary.md"), pathlib.Path(folder, "out")
            (ROOT / "out").mkdir(exist_ok=True)
            kept.mkdir()
            for file in (ROOT / "out").glob("*.*"):  # of somebody's own run, perhaps the one that this test belongs to
                shutil.move(file, kept)
            try:
                done = set()
                for command in commands("gate") + commands("reproduce"):
                    if command in done or not command.startswith(RUN):
                        continue
                    done.add(command)
                    outcome = bash(command, GITHUB_STEP_SUMMARY=str(summary))
                    self.assertEqual(outcome.returncode, 0, f"{command}\n{outcome.stdout}\n{outcome.stderr}")
                    if command.startswith("./ci/test.sh"):
                        self.assertIn("100% tests passed, 0 tests failed out of 1\n", outcome.stdout)
                self.assertEqual(len({command.split()[0] for command in done}), 6, "each kind of command at least once")
                self.assertIn("backlash/clamped_damped | pass", summary.read_text())
                for job in ("gate", "reproduce"):
                    upload = next(step for step in github_steps(job) if "upload" in step.get("uses", ""))
                    for path in upload["with"]["path"].split() + load(GITLAB)[job]["artifacts"]["paths"]:
                        self.assertTrue(glob.glob(str(ROOT / path), recursive=True), f"{job} keeps {path}, which is not there")
            finally:
                for file in (ROOT / "out").glob("*.*"):
                    file.unlink()
                for file in kept.iterdir():
                    shutil.move(file, ROOT / "out")

    def test_every_gate_has_its_say_and_one_failure_fails_the_job(self):
        """GitLab's scripts with stand-ins for the programs; GitHub's by the condition of each step."""
        for job in ("gate", "nightly"):
            script = "\n".join(load(GITLAB)[job]["script"])
            programs = {line.split()[0] for line in load(GITLAB)[job]["script"] if line.startswith("./")}
            with tempfile.TemporaryDirectory() as name:
                folder = pathlib.Path(name)
                for program in programs:
                    stand_in = folder / program
                    stand_in.parent.mkdir(parents=True, exist_ok=True)
                    stand_in.write_text(f'#!/bin/sh\necho "{program} $1 $2" >> called\n[ "{program} $1 $2" != "$BAD" ]\n')
                    stand_in.chmod(0o755)
                self.assertEqual(bash(script, folder, BAD="").returncode, 0)
                called = (folder / "called").read_text().splitlines()
                self.assertEqual(len(called), sum(line.startswith("./") for line in load(GITLAB)[job]["script"]))
                for bad in called:
                    (folder / "called").unlink()
                    self.assertEqual(bash(script, folder, BAD=bad).returncode, 1, bad)
                    self.assertEqual((folder / "called").read_text().splitlines(), called)
            steps = [step for step in github_steps(job) if step.get("run", "").startswith("./")]
            for step in steps[1:]:
                self.assertEqual(step["if"], "${{ !cancelled() }}", step["run"])
            self.assertNotIn("continue-on-error", str(github_steps(job)))

    def test_the_scripts_are_there(self):
        names = {command.split()[0] for job in ("gate", "nightly", "reproduce") for command in commands(job)}
        for name in sorted(one for one in names if one.startswith("./ci/")):
            with self.subTest(name):
                self.assertTrue(os.access(ROOT / name, os.X_OK), name)
                self.assertEqual(subprocess.run(["bash", "-n", ROOT / name]).returncode, 0)

    def test_the_history_commands_take_their_options(self):
        for words in {tuple(one.split()) for one in commands("nightly") if one.startswith("./build/dynoproof history ")}:
            done = subprocess.run([PROGRAM, "history", words[2], "--help"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            for option in (word for word in words if word.startswith("--")):
                self.assertIn(option, done.stdout)


unittest.main()
