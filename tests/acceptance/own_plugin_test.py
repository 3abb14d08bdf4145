#!/usr/bin/env python3
"""`new law` and `new effect`: the commands that they print, from the build folder and from an installation, and those of
README.md. own_plugin_test.py PROGRAM"""
import os
import pathlib
import sys
import unittest

from steps import Steps, blocks

Steps.program = os.path.abspath(sys.argv.pop())


class OwnPlugin(Steps):
    def printed(self, program, kind, name):
        said = self.shell(f"{program} new {kind} {name}").stdout
        lines = [line.strip() for line in said.splitlines() if line.startswith("  ")]
        self.assertEqual(len(lines), 3, said)
        for line in lines:
            said = self.shell(line).stdout
        self.assertIn("pass", said)
        self.shell(f"{program} validate {name}/{name}.toml", exit=2)  # without the library there is no such thing

    def test_from_the_build_folder(self):
        self.printed("build/dynoproof", "law", "soft_stop")
        self.printed("dynoproof", "effect", "extra_mass")

    def test_from_an_installation(self):
        prefix = self.folder / "a prefix"
        self.shell(f"cmake --install '{pathlib.Path(self.program).parent}' --prefix '{prefix}'")
        self.environment["PATH"] = f"{prefix}/bin:{os.environ['PATH']}"
        (self.folder / "build").unlink()
        self.printed("dynoproof", "law", "soft_stop")
        self.printed("dynoproof", "effect", "extra_mass")

    def test_the_readme(self):
        (script,) = blocks("README.md", "sh", "Plugins and projects of your own")
        self.assertIn("pass", self.script(script))


unittest.main()
