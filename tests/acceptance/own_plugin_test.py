#!/usr/bin/env python3
"""`new law`, `new effect` and `new check`: the commands that they print, from the build folder and from an installation, and those of
engine/plugins/README.md. own_plugin_test.py PROGRAM"""
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

    def check(self, program):
        """A kind of check: it passes, it fails, and the report draws what it judged."""
        self.printed(program, "check", "calm")
        run = f"{program} run calm/calm.toml --plugin calm/build/calm.so"
        (one,) = [check for check in self.document(run)["scenarios"][0]["checks"] if check["kind"] == "calm"]
        self.assertEqual((one["verdict"], one["unit"], one["limit"]), ("pass", "N m", 90.0))
        text = (self.folder / "calm/calm.toml").read_text()
        (self.folder / "calm/calm.toml").write_text(text.replace("rms = 90.0", "rms = 1e-3"))
        document = self.document(f"{run} --html page.html", exit=1)
        (one,) = [check for check in document["scenarios"][0]["checks"] if check["kind"] == "calm"]
        self.assertEqual(one["verdict"], "fail")
        self.assertNotIn("evidence", one)
        self.assertIn("calm T_shaft", (self.folder / "page.html").read_text())
        (self.folder / "calm/calm.toml").write_text(text.replace('signal = "T_shaft"\nrms', 'signal = "T_shaf"\nrms'))
        said = self.shell(f"{program} validate calm/calm.toml --plugin calm/build/calm.so", exit=2).stderr
        self.assertIn('did you mean "T_shaft"?', said)

    # A library takes seconds to compile: each kind is built from one of the two places, the law from both.

    def test_from_the_build_folder(self):
        self.printed("build/dynoproof", "law", "soft_stop")
        self.check("build/dynoproof")

    def test_from_an_installation(self):
        prefix = self.folder / "a prefix"
        self.shell(f"cmake --install '{pathlib.Path(self.program).parent}' --prefix '{prefix}'")
        self.environment["PATH"] = f"{prefix}/bin:{os.environ['PATH']}"
        (self.folder / "build").unlink()
        self.printed("dynoproof", "law", "soft_stop")
        self.printed("dynoproof", "effect", "extra_mass")

    def test_the_page(self):
        (script,) = blocks("engine/plugins/README.md", "sh", "In a library of your own")
        self.assertIn("pass", self.script(script))


unittest.main()
