#!/usr/bin/env python3
"""An exported unit, as an importer has it: unzipped, its description read, its library loaded and stepped through ctypes. The
declarations here are those of the FMI 2.0 document. fmu_test.py PROGRAM"""
import ctypes
import os
import pathlib
import signal
import subprocess
import sys
import unittest
import xml.etree.ElementTree as xml
import zipfile

import numpy as np

from steps import Steps, blocks

Steps.program = os.path.abspath(sys.argv.pop())

OK, WARNING, DISCARD, ERROR = range(4)
LOGGER = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p, ctypes.c_char_p)


class Callbacks(ctypes.Structure):
    _fields_ = [("logger", LOGGER), ("allocate", ctypes.c_void_p), ("free", ctypes.c_void_p), ("finished", ctypes.c_void_p),
                ("environment", ctypes.c_void_p)]


class Unit:
    """One unit and what it said."""

    def __init__(self, file, folder):
        with zipfile.ZipFile(file) as archive:
            assert archive.testzip() is None
            archive.extractall(folder)
        self.folder = pathlib.Path(folder)
        self.description = xml.parse(self.folder / "modelDescription.xml").getroot()
        self.guid = self.description.get("guid")
        self.variables = {one.get("name"): one for one in self.description.iter("ScalarVariable")}
        identifier = self.description.find("CoSimulation").get("modelIdentifier")
        self.library = ctypes.CDLL(str(self.folder / "binaries" / "linux64" / f"{identifier}.so"))
        self.library.fmi2Instantiate.restype = ctypes.c_void_p
        self.library.fmi2GetVersion.restype = self.library.fmi2GetTypesPlatform.restype = ctypes.c_char_p
        self.told = []
        self.logger = LOGGER(lambda _, name, status, category, form, text: self.told.append((status, text.decode())))
        self.callbacks = Callbacks(self.logger, None, None, None, None)

    def names(self, causality):
        return [name for name, one in self.variables.items() if one.get("causality") == causality]

    def instance(self, guid=None, name="one"):
        component = self.library.fmi2Instantiate(name.encode(), 1, (guid or self.guid).encode(), (self.folder / "resources").as_uri().encode(),
                                                 ctypes.byref(self.callbacks), 0, 0)
        return Instance(self, component) if component else None


class Instance:
    def __init__(self, unit, component):
        self.unit, self.component = unit, ctypes.c_void_p(component)

    def call(self, function, *arguments):
        return getattr(self.unit.library, "fmi2" + function)(self.component, *arguments)

    def references(self, names):
        return (ctypes.c_uint * len(names))(*[int(self.unit.variables[name].get("valueReference")) for name in names])

    def set(self, **values):
        names = list(values)
        return self.call("SetReal", self.references(names), ctypes.c_size_t(len(names)), (ctypes.c_double * len(names))(*values.values()))

    def get(self, *names):
        values = (ctypes.c_double * len(names))()
        status = self.call("GetReal", self.references(names), ctypes.c_size_t(len(names)), values)
        assert status == OK, self.unit.told
        return list(values)

    def begin(self, **parameters):
        assert self.call("SetupExperiment", 0, ctypes.c_double(0), ctypes.c_double(0), 0, ctypes.c_double(0)) == OK
        assert self.call("EnterInitializationMode") == OK
        if parameters:
            assert self.set(**{name.replace("__", "."): value for name, value in parameters.items()}) == OK
        return self.call("ExitInitializationMode")

    def step(self, now, step):
        return self.call("DoStep", ctypes.c_double(now), ctypes.c_double(step), 1)

    def end(self):
        self.call("Terminate")
        self.unit.library.fmi2FreeInstance(self.component)


class Fmu(Steps):
    def setUp(self):
        super().setUp()
        self.write("pendulum.toml", blocks("engine/plugins/plant/equations/README.md", "toml", "plant `equations`")[0])
        self.shell("dynoproof export --fmu pendulum.toml --out pendulum.fmu")
        self.unit = Unit(self.folder / "pendulum.fmu", self.folder / "unit")

    def write(self, name, text):
        (self.folder / name).write_text(text)

    def course(self, instance, force, step_s, *names):
        """Outputs at each communication point."""
        rows = [instance.get(*names)]
        for i, value in enumerate(force):
            self.assertEqual(OK, instance.set(F=value))
            self.assertEqual(OK, instance.step(i * step_s, step_s), self.unit.told)
            rows.append(instance.get(*names))
        return np.array(rows)

    def test_is_described_as_the_standard_wants_it(self):
        unit = self.unit.description
        self.assertEqual(("fmiModelDescription", "2.0", "flat"), (unit.tag, unit.get("fmiVersion"), unit.get("variableNamingConvention")))
        self.assertEqual("true", unit.find("CoSimulation").get("needsExecutionTool"))
        self.assertEqual((["F"], ["x", "q"]), (self.unit.names("input"), self.unit.names("output")))
        self.assertIn("plant.parameter.l_m", self.unit.names("parameter"))
        length = self.unit.variables["plant.parameter.l_m"]
        self.assertEqual(("fixed", "0.3", "m"), (length.get("variability"), length.find("Real").get("start"), length.find("Real").get("unit")))
        self.assertLessEqual({"N", "m", "rad"}, {one.get("name") for one in unit.iter("Unit")})
        self.assertEqual("0.001", unit.find("DefaultExperiment").get("stepSize"))
        # An index counts the variables from 1.
        order = list(self.unit.variables)
        listed = [order[int(one.get("index")) - 1] for one in unit.find("ModelStructure").find("Outputs")]
        self.assertEqual(["x", "q"], listed)
        self.assertEqual([str(i) for i in range(len(order))], [one.get("valueReference") for one in self.unit.variables.values()])
        self.assertEqual((b"2.0", b"default"), (self.unit.library.fmi2GetVersion(), self.unit.library.fmi2GetTypesPlatform()))

    def test_shows_the_functions_of_the_standard_and_no_others(self):
        """What else it holds, a library of C++ of another importer must not meet."""
        library = next((self.folder / "unit" / "binaries" / "linux64").iterdir())
        shown = self.shell(f"nm -D --defined-only {library}").stdout.split()[2::3]
        self.assertEqual([], [name for name in shown if not name.startswith("fmi2")])
        self.assertEqual(34, len(shown))

    def test_goes_as_the_run_goes_to_the_bit(self):
        """The same force, period by period, from a file and from an importer."""
        force = np.round(1.5 * np.sin(np.arange(400) * 0.02) + (np.arange(400) > 150), 6)
        times = ", ".join(f"{i * 1e-3:.3f}" for i in range(400))
        values = ", ".join(repr(float(v)) for v in force)
        text = (self.folder / "pendulum.toml").read_text()
        begin, end = text.index("source = {"), text.index("\n", text.index("source = {"))
        self.write("given.toml", text[:begin] + f'source = {{ type = "jump", times_s = [{times}], values = [{values}] }}' + text[end:])
        self.shell("dynoproof run given.toml --set run.duration_s=0.4 --out given")
        self.shell("dynoproof export given/given.h5 --to csv --out given.csv")
        header, _, *rows = (self.folder / "given.csv").read_text().splitlines()  # names, units, numbers
        run = dict(zip(header.split(","), np.array([[float(v) for v in row.split(",")] for row in rows]).T))
        instance = self.unit.instance()
        self.assertEqual(OK, instance.begin())
        rows = self.course(instance, force, 1e-3, "x", "q")
        instance.end()
        for k, name in enumerate(("x", "q")):
            self.assertEqual(401, len(run[name]))
            self.assertEqual(0.0, np.abs(rows[:, k] - run[name]).max(), name)
        self.assertGreater(np.abs(rows[:, 1]).max(), 0.1)

    def test_begins_with_what_was_set_before(self):
        """An output that follows its input at once, and one behind a parameter."""
        self.write("through.toml", """title = "A gain"
[run]
duration_s = 0.1
period_s = 1e-3
[plant]
type = "equations"
[plant.parameter]
g = 2.0
[plant.input]
u = { unit = "1" }
[plant.state]
x = { rate = "u - x" }
[plant.output]
y = { value = "g*u + x" }
[input.u]
to = "plant.u"
source = { type = "constant", value = 0.5 }
[output.y]
of = "plant.y"
[output.x]
of = "plant.x"
""")
        self.shell("dynoproof export --fmu through.toml --out through.fmu")
        unit = Unit(self.folder / "through.fmu", self.folder / "through")
        plain, told = unit.instance(), unit.instance()
        self.assertEqual(OK, plain.begin())
        self.assertEqual([1.0], plain.get("y"))
        self.assertEqual(OK, told.set(u=3.0))
        self.assertEqual(OK, told.begin(plant__parameter__g=4.0))
        self.assertEqual([12.0, 0.0], told.get("y", "x"))
        plain.end()
        told.end()

    def test_takes_parameters_steps_of_many_periods_and_a_second_instance(self):
        one, other = self.unit.instance(name="one"), self.unit.instance(name="other")
        self.assertEqual((OK, OK), (one.begin(), other.begin(plant__parameter__l_m=0.6)))
        self.assertEqual([0.6], other.get("plant.parameter.l_m"))
        single = self.course(one, [1.0] * 100, 1e-3, "q")[-1, 0]
        longer = self.course(other, [1.0] * 4, 25e-3, "q")[-1, 0]
        self.assertNotAlmostEqual(single, longer, places=3)
        self.assertEqual(ERROR, one.set(**{"plant.parameter.l_m": 0.6}))
        self.assertIn("before the initialization ends", self.unit.told[-1][1])
        self.assertEqual(OK, one.call("Reset"))
        self.assertEqual(OK, one.begin(plant__parameter__l_m=0.6))
        self.assertEqual(longer, self.course(one, [1.0] * 100, 1e-3, "q")[-1, 0])
        one.end()
        other.end()

    def test_says_what_an_importer_does_wrong(self):
        self.assertIsNone(self.unit.instance(guid="another"))
        self.assertIn("guid", self.unit.told[-1][1])
        instance = self.unit.instance()
        self.assertEqual(ERROR, instance.step(0.0, 1e-3))
        self.assertEqual(OK, instance.begin())
        for now, step, told in ((0.0, 1.5e-3, "no whole number of periods"), (0.5, 1e-3, "the unit is at 0"), (0.0, 0.0, "no whole number")):
            self.assertEqual(ERROR, instance.step(now, step))
            self.assertIn(told, self.unit.told[-1][1])
        self.assertEqual(ERROR, instance.set(x=1.0))
        self.assertIn("output", self.unit.told[-1][1])
        self.assertEqual(OK, instance.set(F=float("nan")))
        self.assertEqual(ERROR, instance.step(0.0, 1e-3))
        self.assertIn("input F is nan", self.unit.told[-1][1])
        instance.end()
        wrong = self.unit.instance()
        self.assertEqual(ERROR, wrong.begin(plant__parameter__l_m=float("nan")))
        self.assertIn("l_m", self.unit.told[-1][1])
        wrong.end()

    def test_survives_the_death_of_its_program(self):
        instance = self.unit.instance()
        self.assertEqual(OK, instance.begin())
        children = subprocess.run(["pgrep", "-P", str(os.getpid()), "-f", "fmu-server"], capture_output=True, text=True, check=False).stdout.split()
        self.assertEqual(1, len(children))
        os.kill(int(children[0]), signal.SIGKILL)
        self.assertEqual(ERROR, instance.step(0.0, 1e-3))
        self.assertIn("the program has ended", self.unit.told[-1][1])
        instance.end()
        os.environ["DYNOPROOF_PROGRAM"] = "/nowhere/dynoproof"
        try:
            self.assertIsNone(self.unit.instance())
        finally:
            del os.environ["DYNOPROOF_PROGRAM"]
        self.assertIn("DYNOPROOF_PROGRAM", self.unit.told[-1][1])

    def test_is_the_same_file_each_time_and_names_its_faults(self):
        first = (self.folder / "pendulum.fmu").read_bytes()
        self.shell("dynoproof export --fmu pendulum.toml --out pendulum.fmu")
        self.assertEqual(first, (self.folder / "pendulum.fmu").read_bytes())
        for wrong in ("", "--fmu nothing.toml", "trace.h5 --fmu pendulum.toml", "--fmu pendulum.toml --set plant.parameter.l_m=wrong"):
            self.shell(f"dynoproof export {wrong}", exit=2)


if __name__ == "__main__":
    unittest.main()
