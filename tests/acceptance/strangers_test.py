#!/usr/bin/env python3
"""What a plugin of a stranger does to the program, it does to its own scenario. strangers_test.py PROGRAM STUMBLE USURPER"""
import hashlib
import json
import os
import pathlib
import sys
import unittest

from steps import Steps

USURPER, STUMBLE = os.path.abspath(sys.argv.pop()), os.path.abspath(sys.argv.pop())
Steps.program = os.path.abspath(sys.argv.pop())


class Strangers(Steps):
    def setUp(self):
        super().setUp()
        self.shell("dynoproof new scenario sound && sed -i 's/^duration_s = 2.0/duration_s = 0.05/' sound.toml")
        text = (self.folder / "sound.toml").read_text()
        source = next(line for line in text.splitlines() if line.startswith("source = {"))
        for stumble in range(8):
            (self.folder / f"bad_{stumble}.toml").write_text(text.replace(source, f'source = {{ type = "stumble", stumble = {stumble} }}'))

    def run_with(self, *scenarios, more="", exit=3):
        done = self.shell(f"dynoproof run {' '.join(scenarios)} --plugin {STUMBLE} --json all.json --html all.html {more}", exit=exit)
        return done, {one["id"]: one for one in json.loads((self.folder / "all.json").read_text())["scenarios"]}

    def test_each_fault_costs_its_scenario_and_no_other(self):
        for stumble, said in ((1, "crashed: signal 6"), (2, "crashed: signal 11"), (3, "stumbled"), (4, "not a finite number"),
                              (5, "took longer than 2 s"), (6, "none of the standard library's"), (7, "ended the program before it had a result")):
            with self.subTest(stumble):
                done, results = self.run_with(f"bad_{stumble}.toml", "sound.toml", more="--most-seconds 2 --jobs 2")
                self.assertEqual(("broken", "pass"), (results[f"bad_{stumble}"]["verdict"], results["sound"]["verdict"]), done.stdout)
                self.assertIn(said, done.stdout)
                self.assertTrue((self.folder / "out/sound.h5").exists())
                page = (self.folder / "all.html").read_text()
                self.assertIn("</html>", page)
                self.assertIn('id="data-sound', page, "the pictures of the sound one came back from its process")

    def test_a_sound_run_is_the_same_in_a_process_of_its_own(self):
        _, apart = self.run_with("bad_0.toml", "sound.toml", exit=0)
        trace = (self.folder / "out/sound.h5").read_bytes()
        alone = self.document("dynoproof run sound.toml --out alone")["scenarios"][0]
        for key in ("checks", "figures", "counters", "verdict", "title"):
            self.assertEqual(alone.get(key), apart["sound"].get(key), key)
        self.assertNotEqual(trace, (self.folder / "alone/sound.h5").read_bytes(), "it names the plugin")
        self.assertIn(f"stumble_plugin.so sha256 {hashlib.sha256(pathlib.Path(STUMBLE).read_bytes()).hexdigest()}".replace("lib", ""),
                      (self.folder / "all.html").read_text().replace("libstumble", "stumble"))

    def test_memory_has_a_limit(self):
        done = self.shell("dynoproof run sound.toml --set run.duration_s=20 --most-memory 1", exit=3)
        self.assertIn("BROKEN sound", done.stdout)

    def test_a_name_that_is_taken_is_refused(self):
        done = self.shell(f"dynoproof run sound.toml --plugin {USURPER}", exit=2)
        self.assertIn('source "chirp" is there already, from dynoproof itself', done.stderr)
        twice = self.shell(f"cp {STUMBLE} other.so && dynoproof list --plugin {STUMBLE} --plugin other.so", exit=2)
        self.assertIn('source "stumble" is there already, from /', twice.stderr)
        self.shell(f"dynoproof run bad_0.toml --plugin {STUMBLE} --plugin {STUMBLE}")  # one file, named twice


if __name__ == "__main__":
    unittest.main()
