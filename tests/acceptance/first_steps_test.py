#!/usr/bin/env python3
"""A newcomer's first drive line, as README.md and `describe` lead: every change that they invite runs and passes as it is
written. first_steps_test.py PROGRAM"""
import os
import re
import sys
import unittest

from steps import Steps, blocks

Steps.program = os.path.abspath(sys.argv.pop())
SECTION = "Your own drive line in five minutes"
SHORT = " --set run.duration_s=0.3"  # of 2 s: the chirp has come to 60 Hz, play and friction have been at work
STARTS = {"constant_load": "T_0 = 5.0", "sensor_offset": "o = 1.0", "sensor_drift": "slope = 1.0",
          "actuator_harmonic": "h2 = 0.02, h3 = 0.01"}  # where the start of a search is "none of it"


class FirstSteps(Steps):
    def setUp(self):
        super().setUp()
        self.shell("dynoproof new scenario my_line")
        self.template = (self.folder / "my_line.toml").read_text()

    def changed(self, example):
        """The template with an example in it: a shaft in place of the one of that name, anything else at the end."""
        head = example.splitlines()[0].split("#")[0].strip()
        if not head.startswith("[plant.shaft."):
            return self.template + "\n" + example
        table = re.compile(rf"^{re.escape(head)}\n(?:[a-z].*\n)+", re.M | re.I)
        text, count = table.subn(lambda _: example, self.template)
        self.assertEqual(count, 1, f"the template has one {head}")
        return text

    def passes(self, name, text, more=""):
        (self.folder / f"{name}.toml").write_text(text)
        said = self.shell(f"dynoproof validate {name}.toml")
        self.assertEqual(said.stderr, "", "no error and no warning")
        run = self.document(f"dynoproof run {name}.toml{more}")["scenarios"][0]
        self.assertEqual(run["verdict"], "pass", run)
        self.assertTrue(run["checks"])
        for check in run["checks"]:
            self.assertLess(check["value"], check["limit"])

    def test_the_commands_of_the_readme(self):
        (self.folder / "my_line.toml").unlink()
        (script,) = blocks("README.md", "sh", SECTION)
        self.assertIn("pass", self.script(script))
        self.assertTrue((self.folder / "out/my_line.h5").exists())

    def test_a_record_of_ones_own(self):
        """The commands of the README, and what they find: the numbers that the trace came from."""
        (self.folder / "my_line.toml").unlink()
        (script,) = blocks("README.md", "sh", "Your own record")
        self.script(script)
        last = [line for line in script.splitlines() if " identify " in line][0]
        found = self.document(last.replace("build/", ""))["parameters"]
        for key, true in (("plant.inertia.I3", 0.5), ("plant.shaft.k2.stiffness_Nm_per_rad", 2.5e5)):
            # A band-limited interpolation is that good up to 0.8 of half the sampling rate, where this chirp ends.
            self.assertAlmostEqual(found[key]["value"] / true, 1.0, delta=1e-4, msg=key)

    def test_the_changes_of_the_readme(self):
        shown = blocks("README.md", "toml", SECTION)
        excerpts = [one for one in shown if one.startswith("[plant]")]
        changes = [one for one in shown if one not in excerpts]
        self.assertEqual((len(excerpts), len(changes)), (1, 4))
        for line in excerpts[0].splitlines():
            self.assertIn(re.sub(r"\s*#.*", "", line), self.template, "the README shows the template")
        for i, example in enumerate(changes):
            with self.subTest(example=example):
                self.passes(f"change_{i}", self.changed(example))
        self.passes("all", self.changed(changes[1]) + changes[2] + changes[3], SHORT)

    def test_every_law(self):
        laws = [one["name"] for one in self.document("dynoproof list")["plugins"] if one["kind"] == "law"]
        self.assertGreater(len(laws), 20)
        shafts = 0
        for law in laws:
            with self.subTest(law=law):
                (plugin,) = [one for one in self.document(f"dynoproof describe law.{law}")["plugins"]]
                example = plugin["example"]
                self.assertIn(example.splitlines()[-1], self.shell(f"dynoproof describe law.{law}").stdout)
                shafts += example.startswith("[plant.shaft.")
                self.passes(f"law_{law}", self.changed(example), SHORT)
        self.assertGreater(shafts, 10)

    def test_every_effect(self):
        places = self.document("dynoproof describe my_line.toml")["scenarios"][0]["places"]
        tried = 0
        for name, where in places.items():
            (effect,) = self.document(f"dynoproof describe {name}")["effects"]
            for place in {one.split(":")[0]: one for one in where}.values():
                with self.subTest(effect=name, place=place):
                    example = effect["example"].replace("KIND:NAME", place)
                    if name in STARTS:
                        example = re.sub(r"parameters = .*", f"parameters = {{ {STARTS[name]} }}", example)
                    self.passes(f"{name}_{tried}", self.changed(example), SHORT)
                    tried += 1
        self.assertGreater(tried, 25)

    def test_the_oracle_of_the_template(self):
        with_oracle = re.sub(r"^# (\[\[check\]\]|kind|oracle|signal|nrmse|origin)", r"\1", self.template, flags=re.M)
        self.assertEqual(with_oracle.count("\n[[check]]"), 2)
        self.passes("linear", with_oracle)
        self.template = with_oracle
        cubic, play, load, effect = [one for one in blocks("README.md", "toml", SECTION) if not one.startswith("[plant]")]
        for name, change, why, instead in (("cubic", cubic, "the law cubic_spring", 'kind = "solvers"'),
                                           ("play", play, "the law phase_plane", 'oracle = "piecewise_exponential"'),
                                           ("load", load, "the law coulomb", 'kind = "solvers"'),
                                           ("effect", effect, "the law coulomb", 'kind = "solvers"')):
            with self.subTest(name):
                text = self.changed(change)
                (self.folder / f"{name}.toml").write_text(text)
                line = 1 + text[:text.index('kind = "oracle"')].count("\n")
                for command in ("validate", "run"):
                    said = self.shell(f"dynoproof {command} {name}.toml", exit=2).stderr
                    self.assertIn(f"{name}.toml:{line}:8: error: the oracle \"held_input_exponential\" does not apply", said)
                    self.assertIn(why, said)
                    self.assertIn(instead, said)
                self.assertFalse((self.folder / f"out/{name}.h5").exists(), "nothing has run")
        # What the message proposes works; impacts make 2e-6 of what a step of `realtime` leaves, another gap would make 1.
        (self.folder / "play.toml").write_text(self.changed(play).replace("held_input", "piecewise").replace("1e-9", "1e-4"))
        self.shell(f"dynoproof run play.toml{SHORT}")


unittest.main()
