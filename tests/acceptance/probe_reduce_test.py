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
        self.assertLess(said["lines"]["after"], 0.25 * said["lines"]["before"], text)
        self.assertLess(said["values"]["after"], 0.5 * said["values"]["before"], text)
        self.assertLess(said["seconds"]["after"], 0.1 * said["seconds"]["before"], text)
        # Both numbers are of files: lines that hold something, the one that says where it comes from apart.
        lines = [line for line in (self.folder / "small.toml").read_text().splitlines() if line and not line.startswith("#")]
        self.assertEqual(said["lines"]["after"], len(lines))
        run(self.folder, "run", "small.toml", "--json", "r.json", code=1)
        checks = json.loads((self.folder / "r.json").read_text())["scenarios"][0]["checks"]
        self.assertIn("golden T_shaft", [check["name"] for check in checks if check["verdict"] == "fail"])
        # The cause is the one that was planted: with the old value the small one passes, too.
        small = tomllib.loads((self.folder / "small.toml").read_text())
        self.assertEqual(small["plant"]["inertia"]["I3"], 0.6)
        run(self.folder, "run", "small.toml", "--set", "plant.inertia.I3=0.5")

    def test_reduce_keeps_a_fault_that_the_scenario_alone_does_not_have(self):
        # A check of the motion's size fails in any run that is too short: what is left passes it without --set.
        peak = '\n[[check]]\nkind = "bounded"\nsignal = "omega_1"\nbetween = [-0.05, 1000.0]\norigin = "goal"\n'
        (self.folder / "bound.toml").write_text(self.bare + peak)
        run(self.folder, "run", "bound.toml")
        drag = 'plant.load.drag={ on = "I1", law = "constant", T_0_Nm = 20.0 }'
        text = run(self.folder, "reduce", "bound.toml", "--set", drag, "--check", "bounded", "--out", "small_bound.toml")
        small = tomllib.loads((self.folder / "small_bound.toml").read_text())
        self.assertEqual(small["plant"]["load"]["drag"]["on"], next(iter(small["plant"]["inertia"])), text)
        run(self.folder, "run", "small_bound.toml", code=1)
        run(self.folder, "run", "small_bound.toml", "--set", "plant.load.drag.T_0_Nm=0.0")

    def test_reduce_cuts_a_record_to_where_it_differs(self):
        (self.folder / "bare.toml").write_text(self.bare)
        # The test bed's rotor starts to rub half-way; the record is whole and right but for that.
        run(self.folder, "run", "bare.toml", "--out", "r")
        run(self.folder, "export", "r/bare.h5", "--to", "csv", "--every", "5", "--out", "record.csv")
        rows = (self.folder / "record.csv").read_text().splitlines()
        run(self.folder, "run", "bare.toml", "--data", "record.csv", "--out", "r")
        head, names = rows[:2], rows[0].split(",")
        column, half = names.index("omega_1"), (len(rows) - 2) // 2
        data = [line.split(",") for line in rows[2:]]
        for row in data[half:]:
            row[column] = repr(float(row[column]) + 0.5)
        (self.folder / "record.csv").write_text("\n".join(head + [",".join(row) for row in data]) + "\n")
        self.assertIn("record omega_1", run(self.folder, "run", "bare.toml", "--data", "record.csv", "--out", "r", code=1))
        text = run(self.folder, "reduce", "bare.toml", "--data", "record.csv", "--check", "record omega_1", "--out", "cut.csv", "--json", "c.json")
        said = json.loads((self.folder / "c.json").read_text())
        self.assertLess(said["rows"]["after"], 0.2 * said["rows"]["before"], text)
        first, last = said["first_row"], said["first_row"] + said["rows"]["after"]
        self.assertTrue(first < half < last or first == half, text)
        # Numbers stand as they stood.
        cut = (self.folder / "cut.csv").read_text().splitlines()
        self.assertEqual([list(map(float, line.split(","))) for line in cut[2:]], [list(map(float, row)) for row in data[first:last]])
        self.assertIn("record omega_1", run(self.folder, "run", "bare.toml", "--data", "cut.csv", "--out", "r", code=1))
        self.assertLessEqual(said["runs"], 100)

    def test_reduce_cuts_a_record_to_the_fault_that_check_data_finds(self):
        (self.folder / "bare.toml").write_text(self.bare)
        run(self.folder, "run", "bare.toml", "--out", "r")
        run(self.folder, "export", "r/bare.h5", "--to", "csv", "--every", "5", "--out", "falls.csv")
        self.assertIn("there is nothing to reduce", run(self.folder, "reduce", "bare.toml", "--data", "falls.csv", code=1))
        rows = (self.folder / "falls.csv").read_text().splitlines()
        data = [line.split(",") for line in rows[2:]]
        at, time = 600, rows[0].split(",").index("time")
        data[at][time] = data[at - 3][time]
        (self.folder / "falls.csv").write_text("\n".join(rows[:2] + [",".join(row) for row in data]) + "\n")
        self.assertIn("not_rising", run(self.folder, "check-data", "falls.csv", code=2))
        text = run(self.folder, "reduce", "bare.toml", "--data", "falls.csv", "--check", "not_rising", "--out", "cut.csv")
        self.assertIn("not_rising", run(self.folder, "check-data", "cut.csv", code=2), text)
        cut = (self.folder / "cut.csv").read_text().splitlines()
        self.assertLess(len(cut), 50, text)
        self.assertIn(",".join(data[at]), cut)
        self.assertIn("these do: not_rising", run(self.folder, "reduce", "bare.toml", "--data", "falls.csv", "--check", "gap", code=1))
        self.assertIn("is the record itself", run(self.folder, "reduce", "bare.toml", "--data", "falls.csv", "--out", "falls.csv", code=2))

    def test_reduce_says_what_fails_and_overwrites_no_scenario(self):
        # What `run` refuses is no failing check: an oracle that knows no friction.
        oracle = '\n[[check]]\nkind = "oracle"\noracle = "held_input_exponential"\nsignal = "T_shaft"\nnrmse = 1e-6\norigin = "goal"\n'
        (self.folder / "oracle.toml").write_text(self.bare + oracle)
        rub = 'plant.load.rub={ on = "I2", law = "coulomb", T_c_Nm = 1.0 }'
        for command in ("run", "reduce"):
            self.assertIn("does not apply", run(self.folder, command, "oracle.toml", "--set", rub, code=2))
        self.assertIn("no check fails", run(self.folder, "reduce", "line.toml", code=1))
        self.assertIn("these fail: golden", run(self.folder, "reduce", "line.toml", "--set", "plant.inertia.I3=0.6", "--check", "peak",
                                                code=1))
        self.assertIn("is the scenario itself", run(self.folder, "reduce", "line.toml", "--out", "line.toml", code=2))


if __name__ == "__main__":
    for variable in ("CI", "DYNOPROOF_SCENARIOS", "DYNOPROOF_GOLDEN"):  # a person's machine: in a pipeline nothing is blessed
        os.environ.pop(variable, None)
    unittest.main()
