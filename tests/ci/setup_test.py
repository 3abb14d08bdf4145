#!/usr/bin/env python3
"""ci/setup.sh with every program that it calls replaced by one that only notes the call: what it would install, and what
it leaves behind when it is killed in the middle."""
import os
import pathlib
import signal
import subprocess
import tempfile
import unittest

from scripts import ROOT


class Setup(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.policy = self.folder / "policy-rc.d"
        self.stub("dpkg-query", "echo install ok installed")  # every package that must be there is
        self.stub("apt-get", f'echo "$*" >>{self.folder}/calls')
        for name in ("npm", "slurmctld", "clang-format", "shellcheck"):
            self.stub(name, ":")

    def stub(self, name, text):
        file = self.folder / name
        file.write_text(f"#!/bin/sh\n{text}\n")
        file.chmod(0o755)

    def setup(self, browser):
        return subprocess.run([ROOT / "ci/setup.sh"], capture_output=True, text=True, timeout=60, env={
            "PATH": f"{self.folder}:{os.environ['PATH']}", "DYNOPROOF_BROWSER": browser,
            "DYNOPROOF_POLICY_FILE": str(self.policy)})

    def calls(self):
        file = self.folder / "calls"
        return file.read_text() if file.exists() else ""

    def test_nothing_is_installed_where_all_is_there(self):
        self.assertEqual(self.setup(browser="/bin/true").returncode, 0)
        self.assertEqual(self.calls(), "")

    @unittest.skipUnless(os.getuid() == 0, "asks for sudo")
    def test_a_missing_browser_is_installed_and_no_policy_stays(self):
        done = self.setup(browser="/nowhere/chromium")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("install -y -qq --no-install-recommends chromium", self.calls())
        self.assertFalse(self.policy.exists())

    @unittest.skipUnless(os.getuid() == 0, "asks for sudo")
    def test_one_that_cannot_be_installed_stops_nothing_but_is_said(self):
        self.stub("apt-get", '[ "$1" = update ]')
        done = self.setup(browser="/nowhere/chromium")
        self.assertEqual(done.returncode, 0)
        self.assertIn("chromium could not be installed", done.stdout)

    @unittest.skipUnless(os.getuid() == 0, "asks for sudo")
    def test_killed_in_the_middle_its_policy_ends_with_it(self):
        during = self.folder / "during"
        self.stub("apt-get", f'[ "$1" = update ] && exit\n{self.policy}; echo $? >{during}; kill -KILL $PPID')
        done = self.setup(browser="/nowhere/chromium")
        self.assertEqual(done.returncode, -signal.SIGKILL)
        self.assertEqual(during.read_text(), "101\n", "services are held back while packages are installed")
        self.assertTrue(self.policy.exists(), "the case that this test is about")
        self.assertEqual(subprocess.run([self.policy]).returncode, 0, "services may start again")
        self.assertFalse(self.policy.exists())


unittest.main()
