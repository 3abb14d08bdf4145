#!/usr/bin/env python3
"""What a person waits for, in CPU seconds of all processes: from a clone of HEAD in a folder of its own, with a compiler cache
that is empty, each row from where the one before it has left off.

  ci/waiting.py --json waiting.json          all rows; some two hours of CPU time
  ci/waiting.py all_scenarios reproduce      these alone, by the program of build/
  ci/waiting.py --json ci/waiting.json gate  a row once more; the others stay in the file
  ci/waiting.py --before f15ffe3 reproduce   of that commit first, then of HEAD, each built in a clone of its own
  ci/waiting.py --readme write               the table in ci/README.md, from ci/waiting.json; `check`: 1 where it is another

The file is what `history add` keeps and `ci/nightly.sh` writes. Ends with 1 where a command fails."""
import argparse
import itertools
import json
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import block

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "ci/waiting.json"
# Name, CPU s as first measured, goal, what it is; those of a person's own build come after those that begin from nothing.
ROWS = [
    ("first_table", 1143, 360, "./ci/run.sh of one scenario from nothing, to its table"),
    ("all_built", None, None, "everything else from there, the tests among it"),
    ("after_a_header", 585, 90, "everything once more after one line in model/component.h"),
    ("after_a_law", 1, 1, "the program once more after one line in a law"),
    ("all_scenarios", 181, 40, "run of all scenarios"),
    ("all_scenarios_again", None, 40, "run of all scenarios once more, with --kept"),
    ("reproduce", 17, 5, "reproduce all"),
    ("tests", 3000, 1800, "ci/run.sh and ci/test.sh from nothing, as .ci/run calls them"),
    ("gate", 3240, 2160, ".ci/run from nothing"),
]


def cpu_s():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


class Waiting:
    """Rows of one commit: of None by the program of build/, as far as they need no build from nothing."""

    def __init__(self, folder, commit=None):
        folder.mkdir()
        self.folder, self.commit = folder, commit
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
        if self.commit:
            subprocess.check_call(["git", "-C", str(tree), "checkout", "-q", self.commit])
        self.environment["CCACHE_DIR"] = str(self.folder / f"{name}_cache")
        return tree

    def measure(self, names):
        one_more = any(name in names for name in ("after_a_header", "after_a_law"))
        named = set(names) | ({"first_table", "all_built"} if one_more or "all_built" in names else set())
        if "all_scenarios_again" in named:
            named.add("all_scenarios")
        if self.commit and named - {"tests", "gate"}:
            named.add("first_table")
        tree = self.clone("tree") if "first_table" in named else ROOT
        for name in [name for name, *_ in ROWS if name in named - {"tests", "gate"}]:
            if name == "all_scenarios_again" and not self.keeps(tree):
                continue
            if name == "after_a_header":
                self.touch(tree / "engine/model/component.h")
            if name == "after_a_law":
                self.touch(tree / "engine/plugins/law/dry_friction/dry_friction.cc")
            yield name, *self.run(name, tree, self.command_of(name, tree))
        if named & {"tests", "gate"}:
            yield from self.parts_of_the_gate()

    def parts_of_the_gate(self):
        """The gate's commands one after the other in a clone of its own: what they take together, and what a person's tests are of
        them. Whoever measures has tried the gate."""
        tree = self.clone("gate")
        commands = [line.split() for line in (tree / ".ci/run").read_text().splitlines() if line.startswith("./ci/")]
        seconds = {command[0]: self.run(pathlib.Path(command[0]).stem, tree, command) for command in commands}
        for name, parts in (("tests", ["./ci/run.sh", "./ci/test.sh"]), ("gate", list(seconds))):
            yield name, *(sum(seconds[part][of] for part in parts) for of in (0, 1))

    @staticmethod
    def keeps(tree):
        """Whether this program keeps samples from run to run: the first ones did not."""
        return "--kept" in subprocess.check_output([tree / "build/dynoproof", "run", "--help"], text=True)

    @staticmethod
    def touch(source):
        """One more line that a compiler sees: of a comment a compiler cache would know that it changes nothing."""
        with open(source, "a", encoding="utf-8") as file:
            file.write(f"[[maybe_unused]] inline constexpr int kWaitedFor{time.time_ns()} = 0;\n")

    def command_of(self, name, tree):
        # The program refuses --kept where $CI is set. The first of the two runs finds an empty folder, and computes everything.
        all_of_them = ["env", "-u", "CI", "./build/dynoproof", "run", "--out", str(self.folder / "out")]
        if name.startswith("all_scenarios") and self.keeps(tree):
            all_of_them += ["--kept", str(self.folder / "kept")]
        return {
            "first_table": ["./ci/run.sh", "r2r/soft_rotor_setup_1"],
            "all_built": ["./ci/build.sh", "build", "all"],
            "after_a_header": ["./ci/build.sh", "build", "all"],
            "after_a_law": ["./ci/build.sh", "build", "dynoproof"],
            "all_scenarios": all_of_them,
            "all_scenarios_again": all_of_them,
            "reproduce": ["./build/dynoproof", "reproduce", "all"],
        }[name]


def kept(file):
    """Rows of a file that was written before, by name: a row is measured alone where only it has changed."""
    if not file.exists():
        return {}
    return {one["name"].removeprefix("waiting/"): one for one in json.loads(file.read_text())["benchmarks"]}


def cell(value):
    return "" if value is None else f"{value:.0f}" if value >= 20 else f"{value:.3g}"


def table():
    figures = kept(RESULTS)
    lines = ["| what a person waits for | first, CPU s | now, CPU s | of before, in one run | s on two cores | goal, CPU s |", "|---|---|---|---|---|---|"]
    for name, first, goal, what in ROWS:
        figure = figures.get(name, {})
        cpu, before = figure.get("cpu_time"), figure.get("before_cpu_time")
        of_before = f"{cpu / before:.2f} of {cell(before)}" if before else ""
        lines.append(f"| {what} | {cell(first)} | {cell(cpu)} | {of_before} | {cell(figure.get('real_time'))} | {cell(goal)} |")
    return lines


def measured(folder, names, before):
    """Rows as entries of a benchmark's file, as they come. Each of a commit before is measured next to its row of now."""
    both = [Waiting(folder / "now").measure(names)] if before is None else [
        Waiting(folder / "before", before).measure(names), Waiting(folder / "now", "HEAD").measure(names)]
    seconds = {}
    for rows in itertools.zip_longest(*both):
        for row, prefix in zip(rows, ("before_", "")[-len(rows):]):
            if row is None:
                continue
            name, cpu, wall = row
            print(f"{name:20} {prefix.rstrip('_'):6} {cpu:8.1f} {wall:8.1f}", flush=True)
            seconds.setdefault(name, {}).update({prefix + "cpu_time": cpu, prefix + "real_time": wall})
        for name in [name for name, of in seconds.items() if "cpu_time" in of]:
            commit = {"before_commit": before} if before is not None else {}
            yield {"name": f"waiting/{name}", "run_type": "iteration", "iterations": 1, "time_unit": "s", **seconds.pop(name), **commit}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rows", nargs="*", metavar="ROW", help="of " + ", ".join(name for name, *_ in ROWS))
    parser.add_argument("--before", metavar="COMMIT", help="each row of this commit, too, and the table tells the ratio")
    parser.add_argument("--json", type=pathlib.Path, help="write the figures as a benchmark's")
    parser.add_argument("--readme", choices=["check", "write"])
    options = parser.parse_args()
    if options.readme == "write":
        return block.write("ci/README.md", "waiting", table())
    if options.readme == "check":
        return "ci/README.md says otherwise: ci/waiting.py --readme write" if block.read("ci/README.md", "waiting") != table() else None
    names = options.rows or [name for name, *_ in ROWS]
    unknown = sorted(set(names) - {name for name, *_ in ROWS})
    if unknown:
        parser.error(f"there is no row {', '.join(unknown)}")
    figures = kept(options.json) if options.json else {}
    with tempfile.TemporaryDirectory(prefix="waiting-") as folder:
        print(f"{'':20} {'':6} {'CPU s':>8} {'s':>8}")
        for figure in measured(pathlib.Path(folder), names, options.before):
            figures[figure["name"].removeprefix("waiting/")] = figure
            if options.json:  # as it comes: a night may be cut off
                options.json.write_text(json.dumps({"context": {"executable": "ci/waiting.py"},
                                                    "benchmarks": list(figures.values())}, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(main())
