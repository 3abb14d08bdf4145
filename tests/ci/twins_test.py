#!/usr/bin/env python3
"""ci/check_twins.py sees what two sources of a layer both call by one name, lets overloads be, and lets the sources pass."""
import pathlib
import subprocess
import tempfile
import unittest

from scripts import ROOT

FIRST = """namespace dynoproof {
namespace {

constexpr double kFar = 100.0, kNear = 1.0;  // m

struct Point {
  double x;
};

/// Of a number.
double Half(double x) { return 0.5 * x; }

}  // namespace
}  // namespace dynoproof
"""


class Twins(unittest.TestCase):
    def setUp(self):
        self.tree = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.write("reports/page.cc", "int a;\n")
        self.write("engine/base/first.cc", FIRST)
        self.write("engine/score/of_another_layer.cc", FIRST)

    def write(self, name, text):
        (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
        (self.tree / name).write_text(text)

    def check(self, tree=None):
        return subprocess.run([ROOT / "ci/check_twins.py", tree or self.tree], capture_output=True, text=True, timeout=60)

    def second(self, line):
        self.write("engine/base/second.cc", f"namespace dynoproof {{\nnamespace {{\n\n{line}\n\n}}  // namespace\n}}  // namespace dynoproof\n")
        return self.check()

    def test_the_sources_pass(self):
        done = self.check(ROOT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_sees_each_kind(self):
        self.assertEqual(self.check().returncode, 0)
        for line, name in (("constexpr double kNear = 2.0;", "kNear"), ("class Point {", "Point"), ("enum Point {", "Point"),
                           ("double Half(double whole) {\n  return whole / 2.0;\n}", "Half")):
            with self.subTest(line=line):
                done = self.second(line)
                self.assertEqual(done.returncode, 1, done.stdout)
                self.assertIn(f"engine/base/first.cc and engine/base/second.cc: both have a {name} in dynoproof", done.stdout)

    def test_lets_overloads_and_others_be(self):
        for line in ("double Half(const std::string& x) { return 0.0; }", "double Half(double x, double y) { return x + y; }",
                     "constexpr double kNearer = 2.0;", "  constexpr double kNear = 2.0;"):
            with self.subTest(line=line):
                done = self.second(line)
                self.assertEqual(done.returncode, 0, done.stdout)

    def test_sees_what_a_header_declares(self):
        self.write("engine/score/point.h", "namespace dynoproof {\n\nstruct Point {\n};\n\n}  // namespace dynoproof\n")
        done = self.check()
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertIn("engine/base/first.cc: has a Point beside that of engine/score/point.h", done.stdout)

    def test_fails_where_nothing_is_found(self):
        for name in ("engine/base/first.cc", "engine/score/of_another_layer.cc"):
            self.write(name, "int a;\n")
        self.assertNotEqual(self.check().returncode, 0)


if __name__ == "__main__":
    unittest.main()
