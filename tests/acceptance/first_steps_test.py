#!/usr/bin/env python3
"""A newcomer's first steps, as README.md, scenarios/README.md and `describe` lead: every command of the README runs in a clean
folder as it is written, and so does every change that the pages invite. first_steps_test.py PROGRAM"""
import json
import os
import re
import sys
import unittest

from steps import ROOT, Steps, blocks, commands, section

Steps.program = os.path.abspath(sys.argv.pop())
RIGHT, WHY, FAST = "Is this simulation right?", "It disagrees with the measurement: why?", "Is it fast enough for 10 kHz?"
BLIND = "What would your checks not see?"
BUILD, SECTION, RECORD = "Two commands", "Your own drive line in five minutes", "Your own record"
CHANGES = blocks("scenarios/README.md", "toml", "Changes to a line")
SHORT = " --set run.duration_s=0.3"  # of 2 s: the chirp has come to 60 Hz, play and friction have been at work
STARTS = {"constant_load": "T_0 = 5.0", "sensor_offset": "o = 1.0", "sensor_drift": "slope = 1.0",
          "actuator_harmonic": "h2 = 0.02, h3 = 0.01"}  # where the start of a search is "none of it"
of_the_thesis = unittest.skipUnless((ROOT / "engine/thesis").exists(), "the scenario belongs to the thesis")


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

    def test_no_command_of_the_readme_is_left_out(self):
        """Those that install and build are what the tests themselves began with."""
        known = [script for heading in (RIGHT, WHY, FAST, BUILD, SECTION, RECORD, BLIND) for script in blocks("README.md", "sh", heading)]
        self.assertEqual(blocks("README.md", "sh"), known)
        for command, _ in commands(known[3]):
            self.assertTrue(os.access(ROOT / command, os.X_OK), command)

    def first(self, heading, any_exit=False):
        """The commands below one of the three questions. What the last one said, and the title of the page that it wrote."""
        (self.folder / "my_line.toml").unlink()
        (script,) = blocks("README.md", "sh", heading)
        *before, (last, stated) = commands(script)
        for command, _ in before:
            self.shell(command)
        done = self.shell(last, exit=None if any_exit else stated)
        page = (self.folder / re.search(r"--html (\S+)", last)[1]).read_text()
        return done, re.search(r"<title>(.*?)</title>", page)[1]

    @of_the_thesis
    def test_is_this_simulation_right(self):
        done, title = self.first(RIGHT)
        (said,) = re.findall(r"`(resonance moved from .*?)`", section("README.md", RIGHT))
        self.assertIn(said, done.stdout)
        self.assertIn(said, title)

    def test_why_does_it_disagree(self):
        done, title = self.first(WHY)
        self.assertIn("effect_found", done.stdout)
        self.assertIn("bench.csv: inertia_change at inertia:I3", title)

    @of_the_thesis
    def test_is_it_fast_enough(self):
        done, title = self.first(FAST, any_exit=True)
        self.assertIn(done.returncode, (0, 4, 5), "on a machine that runs tests nothing is promised")
        self.assertIn("suppression/adaptive", title)
        self.assertIn("step, median", done.stdout)

    @of_the_thesis
    def test_what_would_the_checks_not_see(self):
        (script,) = blocks("README.md", "sh", BLIND)
        said = self.script(script)
        self.assertIn("met        stiffness_change is to be seen at 0.05", said)
        self.assertIn('still fail "golden T"', said)
        self.assertIn("usual error", (self.folder / "out/probe.html").read_text().split("</title>")[0])

    def test_the_commands_of_the_readme(self):
        (self.folder / "my_line.toml").unlink()
        (script,) = blocks("README.md", "sh", SECTION)
        self.assertIn("pass", self.script(script))
        self.assertTrue((self.folder / "out/my_line.h5").exists())

    def test_a_record_of_ones_own(self):
        """The commands of the README, and what they find: the numbers that the trace came from, which are not the nominal ones."""
        (self.folder / "my_line.toml").unlink()
        (script,) = blocks("README.md", "sh", RECORD)
        self.script(script)
        last = [line for line in script.splitlines() if " identify " in line][0]
        found = self.document(last.replace("build/", ""))["parameters"]
        for key, true in (("plant.inertia.I3", 0.52), ("plant.shaft.k2.stiffness_Nm_per_rad", 2.5e5)):
            # A band-limited interpolation is that good up to 0.8 of half the sampling rate, where this chirp ends.
            self.assertAlmostEqual(found[key]["value"] / true, 1.0, delta=1e-4, msg=key)

    def test_model_against_model(self):
        (script,) = blocks("engine/diagnosis/README.md", "sh", "Model against model")
        said = self.script(script)
        self.assertNotIn("between their samples", said, "a trace says that its inputs are held")
        found = json.loads((self.folder / "out/two_models/in_what.json").read_text())
        self.assertEqual(found["verdict"], "effect_found")
        (friction,) = found["effects"]
        self.assertEqual((friction["name"], friction["at"]), ("coulomb_friction", "inertia:I3"))
        self.assertAlmostEqual(friction["parameters"]["T_c"]["value"], 5.0, delta=1e-3)

    def test_the_changes_of_the_pages(self):
        (excerpt,), changes = blocks("README.md", "toml"), CHANGES
        self.assertEqual(len(changes), 4)
        for line in excerpt.splitlines():
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
        cubic, play, load, effect = CHANGES
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
