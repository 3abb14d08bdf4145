#!/usr/bin/env python3
"""What a person waits for, in CPU seconds of all processes: from a clone of HEAD in a folder of its own, with a compiler cache
that is empty, each row from where the one before it has left off.

  ci/waiting.py --json waiting.json          all rows; some two hours of CPU time
  ci/waiting.py all_scenarios reproduce      these alone, by the program of build/

The file is what `history add` keeps and `ci/nightly.sh` writes. Ends with 1 where a command fails."""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Name, goal [CPU s], what it is; those of a person's own build come after those that begin from nothing.
ROWS = [
    ("first_table", 360, "./ci/run.sh of one scenario from nothing, to its table"),
    ("all_built", None, "everything else from there, the tests among it"),
    ("after_a_header", 90, "everything once more after one line in model/component.h"),
    ("after_a_law", 1, "the program once more after one line in a law"),
    ("all_scenarios", 40, "run of all scenarios"),
    ("reproduce", 5, "reproduce all"),
    ("tests", 1800, "ci/test.sh from nothing"),
    ("gate", 2160, ".ci/run from nothing"),
]


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Waiting:
    def __init__(self, folder):
        self.folder = folder
        self.environment = dict(os.environ, CCACHE_DIR=str(folder / "cache"), CI="true")

    def run(self, name, tree, command):
        """CPU and wall seconds of a command; leaves with its last lines where it fails."""
        before, began = cpu_s(), time.monotonic()
        with open(self.folder / f"{name}.log", "wb") as log:
            code = subprocess.call(command, cwd=tree, env=self.environment, stdout=log, stderr=subprocess.STDOUT)
        if code != 0:
            sys.exit(f"{name}: {' '.join(command)} ended with {code}\n"
                     + (self.folder / f"{name}.log").read_text(errors="replace")[-3000:])
        return cpu_s() - before, time.monotonic() - began

    def clone(self, name):
        """A tree without anything built, and with nothing in its compiler cache."""
        tree = self.folder / name
        subprocess.check_call(["git", "clone", "-q", str(ROOT), str(tree)])
        self.environment["CCACHE_DIR"] = str(self.folder / f"{name}_cache")
        return tree

    def measure(self, names):
        one_more = any(name in names for name in ("after_a_header", "after_a_law"))
        named = set(names) | ({"first_table", "all_built"} if one_more or "all_built" in names else set())
        tree = self.clone("tree") if "first_table" in named else ROOT
        for name in [name for name, _, _ in ROWS if name in named]:
            if name == "after_a_header":
                self.touch(tree / "engine/model/component.h")
            if name == "after_a_law":
                self.touch(tree / "engine/plugins/law/dry_friction/dry_friction.cc")
            where = self.clone(name) if name in ("tests", "gate") else tree
            yield name, *self.run(name, where, self.command_of(name))

    @staticmethod
    def touch(source):
        """One more line that a compiler sees: of a comment a compiler cache would know that it changes nothing."""
        with open(source, "a", encoding="utf-8") as file:
            file.write(f"[[maybe_unused]] inline constexpr long long kWaitedFor = {time.time_ns()};\n")

    def command_of(self, name):
        return {
            "first_table": ["./ci/run.sh", "r2r/soft_rotor_setup_1"],
            "all_built": ["./ci/build.sh", "build", "all"],
            "after_a_header": ["./ci/build.sh", "build", "all"],
            "after_a_law": ["./ci/build.sh", "build", "dynoproof"],
            "all_scenarios": ["./build/dynoproof", "run", "--out", str(self.folder / "out")],
            "reproduce": ["./build/dynoproof", "reproduce", "all"],
            "tests": ["./ci/test.sh"],
            "gate": ["./.ci/run"],
        }[name]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="ROW", help="of " + ", ".join(name for name, _, _ in ROWS))
    parser.add_argument("--json", type=pathlib.Path, help="write the figures as a benchmark's")
    options = parser.parse_args()
    names = options.rows or [name for name, _, _ in ROWS]
    unknown = sorted(set(names) - {name for name, _, _ in ROWS})
    if unknown:
        parser.error(f"there is no row {', '.join(unknown)}")
    figures = []
    with tempfile.TemporaryDirectory(prefix="waiting-") as folder:
        print(f"{'':16} {'CPU s':>8} {'goal':>6} {'s':>8}")
        for name, cpu, wall in Waiting(pathlib.Path(folder)).measure(names):
            goal, what = next((goal, what) for row, goal, what in ROWS if row == name)
            print(f"{name:16} {cpu:8.1f} {'' if goal is None else goal:>6} {wall:8.1f}  {what}", flush=True)
            figures.append({"name": f"waiting/{name}", "run_type": "iteration", "iterations": 1, "cpu_time": cpu,
                            "real_time": wall, "time_unit": "s"})
            if options.json:  # as it comes: a night may be cut off
                options.json.write_text(json.dumps({"context": {"executable": "ci/waiting.py"}, "benchmarks": figures},
                                                   indent=1) + "\n")


if __name__ == "__main__":
    main()
