#!/usr/bin/env python3
"""ci/presubmit.sh does what it says: under CI it passes only where every tool is there, it says what it left out, and it
sees a script that the shell cannot read."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

from scripts import ROOT


class Presubmit(unittest.TestCase):
    def setUp(self):
        """A small tree under git: the script, a script that is sound, and no source."""
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.tree = self.folder / "tree"
        (self.tree / "ci").mkdir(parents=True)
        shutil.copy(ROOT / "ci/presubmit.sh", self.tree / "ci")
        for check in ("layers", "names", "twins", "nan", "links"):
            self.write(f"ci/check_{check}.py", "#!/bin/sh\n:\n")
        self.write("ci/sound.sh", "#!/usr/bin/env bash\necho sound\n")
        self.write("a.h", "int a();\n")
        self.tools = self.folder / "tools"  # the only folder of the PATH
        self.tools.mkdir()
        for name in ("bash", "sh", "env", "git", "xargs", "dirname", "nproc"):
            os.symlink(shutil.which(name), self.tools / name)
        self.shell("git init -q . && git add -A")

    def write(self, name, text):
        (self.tree / name).write_text(text)
        (self.tree / name).chmod(0o755)

    def shell(self, command):
        subprocess.run(command, shell=True, check=True, cwd=self.tree)

    def give(self, *names):
        for name in names:
            (self.tools / name).write_text("#!/bin/sh\nexit 0\n")
            (self.tools / name).chmod(0o755)

    def presubmit(self, ci=""):
        return subprocess.run([self.tree / "ci/presubmit.sh"], capture_output=True, text=True, timeout=60,
                              env={"PATH": str(self.tools), "CI": ci})

    def test_says_what_it_could_not_check_and_fails_under_ci(self):
        done = self.presubmit()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("not checked: format: clang-format is not installed", done.stdout)
        self.assertIn("shellcheck is not installed", done.stdout)
        self.assertNotEqual(self.presubmit(ci="true").returncode, 0)

    def test_passes_under_ci_with_its_tools(self):
        self.give("clang-format", "shellcheck")
        done = self.presubmit(ci="true")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("presubmit: ok", done.stdout)

    def test_sees_json_that_throws(self):
        self.give("clang-format", "shellcheck")
        (self.tree / "engine/base").mkdir(parents=True)
        self.write("engine/base/json_text.h", "return document.dump(indent);\n")
        self.shell("git add -A")
        self.assertEqual(self.presubmit(ci="true").returncode, 0)
        self.write("engine/base/row.cc", "text = json{1}.dump();\n")
        self.shell("git add -A")
        done = self.presubmit(ci="true")
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("engine/base/row.cc:1:", done.stdout)

    def test_sees_a_broken_script(self):
        self.give("clang-format", "shellcheck")
        self.write("ci/broken.sh", "#!/usr/bin/env bash\nif true; then\n")
        self.shell("git add -A")
        self.assertNotEqual(self.presubmit(ci="true").returncode, 0)


if __name__ == "__main__":
    unittest.main()
