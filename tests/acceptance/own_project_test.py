#!/usr/bin/env python3
"""A project of one's own: the commands of ci/templates/README.md in an empty folder, and the pipelines that `new project`
writes. own_project_test.py PROGRAM"""
import os
import subprocess
import sys
import unittest

import yaml

from steps import ROOT, Steps, blocks

Steps.program = os.path.abspath(sys.argv.pop())
RUN = ("dynoproof/build/dynoproof run ", "cat out/report.md")
NOT_RUN = ("apt-get ", "test -d dynoproof ||", "git -C dynoproof ", "dynoproof/ci/")  # the machine's, a server's, a build


class OwnProject(Steps):
    def test_the_page(self):
        said = "".join(self.script("cd pumps\n" * (i > 0) + script)
                       for i, script in enumerate(blocks("ci/templates/README.md", "sh")))
        self.assertIn("dynoproof bless scenarios/line.toml --reason TEXT", said)
        self.assertIn("T_shaft", said)
        project = self.folder / "pumps"
        self.assertTrue((project / "scenarios/line.golden.h5").exists())
        self.assertEqual(self.shell("git status --porcelain", project).stdout, "", "out/ is ignored, the rest committed")
        self.assertFalse((ROOT / "golden/line.h5").exists() or (ROOT / "golden/line.golden.h5").exists())

    def test_what_is_printed(self):
        said = self.shell("build/dynoproof new project pumps").stdout
        lines = [line.strip() for line in said.splitlines() if line.startswith("  ")]
        self.assertEqual(len(lines), 3)
        for line in lines:
            self.shell(line.replace("TEXT", "first"), self.folder / "pumps")
        self.assertEqual(self.shell("build/dynoproof new project pumps", exit=2).stdout, "", "nothing is written over")

    def test_the_pipelines(self):
        self.shell("dynoproof new project pumps")
        project = self.folder / "pumps"
        (project / "dynoproof/build").mkdir(parents=True)
        (project / "dynoproof/build/dynoproof").symlink_to(self.program)
        github = yaml.safe_load((project / ".github/workflows/dynoproof.yml").read_text())
        gitlab = yaml.safe_load((project / ".gitlab-ci.yml").read_text())
        self.assertEqual(github["env"]["DYNOPROOF_COMMIT"], gitlab["variables"]["DYNOPROOF_COMMIT"])
        self.assertNotIn("@", (project / "README.md").read_text())
        self.assertNotRegex(github["env"]["DYNOPROOF_COMMIT"], r"[@+]")
        steps = github["jobs"]["scenarios"]["steps"]
        own = gitlab["scenarios"]
        self.shell("dynoproof bless scenarios/line.toml --reason first", project)
        for exit in (0, 1):
            for commands in ([one["run"] for one in steps if "run" in one],
                             own["before_script"] + own["script"] + own["after_script"]):
                for command in commands:
                    self.assertTrue(command.startswith(RUN + NOT_RUN), command)
                    self.assertEqual(subprocess.run(["bash", "-n", "-c", command]).returncode, 0, command)
                    if command.startswith(RUN):
                        self.shell(command, project, exit if " run " in command else 0, CI="true",
                                   GITHUB_STEP_SUMMARY=str(project / "summary.md"))
            line = project / "scenarios/line.toml"
            line.write_text(line.read_text().replace("I3 = 0.5 ", "I3 = 0.55 "))
        for file in ("out/report.html", "out/junit.xml", "out/line.h5", "out/line.golden.h5"):
            self.assertTrue((project / file).exists(), file)
        for step in steps[-2:]:
            self.assertEqual(step["if"], "${{ !cancelled() }}", "a red job needs its report most")
        self.assertEqual(own["artifacts"]["when"], "always")
        self.assertEqual(own["artifacts"]["reports"]["junit"], "out/junit.xml")


unittest.main()
