#!/usr/bin/env python3
"""Seeded faults in the physics, each in a program of its own, and the scenarios that must catch them: mutants.toml.

mutants.py list                    name, file and compiled unit of each fault, for CMakeLists.txt
mutants.py make NAME OUT           the file with the fault in it; fails unless the text to be replaced occurs exactly once
mutants.py run --program FILE --mutants FOLDER [--jobs N] [--readme check|write] [NAME ...]
    runs the sound program and each faulty one over its scenario and prints the table of README.md. Ends with 0 when the
    sound one passes everywhere and every fault fails the check that is to catch it. --readme check: and when that table
    is the one of README.md but for the values, which differ between machines; --readme write puts it there."""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent


def mutants():
    return tomllib.loads((HERE / "mutants.toml").read_text())["mutant"]


def unit(mutant):
    return mutant.get("unit", mutant["file"])


def make(name, out):
    mutant = next(one for one in mutants() if one["name"] == name)
    source = (ROOT / mutant["file"]).read_text()
    found = source.count(mutant["text"])
    if found != 1:
        sys.exit(f"tests/mutants/mutants.toml: {name}: the text occurs {found} times in {mutant['file']}, not once; it must "
                 f"follow the source:\n{mutant['text']}")
    if mutant["text"] == mutant["replacement"]:
        sys.exit(f"tests/mutants/mutants.toml: {name}: the replacement changes nothing")
    faulty = source.replace(mutant["text"], mutant["replacement"])
    target = pathlib.Path(out)
    target.parent.mkdir(parents=True, exist_ok=True)
    if not target.exists() or target.read_text() != faulty:  # an unchanged one is not compiled again
        target.write_text(faulty)


def play(program, scenario, overrides):
    """Exit code and scenario result of a run; the result is None when there is none."""
    with tempfile.TemporaryDirectory() as folder:
        command = [program, "run", scenario, "--out", folder, "--json", "-"]
        for text in overrides:
            command += ["--set", text]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=300)
    try:
        return done.returncode, json.loads(done.stdout)["scenarios"][0]
    except (json.JSONDecodeError, KeyError, IndexError):
        return done.returncode, None


def number(value):
    return "none" if value is None or not math.isfinite(value) else f"{value:.3g}"


def judge(mutant, code, result):
    """The row of the table, and what is wrong with it (empty: nothing)."""
    checks = {check["name"]: check for check in (result or {}).get("checks", [])}
    catcher = checks.get(mutant["check"])
    failing = [name for name, check in checks.items() if check["verdict"] != "pass"]
    fault = ""
    if code != 1:
        fault = f"ends with {code}, not with 1"
    elif catcher is None:
        fault = f"there is no check \"{mutant['check']}\""
    elif catcher["verdict"] != "fail":
        fault = f"\"{mutant['check']}\" does not fail, but: {', '.join(failing)}"
    value = "" if catcher is None else f"{number(catcher['value'])} ({number(catcher['limit'])})"
    scenario = " ".join([mutant["scenario"], *(f"`{text}`" for text in mutant.get("set", []))])
    return [mutant["what"], f"`{pathlib.Path(mutant['file']).name}`", scenario, mutant["check"], value,
            f"{len(failing)} of {len(checks)}"], fault


HEAD = "| fault | in | scenario | check that catches it | value (limit) | failing checks |"


def written():
    """README.md's lines, and where its table begins and ends."""
    lines = (HERE / "README.md").read_text().splitlines()
    begin = lines.index(HEAD)
    return lines, begin, next(i for i in range(begin, len(lines) + 1) if i == len(lines) or not lines[i].startswith("|"))


def write(table):
    lines, begin, end = written()
    (HERE / "README.md").write_text("\n".join(lines[:begin] + table + lines[end:]) + "\n")


def stale(table):
    """The rows that README.md has otherwise, the column of the values apart."""
    lines, begin, end = written()
    plain = lambda row: [cell for i, cell in enumerate(row.split(" | ")) if i != 4]
    there = [plain(row) for row in lines[begin:end]]
    return [f"README.md has not this row, write it by `run --readme write`: {row}" for row in table if plain(row) not in there]


def run(options):
    chosen = [one for one in mutants() if not options.names or one["name"] in options.names]
    plays = {("sound", one["scenario"], tuple(one.get("set", []))) for one in chosen}
    plays |= {(one["name"], one["scenario"], tuple(one.get("set", []))) for one in chosen}

    def program(name):
        return options.program if name == "sound" else str(pathlib.Path(options.mutants) / f"mutant_{name}")

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        jobs = {key: pool.submit(play, program(key[0]), *key[1:]) for key in sorted(plays)}
        outcomes = {key: job.result() for key, job in jobs.items()}
    faults = [f"the sound program ends with {outcomes[key][0]} in {key[1]} {' '.join(key[2])}"
              for key in sorted(plays) if key[0] == "sound" and outcomes[key][0] != 0]
    table = [HEAD, "|---|---|---|---|---|---|"]
    for one in chosen:
        row, fault = judge(one, *outcomes[(one["name"], one["scenario"], tuple(one.get("set", [])))])
        table.append("| " + " | ".join(row) + " |")
        if fault:
            faults.append(f"{one['name']} in {one['scenario']}: {fault}")
    print("\n".join(table))
    if options.readme == "write":
        write(table)
    elif options.readme == "check":
        faults += stale(table)
    if not chosen:
        faults.append("no fault was seeded: nothing is proved")
    for fault in faults:
        print(f"mutants: {fault}", file=sys.stderr)
    return 1 if faults else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    commands.add_parser("list")
    maker = commands.add_parser("make")
    maker.add_argument("name")
    maker.add_argument("out")
    runner = commands.add_parser("run")
    runner.add_argument("--program", required=True)
    runner.add_argument("--mutants", required=True)
    runner.add_argument("--jobs", type=int, default=os.cpu_count())
    runner.add_argument("--readme", choices=["check", "write"])
    runner.add_argument("names", nargs="*")
    options = parser.parse_args()
    if options.command == "list":
        print("\n".join(f"{one['name']}|{one['file']}|{unit(one)}" for one in mutants()))
        return 0
    if options.command == "make":
        make(options.name, options.out)
        return 0
    return run(options)


sys.exit(main())
