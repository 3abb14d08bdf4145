#!/usr/bin/env python3
"""Does `dynoproof bisect` find a planted change, and say what it did? Histories of 64 commits, made anew in a folder that goes again:
of a drive line, of one with a speed controller, play and golden data, and of programs with a seeded fault (tests/mutants). One commit
changes the run; the others change notes, comments, titles and the way in which numbers are written.

  ci/bisections.py build/dynoproof --mutants build/tests/mutants    all of them; figures to engine/history/bisections.json, as they come
  ci/bisections.py build/dynoproof ... NAME ...                     these alone
  ci/bisections.py --write                     the tables in engine/history/README.md and README.md; `--check`: 1 where they are others

Ends with 1 where a commit is another one than the one that was planted, or takes more than seven looks."""
import argparse
import json
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

import block

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "engine/history/bisections.json"
PAGE = "engine/history/README.md"
COMMITS = 64
LOOKS = 7
GIT = ["git", "-c", "user.name=test", "-c", "user.email=test@example.org", "-c", "commit.gpgsign=false"]

# Lines that stand in every history: a short chirp on the line that `new scenario` writes, and the same as its users go on with it.
LOOP = """
[plant.load.bearing]
on = "I3"
law = "viscous"
b_Nms_per_rad = 0.4

[control.speed]
type = "speed_pi"
k_P_Nms_per_rad = 40.0
k_I_Nm_per_rad = 300.0
limit_Nm = 150.0
inputs = { speed = "output.omega_1" }

[input.omega_ref]
to = "control.speed.reference"
unit = "rad/s"
source = { type = "step", value = 2.0, time_s = 0.01 }

[input.T_airgap]
to = "plant.T_airgap"
unit = "N m"
nominal = 100.0
from = "control.speed.torque"
actuator = [{ type = "first_order_lag", tau_s = 0.001 }]

[output.T_shaft]
of = "plant.k2.torque"
unit = "N m"
nominal = 100.0

[output.omega_1]
of = "plant.I1.speed"
unit = "rad/s"
nominal = 1.0
sensor = [{ type = "delay", delay_s = 0.0003 }]

[[check]]
kind = "bounded"
signal = "omega_1"
between = [-0.5, 3.5]
origin = "the test bed's limits"

[[check]]
kind = "golden"
"""


def chirp_of(program, folder):
    """The whole chirp, which passes the resonances: what a program did to these is in no shorter run."""
    subprocess.run([program, "new", "scenario", "line"], cwd=folder, check=True, capture_output=True)
    file = folder / "line.toml"
    file.write_text(re.sub(r"\[\[check\]\][^#]*", "", file.read_text()))


def rewrite(file, change):
    file.write_text(change(file.read_text()))


def line_of(program, folder):
    chirp_of(program, folder)
    rewrite(folder / "line.toml", lambda text: text.replace("duration_s = 2.0", "duration_s = 0.1"))


def rotor_of(program, folder):
    """The line with a soft rotor for its first body."""
    chirp_of(program, folder)
    file = folder / "line.toml"
    text = re.sub(r"^I1 = .*\n", "", file.read_text(), flags=re.M).replace("plant.I1.speed", "plant.I1.left.speed")
    text = text.replace('on = "I1"', 'on = "I1"\nslices = [3, 6]')
    file.write_text(text + "\n[plant.rotor.I1]\ninertia_kg_m2 = 2.0\nstiffness_Nm_per_rad = 1.0e6\ndamping_Nms_per_rad = 4.0\nslices = 8\n")


def loop_of(program, folder):
    line_of(program, folder)
    rewrite(folder / "line.toml", lambda text: text.split("[input.T_airgap]")[0] + LOOP)
    subprocess.run([program, "bless", "line.toml", "--reason", "first"], cwd=folder, check=True, capture_output=True)
    rewrite(folder / "line.golden.toml", lambda text: text.replace("relative_width = 1e-07", "relative_width = 0.005"))


def wide_of(program, folder):
    """The line on the adaptive solver, whose equation of motion is code of its own."""
    chirp_of(program, folder)
    rewrite(folder / "line.toml", lambda text: text.replace("duration_s = 2.0", 'duration_s = 2.0\nsolver = "reference"'))


LINE, IN_LOOP, IN_GOLDEN = (line_of, "line.toml"), (loop_of, "line.toml"), (loop_of, "line.golden.toml")
EFFECT = '\n[[effect]]\nname = "{}"\nat = "{}"\nparameters = {{ {} }}\n'


def edit(name, where, pattern, text, *says):
    return {"name": name, "base": where[0], "file": where[1], "edits": [(pattern, text)], "says": says}


def faulty(name, base, mutant, *says):
    return {"name": name, "base": base, "mutant": mutant, "says": says}


# What is planted, and what the sentence has to say of it.
PLANTED = [
    edit("inertia_load", LINE, r"^I3 = 0\.5 ", "I3 = 0.51 ", "plant.inertia.I3 = 0.51 (was 0.5)"),
    edit("inertia_machine", LINE, r"^I1 = 2\.0", "I1 = 2.02", "plant.inertia.I1 = 2.02 (was 2.0)"),
    edit("inertia_coupling", LINE, r"^I2 = 0\.3 ", "I2 = 0.303 ", "plant.inertia.I2 = 0.303 (was 0.3)"),
    edit("stiffness_1", LINE, r"4\.0e5", "4.1e5", "plant.shaft.k1.stiffness_Nm_per_rad = 410000.0 (was 400000.0)"),
    edit("stiffness_2", LINE, r"\b2\.5e5|\b250000\.0", "2.45e5", "plant.shaft.k2.stiffness_Nm_per_rad = 245000.0 (was 250000.0)"),
    edit("damping_1", LINE, r"damping_Nms_per_rad = 8\.0", "damping_Nms_per_rad = 8.8", "plant.shaft.k1.damping_Nms_per_rad = 8.8 (was 8.0)"),
    edit("damping_2", LINE, r"damping_Nms_per_rad = 6\.0", "damping_Nms_per_rad = 5.0", "plant.shaft.k2.damping_Nms_per_rad = 5.0 (was 6.0)"),
    edit("amplitude", LINE, r"amplitude = 100\.0", "amplitude = 101.0", "input.T_airgap.source.amplitude = 101.0 (was 100.0)"),
    edit("chirp_rate", LINE, r"rate_Hz_per_s = 200\.0", "rate_Hz_per_s = 202.0", "source.rate_Hz_per_s = 202.0 (was 200.0)"),
    edit("friction", LINE, r"\Z", EFFECT.format("coulomb_friction", "inertia:I2", "T_c = 0.5"), "plant.load", "coulomb"),
    edit("driven_body", LINE, r'^on = "I1"', 'on = "I2"', 'plant.torque.T_airgap.on = "I2" (was "I1")'),
    edit("seen_body", LINE, r'^of = "plant.I1.speed"', 'of = "plant.I2.speed"', 'output.omega_1.of = "plant.I2.speed"'),
    edit("period", LINE, r"period_s = 1e-4", "period_s = 2e-4", "run.period_s = 0.0002 (was 0.0001)"),
    edit("duration", LINE, r"duration_s = 0\.1", "duration_s = 0.09", "run.duration_s = 0.09 (was 0.1)"),
    edit("input_shape", LINE, r"source = \{ type = .*", 'source = { type = "step", value = 100.0, time_s = 0.02 }',
         'input.T_airgap.source.type = "step" (was "chirp")'),
    edit("sensor_gain", LINE, r'^of = "plant.k2.torque"', 'of = "plant.k2.torque"\nsensor = [{ type = "gain", gain = 1.01 }]',
         "output.T_shaft.sensor", "gain"),
    edit("gain_P", IN_LOOP, r"k_P_Nms_per_rad = 40\.0", "k_P_Nms_per_rad = 44.0", "control.speed.k_P_Nms_per_rad = 44.0 (was 40.0)"),
    edit("gain_I", IN_LOOP, r"k_I_Nm_per_rad = 300\.0", "k_I_Nm_per_rad = 330.0", "control.speed.k_I_Nm_per_rad = 330.0 (was 300.0)"),
    edit("torque_limit", IN_LOOP, r"limit_Nm = 150\.0", "limit_Nm = 75.0", "control.speed.limit_Nm = 75.0 (was 150.0)"),
    edit("delay", IN_LOOP, r"delay_s = 0\.0003", "delay_s = 0.0006", "output.omega_1.sensor.0.delay_s = 0.0006 (was 0.0003)"),
    edit("lag", IN_LOOP, r"tau_s = 0\.001", "tau_s = 0.002", "input.T_airgap.actuator.0.tau_s = 0.002 (was 0.001)"),
    edit("reference_step", IN_LOOP, r"value = 2\.0", "value = 2.1", "input.omega_ref.source.value = 2.1 (was 2.0)"),
    {"name": "title_as_well", "base": loop_of, "file": "line.toml", "says": ["plant.load.bearing.b_Nms_per_rad = 0.8 (was 0.4)"],
     "edits": [(r'^title = .*', 'title = "the line with its new bearing"'), (r"b_Nms_per_rad = 0\.4", "b_Nms_per_rad = 0.8"),
               (r'origin = "the test bed.s limits"', 'origin = "what the test bed allows"')]},
    edit("limit", IN_LOOP, r"between = \[-0\.5, 3\.5\]", "between = [-0.5, 1.5]", "check.0.between = [-0.5, 1.5] (was [-0.5, 3.5])"),
    edit("golden_name", IN_GOLDEN, r"^\[signal\.T_shaft\]", "[signal.T_shat]", "golden", "line.golden.toml: signal.T_sha"),
    {"name": "golden_of_another_run", "base": loop_of, "bless": (r"^I3 = 0\.5 ", "I3 = 0.6 "),
     "says": ["golden", "fail (was pass)", "line.golden"]},
    faulty("program_stiffness", chirp_of, "stiffness", "stiffness_change"),
    # The record has the command as it came, a sample late; the rest follows from that.
    faulty("program_command_late", line_of, "command_late", "T_airgap: late by 0.1 ms"),
    faulty("program_shaft_damping", wide_of, "shaft_damping", "damping_change"),
    faulty("program_rotor_slices", rotor_of, "rotor_slices", "stiffness_change at rotor:I1"),
]


def git(folder, *words):
    return subprocess.run([*GIT, *words], cwd=folder, check=True, capture_output=True, text=True).stdout.strip()


def history(folder, change, decoy, at, commits=COMMITS):
    """`commits` commits after a first one: the `at`-th is `change`, the others are `decoy`s; all by one call of git. Their hashes."""
    branch = f"h{at}-{random.random()}"
    stream = b""
    for k in range(commits + 1):
        (folder / "notes.txt").write_text(f"{k}\n")
        if k == at:
            change()
        elif k > 0:
            decoy(k)
        stream += (f"commit refs/heads/{branch}\nmark :{k + 1}\ncommitter test <test@example.org> {1700000000 + k} +0000\n"
                   f"data <<end\nCommit {k}\nend\n").encode()
        if k > 0:
            stream += f"from :{k}\n".encode()
        for file in folder.iterdir():
            if file.is_file() and file.name not in ("b.json", "count"):
                content = file.read_bytes()
                mode = "100755" if os.access(file, os.X_OK) else "100644"
                stream += f"M {mode} inline {file.name}\ndata {len(content)}\n".encode() + content + b"\n"
    subprocess.run([*GIT, "fast-import", "--quiet"], input=stream, cwd=folder, check=True)
    git(folder, "checkout", "-q", "-f", branch)
    return git(folder, "rev-list", "--reverse", branch).split()


def apply(file, edits):
    text = file.read_text()
    for pattern, new in edits:
        text, times = re.subn(pattern, new, text, count=1, flags=re.M)
        assert times == 1, f"{pattern} stands nowhere in {file.name}"
    file.write_text(text)


def decoys(folder, draw):
    """What changes no run: comments, words, the way in which a number is written."""
    def one(k):
        file = folder / "line.toml"
        text = file.read_text()
        kind = draw.randrange(4)
        if kind == 0:
            text += f"# note {k}\n"
        elif kind == 1:
            text = re.sub(r'^source = "[^"]*"', f'source = "measured on day {k}"', text, count=1, flags=re.M)
        elif kind == 2:
            text = re.sub(r"\b2\.5e5\b|\b250000\.0\b", lambda m: "250000.0" if "e" in m[0] else "2.5e5", text)
        file.write_text(text)
    return one


def plant(one, program, folder, mutants):
    """The change of the planted commit, and what `bisect` needs to be told besides."""
    if "mutant" in one:
        runner = folder / "program"

        def write(of):
            runner.write_text(f'#!/bin/sh\nexec {of} "$@"\n')
            runner.chmod(0o755)

        write(program)
        return lambda: write(mutants / f"mutant_{one['mutant']}"), ["--build", "cp program built", "--program", "./built"]
    if "bless" in one:
        def bless():
            file = folder / "line.toml"
            text = file.read_text()
            apply(file, [one["bless"]])
            subprocess.run([program, "bless", "line.toml", "--reason", "by mistake"], cwd=folder, check=True, capture_output=True)
            file.write_text(text)
        return bless, []
    return lambda: apply(folder / one["file"], one["edits"]), []


def tried(one, program, mutants=None, commits=COMMITS):
    """A history with the planted change, and what `bisect` said of it."""
    draw = random.Random(one["name"])
    with tempfile.TemporaryDirectory(prefix="bisect-") as name:
        folder = pathlib.Path(name)
        git(folder, "init", "-q")
        one["base"](program, folder)
        shutil.rmtree(folder / "out", ignore_errors=True)
        (folder / ".gitignore").write_text("out/\nbuilt\n")
        at = draw.randrange(1, commits + 1)
        change, words = plant(one, program, folder, mutants)
        hashes = history(folder, change, decoys(folder, draw), at, commits)
        done = subprocess.run([program, "bisect", "line.toml", "--good", hashes[0], "--json", "b.json", *words], cwd=folder,
                              capture_output=True, text=True)
        if done.returncode != 0:
            return {"at": at, "fault": (done.stdout + done.stderr).strip()}
        found = json.loads((folder / "b.json").read_text())
    return {"at": at, "found": found["first"]["commit"] == hashes[at], "looks": found["looks"], "builds": found["builds"],
            "sentence": found["sentence"], "right": all(part in found["sentence"] for part in one["says"])}


def summary(kept):
    every = [kept[one["name"]] for one in PLANTED if one["name"] in kept]
    looks = [one["looks"] for one in every if "looks" in one]
    return [f"- Of {len(every)} changes planted in histories of {COMMITS} commits `bisect` finds the commit of "
            f"{sum(one.get('found', False) for one in every)}, in {max(looks)} looks at most; the sentence says what was changed of "
            f"{sum(one.get('right', False) for one in every)}."]


def table(kept):
    rows = [*summary(kept), "", "| planted | commit | found | looks | what it says | right |", "|---|---|---|---|---|---|"]
    for one in PLANTED:
        said = kept.get(one["name"])
        if said is None:
            continue
        word = lambda key: "yes" if said.get(key) else "no"
        rows.append(f"| {one['name']} | {said['at']} of {COMMITS} | {word('found')} | {said.get('looks', '')} | "
                    f"{said.get('sentence', said.get('fault', '')).splitlines()[0].replace('|', '&#124;')} | {word('right')} |")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--mutants", type=pathlib.Path)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_intermixed_args()
    kept = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    if options.write or options.check:
        blocks = [(PAGE, "bisections", table(kept)), ("README.md", "bisected", summary(kept))]
        return block.write_all(blocks) if options.write else block.differing(blocks, "ci/bisections.py")
    if not options.program:
        parser.error("a program is needed")
    for variable in ("CI", "DYNOPROOF_SCENARIOS", "DYNOPROOF_GOLDEN"):  # a person's machine: in a pipeline nothing is blessed
        os.environ.pop(variable, None)
    program, bad = str(pathlib.Path(options.program).resolve()), False
    for one in PLANTED:
        if one["name"] not in (options.names or [one["name"]]) or ("mutant" in one and options.mutants is None):
            continue
        kept[one["name"]] = said = tried(one, program, options.mutants.resolve() if options.mutants else None)
        print(one["name"], said, flush=True)
        bad = bad or not said.get("found") or said["looks"] > LOOKS
        RESULTS.write_text(json.dumps(kept, indent=1) + "\n")
    return 1 if bad else None


if __name__ == "__main__":
    sys.exit(main())
