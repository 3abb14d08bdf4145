#!/usr/bin/env python3
"""Every command that writes is ended, and failed, at each of its calls that change files, has allocations fail, and is killed at
random instants: nothing is lost, nothing is half there under a final name, and the next call works.

kill_points_test.py PROGRAM PRELOAD [--every N] [--kills N] [--json FILE]
kill_points_test.py . . --write tests/kill_points.json        the table in tests/README.md

--every   looks at each N-th call only; --kills: instants for each command; --allocations: how many of a command's fail;
--json    how many points were tried.
Ends with 1 where a rule is broken, with the point that did it."""
import argparse
import errno
import json
import os
import pathlib
import random
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

CAMPAIGN = """title = "Points"
scenario = "line.toml"
samples = 6
most_failing = 1.0
[[axis]]
key = "plant.inertia.I3"
uniform = [0.4, 0.6]
[figure.peak]
of = "T_shaft"
take = "peak"
"""


class Case:
    """A command that writes, in a folder as `before` has made it. `sound`: what holds of all files whatever the call came to;
    `again`: the next call, where that is another; `after`: what has to work behind that; `rows`: a table where a run for which
    there was no memory is a broken row with its reason and the others are as they are: then the command begins anew. What things
    cost differs from call to call."""

    def __init__(self, name, command, before=(), sound=lambda folder: None, again=None, after=(), rows=""):
        self.name, self.command, self.before, self.sound, self.after, self.rows = name, command, before, sound, after, rows
        self.again = again or command


def shell(folder, command, environment, check=True):
    done = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True, env=environment, timeout=300)
    if check and done.returncode not in (0, 1, 4):
        raise SystemExit(f"{command} ended with {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done


def files(folder):
    """What stands under final names: bytes by name."""
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*"))
            if file.is_file() and not file.name.startswith(".") and not file.name.endswith(("-journal", "-wal", "-shm"))}


def rows_with_reasons(data, whole):
    """The same lines but for rows that are broken and say why."""
    lines, expected = data.splitlines(), whole.splitlines()
    return len(lines) == len(expected) and all(
        one == other or re.fullmatch(rb'.*,broken,"(out of memory|crashed: signal)[^"]*"', one)
        for one, other in zip(lines, expected))


def json_is_whole(name):
    def sound(folder):
        if (folder / name).exists():
            json.loads((folder / name).read_text())
    return sound


def golden_is_one(folder):
    """The trace is the one that the tolerance file was written for, whichever of the two blessings that is."""
    said = subprocess.run(["dynoproof", "run", "line.toml", "--out", "seen"], cwd=folder, capture_output=True, text=True,
                          env=golden_is_one.environment)
    shutil.rmtree(folder / "seen", ignore_errors=True)
    text = said.stdout + said.stderr
    if said.returncode not in (0, 1) or "SHA-256 differs" in text or "cannot be read" in text:
        raise AssertionError(f"run ends with {said.returncode} beside half a golden pair\n{text}")


def database_is_whole(folder):
    if (folder / "h.sqlite").exists():
        with sqlite3.connect(folder / "h.sqlite") as database:
            assert database.execute("PRAGMA integrity_check").fetchone()[0] == "ok"


CASES = [
    Case("run", "dynoproof run line.toml --out out --json r.json --html p.html --junit j.xml --markdown m.md",
         sound=json_is_whole("r.json")),
    Case("run again", "dynoproof run line.toml --set plant.inertia.I3=0.6 --out out --json r.json --html p.html",
         before=["dynoproof run line.toml --out out --json r.json --html p.html"], sound=json_is_whole("r.json")),
    Case("bless", "dynoproof bless line.toml --reason second",
         before=["dynoproof bless line.toml --reason first", "sed -i 's/^I3 = 0.5 /I3 = 0.55 /' line.toml"], sound=golden_is_one),
    Case("history, the first night", "dynoproof history add r.json --db h.sqlite",
         before=["dynoproof run line.toml --json r.json"], sound=database_is_whole, after=["dynoproof history show --db h.sqlite"]),
    Case("history, one more", "dynoproof history add r.json --db h.sqlite",
         before=["dynoproof run line.toml --json r.json", "dynoproof history add r.json --db h.sqlite"], sound=database_is_whole,
         after=["dynoproof history show --db h.sqlite"]),
    Case("sweep", "dynoproof sweep sweep.toml --out swept --jobs 1", again="dynoproof sweep sweep.toml --out swept --jobs 1 --resume",
         rows="swept/sweep/table.csv"),
    Case("export", "dynoproof export out/line.h5 --to csv --out t.csv", before=["dynoproof run line.toml"]),
    Case("new map", "dynoproof new map t.csv --scenario line.toml",
         before=["dynoproof run line.toml", "dynoproof export out/line.h5 --to csv --out t.csv"],
         again="rm -f t.map.toml; dynoproof new map t.csv --scenario line.toml"),
    Case("check-data", "dynoproof check-data t.csv --scenario line.toml --json c.json",
         before=["dynoproof run line.toml", "dynoproof export out/line.h5 --to csv --out t.csv"], sound=json_is_whole("c.json")),
    Case("diagnose", "dynoproof diagnose line.toml --data t.csv --most-simulations 40 --out dg --html d.html --json d.json",
         before=["dynoproof run line.toml --set plant.inertia.I3=0.55", "dynoproof export out/line.h5 --to csv --out t.csv"],
         sound=json_is_whole("d.json")),
    Case("probe", "dynoproof probe line.toml --effects stiffness_change --resume kept.txt --html p.html --json p.json",
         before=["dynoproof bless line.toml --reason first"], sound=json_is_whole("p.json")),
    Case("reduce", "dynoproof reduce line.toml --set plant.inertia.I3=0.6 --out small.toml --json s.json",
         before=["dynoproof bless line.toml --reason first"], sound=json_is_whole("s.json")),
    Case("new project", "rm -rf mine && dynoproof new project mine"),
    Case("identify", "dynoproof identify line.toml --data t.csv --free plant.inertia.I3 --starts 1 --out found.toml --json i.json",
         before=["dynoproof run line.toml --set plant.inertia.I3=0.51", "dynoproof export out/line.h5 --to csv --out t.csv"],
         sound=json_is_whole("i.json")),
]


class Harness:
    def __init__(self, options):
        self.options, self.failures, self.tried = options, [], {}
        self.environment = {"PATH": f"{options.program.parent}:{os.environ['PATH']}", "HOME": "/nonexistent", "LC_ALL": "C.UTF-8"}
        golden_is_one.environment = self.environment
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="points-"))
        self.environment["TMPDIR"] = str(self.root / "scratch")  # what a killed call leaves there goes with the rest
        (self.root / "scratch").mkdir()

    def folder(self, case):
        """A folder in which `before` has been done, once; a copy for each try."""
        made = self.root / "made"
        shutil.rmtree(made, ignore_errors=True)
        made.mkdir()
        shell(made, "dynoproof new scenario line && sed -i 's/^duration_s = 2.0/duration_s = 0.05/' line.toml && "
                    "printf '\\n[[check]]\\nkind = \"golden\"\\n' >> line.toml", self.environment)
        (made / "sweep.toml").write_text(CAMPAIGN)
        for command in case.before:
            shell(made, command, self.environment)
        return made

    def copy(self, made):
        folder = self.root / "try"
        shutil.rmtree(folder, ignore_errors=True)
        shutil.copytree(made, folder)
        return folder

    def look(self, case, folder, before, whole, point, code=None):
        """What holds after a call that was cut short, and after the next one."""
        again = case.again
        try:
            there = files(folder)
            if case.rows and there.get(case.rows, whole[case.rows]) != whole[case.rows]:
                if not rows_with_reasons(there[case.rows], whole[case.rows]):
                    raise AssertionError(f"{case.rows} is neither what it becomes, nor are its other rows broken with a reason")
                base, again = pathlib.PurePath(case.rows).parent, f"rm -rf {pathlib.PurePath(case.rows).parts[0]}; {case.command}"
                there = {name: data for name, data in there.items() if base not in pathlib.PurePath(name).parents}
            for name, data in there.items():
                if not data and before.get(name) != b"" and whole.get(name) != b"":
                    raise AssertionError(f"{name} is empty")
                if name.endswith(".html") and b"</html>" not in data:
                    raise AssertionError(f"{name} is cut off")
                if name.endswith(".xml"):
                    xml.etree.ElementTree.fromstring(data)
                if name.endswith((".toml", ".csv", ".h5")) and "costs" not in name and data not in (before.get(name), whole.get(name)):
                    raise AssertionError(f"{name} is neither what it was nor what it becomes")
            for name in before:
                if not (folder / name).exists() and name in whole:
                    raise AssertionError(f"{name} is lost")
            case.sound(folder)
            if code == 0 and not set(whole) <= set(files(folder)):
                raise AssertionError(f"exit 0 without {sorted(set(whole) - set(files(folder)))}")
            done = shell(folder, again, self.environment)
            for command in case.after:
                shell(folder, command, self.environment)
            missing = set(whole) - set(files(folder))
            if missing:
                raise AssertionError(f"after the next call {sorted(missing)} is not there\n{done.stderr}")
            case.sound(folder)
        except (AssertionError, SystemExit, ValueError, SyntaxError, sqlite3.Error, subprocess.TimeoutExpired) as error:
            self.failures.append(f"{case.name}, {point}: {error}")

    def run(self, case):
        made = self.folder(case)
        before = files(made)
        folder, count = self.copy(made), self.root / "count"
        count.unlink(missing_ok=True)
        began = time.monotonic()
        preload = {"LD_PRELOAD": str(self.options.preload)}
        shell(folder, case.command, {**self.environment, **preload, "DYNOPROOF_POINT_COUNT": str(count)})
        length, whole = time.monotonic() - began, files(folder)
        counted = [[int(word) for word in line.split()] for line in count.read_text().splitlines()]
        points, allocations = (max(one[k] for one in counted) for k in (0, 1))
        ways = {"killed": {}, "disk full": {"DYNOPROOF_POINT_ERROR": str(errno.ENOSPC)},
                "i/o error": {"DYNOPROOF_POINT_ERROR": str(errno.EIO)}}
        tried = 0
        for way, more in ways.items():
            for point in range(1, points + 1, self.options.every):
                folder = self.copy(made)
                done = shell(folder, case.command, {**self.environment, **preload, **more, "DYNOPROOF_POINT": str(point)}, check=False)
                tried += 1
                self.look(case, folder, before, whole, f"{way} at call {point}", done.returncode)
        for k in range(0, self.options.allocations, self.options.every):
            folder = self.copy(made)
            point = 1 + k * allocations // self.options.allocations
            done = shell(folder, case.command, {**self.environment, **preload, "DYNOPROOF_ALLOCATION": str(point)}, check=False)
            tried += 1
            self.look(case, folder, before, whole, f"no memory at allocation {point}", done.returncode)
        # The largest file that it may write is a block: SIGXFSZ is a failed write, not a death.
        folder = self.copy(made)
        done = shell(folder, f"ulimit -f 1; {case.command}", self.environment, check=False)
        if done.returncode not in (0, 1, 3, 4):
            self.failures.append(f"{case.name}, with files of a block at most: ended with {done.returncode}\n{done.stderr}")
        self.look(case, folder, before, whole, "with files of a block at most", done.returncode)
        ends = [signal.SIGKILL] * self.options.kills + [signal.SIGTERM, signal.SIGINT] * (self.options.kills // 10)
        for kill, number in enumerate(ends):
            folder = self.copy(made)
            process = subprocess.Popen(["bash", "-c", case.command], cwd=folder, env=self.environment, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL, start_new_session=True)
            time.sleep(random.Random(f"{case.name} {kill}").uniform(0.0, length))
            try:
                os.killpg(process.pid, number)
            except ProcessLookupError:
                pass
            process.wait()
            self.look(case, folder, before, whole, f"{number.name} at random {kill}")
        broken = sum(one.startswith(case.name + ",") for one in self.failures)
        self.tried[case.name] = {"calls": points, "tried": tried, "kills": self.options.kills, "broken": broken}
        print(f"{case.name:26} {points:4} calls, {tried:5} points, {self.options.kills:4} kills, {broken} broken", flush=True)


def table(tried):
    rows = ["| command | calls that change files | ended or failed at one | killed at random | broken |", "|---|---|---|---|---|"]
    rows += [f"| {name} | {one['calls']} | {one['tried']} | {one['kills']} | {one['broken']} |" for name, one in tried.items()]
    return rows


def history_together(harness):
    """A history that is shown while nights come: `show` sees whole nights."""
    folder = harness.folder(Case("", "", before=["dynoproof run line.toml --json r.json", "dynoproof history add r.json --db h.sqlite"]))
    adding = subprocess.Popen(["bash", "-c", "for i in $(seq 40); do dynoproof history add r.json --db h.sqlite || exit 1; done"],
                              cwd=folder, env=harness.environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    shown = 0
    while adding.poll() is None:
        done = shell(folder, "dynoproof history show --db h.sqlite", harness.environment, check=False)
        shown += 1
        if done.returncode != 0:
            harness.failures.append(f"history show beside history add: {done.returncode} {done.stderr}")
    if adding.returncode != 0:
        harness.failures.append(f"history add beside history show: {adding.stderr.read()}")
    print(f"{'history show beside add':26} {shown:4} times", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("preload", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--kills", type=int, default=0)
    parser.add_argument("--allocations", type=int, default=40, help="evenly over all of a command's")
    parser.add_argument("--only", default="")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--write", type=pathlib.Path, help="the table in tests/README.md, from such a file; calls nothing")
    options = parser.parse_args()
    if options.write:
        sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "ci"))
        import block
        return block.write("tests/README.md", "kills", table(json.loads(options.write.read_text())))
    harness = Harness(options)
    try:
        for case in CASES:
            if harness.options.only in case.name:
                harness.run(case)
        if not harness.options.only:
            history_together(harness)
    finally:
        shutil.rmtree(harness.root, ignore_errors=True)
    if harness.options.json:
        harness.options.json.write_text(json.dumps(harness.tried, indent=1) + "\n")
    for failure in harness.failures[:40]:
        print(failure, file=sys.stderr)
    return 1 if harness.failures or not harness.tried else 0


if __name__ == "__main__":
    sys.exit(main())
