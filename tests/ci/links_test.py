#!/usr/bin/env python3
"""ci/check_links.py sees a link that leads nowhere, and lets the project's pages pass."""
import pathlib
import subprocess
import tempfile
import unittest

from scripts import ROOT


class Links(unittest.TestCase):
    def setUp(self):
        self.tree = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        subprocess.run(["git", "init", "-q", self.tree], check=True)
        (self.tree / "part").mkdir()
        (self.tree / "part/README.md").write_text("# A part\n\n## What `it` does, and why\n")

    def check(self, text):
        (self.tree / "README.md").write_text(text)
        return subprocess.run([ROOT / "ci/check_links.py", self.tree], capture_output=True, text=True, timeout=60)

    def test_the_pages_pass(self):
        done = subprocess.run([ROOT / "ci/check_links.py"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_sees_what_leads_nowhere(self):
        for good in ("[a](part/README.md)", "[a](part/README.md#what-it-does-and-why)", "[a](https://example.com/x)", "[a](#here)\n\n# Here",
                     "```\n[a](nowhere.md)\n```"):
            with self.subTest(good):
                self.assertEqual(self.check(good).returncode, 0)
        for bad in ("[a](nowhere.md)", "[a](part/README.md#why)", "![a](part/a.png)", "[a](#there)\n\n# Here"):
            with self.subTest(bad):
                done = self.check(bad)
                self.assertEqual(done.returncode, 1)
                self.assertIn("README.md: ", done.stdout)


if __name__ == "__main__":
    unittest.main()
