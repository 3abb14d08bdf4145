#!/usr/bin/env python3
"""ci/check_names.py sees an effect or plant that diagnosis or experiment know by name, and lets the sources pass."""
import pathlib
import subprocess
import tempfile
import unittest

from scripts import ROOT


class Names(unittest.TestCase):
    def setUp(self):
        """A small tree: one effect, one plant, no use of either."""
        self.tree = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.write("tests/conformance/effects_test.cc", 'kContract = {\n    {"leakage", {"A_leak"}},\n};\n')
        self.write("engine/plugins/plant/tank/tank.cc", 'PluginInfo Tank::Info() {\n  return {"plant",\n  "tank",\n};}\n')
        self.write("engine/diagnosis/search.cc", "int a;\n")

    def write(self, name, text):
        (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
        (self.tree / name).write_text(text)

    def check(self, tree=None):
        return subprocess.run([ROOT / "ci/check_names.py", tree or self.tree], capture_output=True, text=True, timeout=60)

    def test_the_sources_pass(self):
        done = self.check(ROOT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_sees_names(self):
        self.assertEqual(self.check().returncode, 0)
        for folder in ("diagnosis", "experiment"):
            for line in ('if (name == "leakage") return;', 'FindEffect("leakage");', 'type->string() == "tank"',
                         'effect.info().name.ends_with("_change")', 'effect.info().name == "of_a_plugin"'):
                with self.subTest(folder=folder, line=line):
                    self.write(f"engine/{folder}/knows.cc", f"int a;\n{line}\n")
                    done = self.check()
                    self.assertEqual(done.returncode, 1, done.stdout)
                    self.assertIn(f"engine/{folder}/knows.cc:2: ", done.stdout)
            self.write(f"engine/{folder}/knows.cc", '// "leakage" in a comment, "tanks" of another name\n"tanks";\n')
            self.assertEqual(self.check().returncode, 0)

    def test_fails_where_nothing_is_registered(self):
        self.write("tests/conformance/effects_test.cc", "")
        self.assertNotEqual(self.check().returncode, 0)


if __name__ == "__main__":
    unittest.main()
