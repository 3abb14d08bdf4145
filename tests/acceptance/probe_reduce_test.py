#!/usr/bin/env python3
"""`probe` and `reduce` as a person uses them on a line of his own: what the checks would not see, the gate that asks for it, findings
that are kept, and the smallest pair of scenarios that still differs. probe_reduce_test.py PROGRAM"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

PROGRAM = str(pathlib.Path(sys.argv.pop(1)).resolve())


def run(folder, *words, code=0):
    done = subprocess.run([PROGRAM, *words], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, f"{words} ended with {done.returncode}, not {code}\n{done.stdout}\n{done.stderr}"
    return done.stdout + done.stderr


class OnALine(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp(prefix="probe-"))
        run(cls.folder, "new", "scenario", "line")
        cls.line = cls.folder / "line.toml"
        cls.line.write_text(cls.line.read_text().replace("duration_s = 2.0", "duration_s = 0.5"))
        cls.bare = cls.line.read_text()
        cls.line.write_text(cls.bare + '\n[[check]]\nkind = "golden"\n')
        run(cls.folder, "bless", "line.toml", "--reason", "first")
        golden = cls.folder / "line.golden.toml"
        golden.write_text(golden.read_text().replace("relative_width = 1e-07", "relative_width = 0.02"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder, ignore_errors=True)

    def probe(self, *more, code=0):
        run(self.folder, "probe", "line.toml", "--json", "p.json", *more, code=code)
        return json.loads((self.folder / "p.json").read_text())

    def test_limits_are_those_that_the_check_has(self):
        limits = self.probe("--effects", "sensor_offset,coulomb_friction,stiffness_change")["limits"]
        of = {(one["effect"], one["at"], one["direction"]): one for one in limits}
        # A tube of 2 % of 1 rad/s and of 100 N m.
        self.assertAlmostEqual(of["sensor_offset", "output:omega_1", "+"]["smallest"], 0.02, delta=0.001)
        self.assertAlmostEqual(of["sensor_offset", "output:T_shaft", "-"]["smallest"], 2.0, delta=0.1)
        self.assertEqual(of["sensor_offset", "output:T_shaft", "-"]["unit"], "N m")
        self.assertEqual(of["sensor_offset", "output:omega_1", "+"]["seen_by"], "golden omega_1")
        # What is stated holds in `run`: a fifth more fails, a fifth less passes.
        self.addCleanup(self.line.write_text, self.line.read_text())
        for effect, at in (("coulomb_friction", "inertia:I2"), ("stiffness_change", "shaft:k1")):
            one = of[effect, at, "+"]
            for factor, code in ((1.2, 1), (1 / 1.2, 0)):
                numbers = ", ".join(f"{name} = {value * factor!r}" for name, value in one["parameters"].items())
                self.line.write_text(self.bare + '\n[[check]]\nkind = "golden"\n'
                                                       f'[[effect]]\nname = "{effect}"\nat = "{at}"\nparameters = {{ {numbers} }}\n')
                done = subprocess.run([PROGRAM, "run", "line.toml", "--json", "r.json"], cwd=self.folder, capture_output=True)
                checks = json.loads((self.folder / "r.json").read_text())["scenarios"][0]["checks"]
                # Counters of the solver tell friction at any strength, and nothing of the model; `probe` does not ask them.
                fails = [check["name"] for check in checks if check["verdict"] != "pass" and check["kind"] == "tube"]
                self.assertEqual(bool(fails), bool(code), f"{effect} {factor}: {fails} {done.stderr}")

    def test_a_demand_makes_a_gate_of_it(self):
        met = self.probe("--effects", "sensor_offset", "--see", "stiffness_change=5%", "--see", "turned_sign")
        self.assertEqual([one["met"] for one in met["demands"]], [True, True])
        unmet = self.probe("--effects", "sensor_offset", "--see", "sensor_offset=0.01", code=1)
        self.assertEqual(set(unmet["demands"][0]["passes_at"]), {"output:T_shaft", "output:omega_1"})
        self.assertIn('did you mean "stiffness_change"', run(self.folder, "probe", "line.toml", "--see", "stifness_change", code=2))

    def test_without_a_check_of_its_own_nothing_is_seen_and_that_is_said(self):
        (self.folder / "bare.toml").write_text(self.bare)
        self.assertIn("no check takes part, not windows", run(self.folder, "probe", "bare.toml", code=1))
        self.assertIn("no check takes part", run(self.folder, "probe", "line.toml", "--without", "golden", code=1))

    def test_what_was_found_is_not_looked_for_again(self):
        first = self.probe("--effects", "stiffness_change", "--resume", "kept.txt")
        self.assertGreater(first["runs"], 10)
        kept = (self.folder / "kept.txt").read_text().splitlines()
        self.assertEqual(len(kept), 1 + len(first["limits"]))
        # A call that was cut off in the middle of a line.
        (self.folder / "kept.txt").write_text("\n".join(kept[:2]) + "\n" + kept[2][:20])
        again = self.probe("--effects", "stiffness_change", "--resume", "kept.txt")
        self.assertLess(again["runs"], first["runs"])
        self.assertEqual(again["limits"], first["limits"])
        self.assertIn("of another scenario", run(self.folder, "probe", "line.toml", "--set", "run.duration_s=0.4", "--without", "golden",
                                                 "--resume", "kept.txt", code=2))

    def test_what_it_proposes_halves_what_passes(self):
        before = self.probe("--effects", "sensor_offset,sensor_gain", "--write", "lines.toml")
        holes = [one for one in before["limits"] if one["hole"]]
        self.assertTrue(holes)
        lines = tomllib.loads((self.folder / "lines.toml").read_text())
        golden = self.folder / "line.golden.toml"
        self.addCleanup(golden.write_text, golden.read_text())
        text = golden.read_text()
        for name, of in lines["signal"].items():
            head, rest = text.split(f"[signal.{name}]\n", 1)
            text = head + f"[signal.{name}]\n" + rest.replace("relative_width = 0.02", f"relative_width = {of['relative_width']!r}", 1)
        golden.write_text(text)
        after = {(one["effect"], one["at"], one["direction"]): one for one in
                 self.probe("--effects", "sensor_offset,sensor_gain")["limits"]}
        for one in holes:
            now = after[one["effect"], one["at"], one["direction"]]
            self.assertLessEqual(now["smallest"], 0.55 * one["usual"], now)
        # And both solvers still pass.
        run(self.folder, "run", "line.toml")
        run(self.folder, "run", "line.toml", "--solver", "reference")

    def test_a_page_shows_the_map(self):
        run(self.folder, "probe", "line.toml", "--effects", "sensor_offset", "--html", "p.html")
        page = (self.folder / "p.html").read_text()
        self.assertIn("usual errors would pass", page.split("</title>")[0])
        self.assertIn("output:omega_1", page)

    def test_reduce_leaves_the_pair_that_still_differs(self):
        text = run(self.folder, "reduce", "line.toml", "--set", "plant.inertia.I3=0.6", "--check", "golden T_shaft", "--out",
                   "small.toml", "--json", "s.json")
        said = json.loads((self.folder / "s.json").read_text())
        self.assertLessEqual(said["runs"], 101)
        self.assertLess(said["lines"]["after"], 0.6 * said["lines"]["before"], text)
        self.assertLess(said["seconds"]["after"], 0.1 * said["seconds"]["before"], text)
        run(self.folder, "run", "small.toml", "--json", "r.json", code=1)
        checks = json.loads((self.folder / "r.json").read_text())["scenarios"][0]["checks"]
        self.assertIn("golden T_shaft", [check["name"] for check in checks if check["verdict"] == "fail"])
        # The cause is the one that was planted: with the old value the small one passes, too.
        small = tomllib.loads((self.folder / "small.toml").read_text())
        self.assertEqual(small["plant"]["inertia"]["I3"], 0.6)
        run(self.folder, "run", "small.toml", "--set", "plant.inertia.I3=0.5")

    def test_reduce_says_what_fails_and_overwrites_no_scenario(self):
        self.assertIn("no check fails", run(self.folder, "reduce", "line.toml", code=1))
        self.assertIn("these fail: golden", run(self.folder, "reduce", "line.toml", "--set", "plant.inertia.I3=0.6", "--check", "peak",
                                                code=1))
        self.assertIn("is the scenario itself", run(self.folder, "reduce", "line.toml", "--out", "line.toml", code=2))


if __name__ == "__main__":
    for variable in ("CI", "DYNOPROOF_SCENARIOS", "DYNOPROOF_GOLDEN"):  # a person's machine: in a pipeline nothing is blessed
        os.environ.pop(variable, None)
    unittest.main()
