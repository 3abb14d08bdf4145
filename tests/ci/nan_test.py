#!/usr/bin/env python3
"""ci/check_nan.py sees a comparison with a limit that NaN would pass, and lets the sources pass."""
import pathlib
import subprocess
import tempfile
import unittest

from scripts import ROOT


class Nan(unittest.TestCase):
    def setUp(self):
        self.tree = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.write("engine/score/verdict.cc", "if (!Within(value, limit)) return kFail;\n")

    def write(self, name, text):
        (self.tree / name).parent.mkdir(parents=True, exist_ok=True)
        (self.tree / name).write_text(text)

    def check(self, tree=None):
        return subprocess.run([ROOT / "ci/check_nan.py", tree or self.tree], capture_output=True, text=True, timeout=60)

    def test_the_sources_pass(self):
        done = self.check(ROOT)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_sees_what_nan_would_pass(self):
        self.assertEqual(self.check().returncode, 0)
        lines = ("if (value > limit) return kFail;", "  } else if (errors.max > options.limit) {",
                 "return error >= limits.global;", "if (error > threshold && first) first = i;",
                 "bool ok = budget.step_us < p_.tolerance_Hz;", "if (x > 2.0 * p.allowed) fail();",
                 "if (limits.local < error.local) return;", "return value < spec.at_least;",
                 "if (summary.failing.value() > campaign.most_failing) return kShort;")
        for folder in ("score", "experiment", "history", "campaign", "thesis", "app"):
            self.write(f"engine/{folder}/judge.cc", "\n".join(lines))
        done = self.check()
        self.assertEqual(done.returncode, 1, done.stdout)
        for folder in ("score", "experiment", "history", "campaign", "thesis", "app"):
            for number, line in enumerate(lines, 1):
                self.assertIn(f"engine/{folder}/judge.cc:{number}: ", done.stdout, line)

    def test_lets_pass_what_is_none(self):
        for line in ("if (Reaches(value, limit)) return;", "if (value > limit) fail();  // NaN: was refused before",
                     'Fault("value > limit");', "// value > limit", "if (!(limit > 0.0)) return;",
                     "std::vector<GoldenTolerances> tolerances;", "auto f = [](const Limit& limit) -> limit_t { return {}; };"):
            with self.subTest(line=line):
                self.write("engine/score/judge.cc", line + "\n")
                self.assertEqual(self.check().returncode, 0, self.check().stdout)

    def test_fails_where_there_is_no_source(self):
        self.assertNotEqual(self.check(self.tree / "nothing").returncode, 0)


if __name__ == "__main__":
    unittest.main()
