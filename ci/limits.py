#!/usr/bin/env python3
"""Whether the limits that `dynoproof probe` states are the true ones, and what its proposals are worth, of scenarios as users write them:
the shipped ones with golden traces as wide as somebody would state by hand, 2 % of each nominal.

  ci/limits.py build/dynoproof [ID ...]    probes these (or the list) and keeps figures in engine/probe/limits.json, as they come
  ci/limits.py --builds NAME=PROGRAM ...   runs every scenario with its proposals by programs of other compilers and options, in each
                                           class of processors; keeps the verdicts there, and asks for those that are not kept
  ci/limits.py --write                     the table in engine/probe/README.md, from that file; `--check`: 1 where it is another

A limit is true where a run with the effect at 1.2 times it fails a check, and one at 0.8 times it passes them all; each is a run of its
own, by `run --set effect=...`, which shares nothing with the search. Up to ten are drawn, of effects with one number. Then the tubes
that the probe proposes replace those of 2 %, and what passed although it was usual is probed once more."""
import argparse
import json
import os
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

import block

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "engine/probe/limits.json"
PAGE = "engine/probe/README.md"
EFFECTS = ["stiffness_change", "inertia_change", "damping_change", "sensor_gain", "sensor_offset", "actuator_gain", "actuator_lag",
           "coulomb_friction", "viscous_friction", "constant_load", "flow_area_error"]
SCENARIOS = [
    "backlash/clamped", "backlash/clamped_damped", "coupling/driven_oil", "coupling/idle_kelvin_voigt", "coupling/idle_oil",
    "coupling/startup_oil", "heavy_duty/alternative_setup_1", "heavy_duty/alternative_setup_2", "heavy_duty/soft_rotor_setup_1",
    "heavy_duty/straight_chain_setup_1", "heavy_duty/straight_chain_setup_2", "heavy_duty/straight_chain_setup_3",
    "pressure/charge_air_legacy", "pressure/charge_air_proposed", "pressure/fuel_gas_legacy", "pressure/fuel_gas_proposed",
    "r2r/soft_rotor_setup_1", "suppression/adaptive", "suppression/r2r_experiment_1", "suppression/unsuppressed",
]
MOST = 10  # of a scenario
WITHIN = 0.2
WIDTH = 0.02  # of a nominal: what users state who have not looked at what builds differ by
CLASSES = ["x86-64", "x86-64-avx2-fma", "x86-64-avx512"]


class Golden:
    """A copy of the golden data whose tolerances may be changed."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder) / "golden"
        shutil.copytree(ROOT / "golden", self.folder)

    def state(self, scenario, widths):
        """Every output within WIDTH of its nominal, but those with a width of their own."""
        file = self.folder / f"{scenario}.toml"
        text = (ROOT / "golden" / f"{scenario}.toml").read_text()
        text = re.sub(r"(?m)^(relative_width|other_solver_width) = .*$", rf"\1 = {WIDTH!r}", text)
        for output, width in widths.items():
            lines = f"[signal.{output}]\nrelative_width = {width!r}"
            text, times = re.subn(rf"(?m)^\[signal\.{re.escape(output)}\]\nrelative_width = .*$", lines, text)
            if times == 0:
                text += f'\n{lines}\norigin = "proposed"\n'
        file.write_text(text)


def document(program, golden, words, cpu_class=None):
    file = golden.folder.parent / "said.json"
    file.unlink(missing_ok=True)
    environment = {**os.environ, "DYNOPROOF_SCENARIOS": str(ROOT / "scenarios"), "DYNOPROOF_GOLDEN": str(golden.folder)}
    if cpu_class:
        environment["DYNOPROOF_CPU_CLASS"] = cpu_class
    done = subprocess.run([program, *words, "--json", str(file)], cwd=file.parent, capture_output=True, text=True, env=environment)
    return (json.loads(file.read_text()) if file.exists() else None), done


def probed(program, golden, scenario, effects):
    said, done = document(program, golden, ["probe", scenario, "--jobs", "1", "--effects", *effects])
    if done.returncode != 0:
        sys.exit(f"{scenario}: probe ends with {done.returncode}\n{done.stderr}")
    return said


def at(limit, factor):
    """The number of the effect at so many times its limit."""
    (name, value), = limit["parameters"].items()
    sign = 1 if limit["direction"] != "-" else -1
    neutral = value - sign * limit["smallest"]
    return name, neutral + sign * factor * limit["smallest"]


def is_seen(program, golden, scenario, limit, factor, asked):
    """Whether a run with the effect fails a check that was asked; None where the effect takes no such number."""
    name, value = at(limit, factor)
    effect = f'effect=[{{ name = "{limit["effect"]}", at = "{limit["at"]}", parameters = {{ {name} = {value!r} }} }}]'
    said, done = document(program, golden, ["run", scenario, "--out", "out", "--set", effect])
    if done.returncode == 2:
        return None
    if said is None or len(said.get("scenarios", [])) != 1:
        sys.exit(f"{scenario} with {effect}\n{done.stderr}")
    checks = said["scenarios"][0]["checks"]
    return not checks or any(one["verdict"] != "pass" and one["name"] in asked for one in checks)


def looked_at(program, golden, scenario, said):
    """Limits that were drawn, and what runs to either side of each say. What is seen at the least strength that a probe tries has none."""
    found = [one for one in said["limits"] if one["state"] == "seen" and not one["at_once"] and len(one["parameters"]) == 1]
    rows = []
    for limit in random.Random(scenario).sample(found, min(len(found), MOST)):
        above = is_seen(program, golden, scenario, limit, 1 + WITHIN, said["asked"])
        below = is_seen(program, golden, scenario, limit, 1 - WITHIN, said["asked"])
        if above is not None and below is not None:
            rows.append({key: limit[key] for key in ("effect", "at", "direction", "smallest")} | {"seen_above": above, "seen_below": below})
    return rows


def smallest(limit):
    """From which strength it is seen; beyond all that was tried where it never is."""
    return limit["smallest"] if limit["smallest"] is not None else limit["tried"]


def judged(program, scenario):
    with tempfile.TemporaryDirectory() as folder:
        golden = Golden(folder)
        golden.state(scenario, {})
        before = probed(program, golden, scenario, EFFECTS)
        rows = looked_at(program, golden, scenario, before)
        holes = [one for one in before["limits"] if one["hole"]]
        widths = {one["output"]: one["relative_width"] for one in before["proposals"]}
        after = {}
        if widths:
            golden.state(scenario, widths)
            said = probed(program, golden, scenario, sorted({one["effect"] for one in holes}))
            after = {(one["effect"], one["at"], one["direction"]): one for one in said["limits"]}

        def share(one):
            """What passes with the proposals over what passed before: 1 where it is still not seen."""
            now = after.get((one["effect"], one["at"], one["direction"]), one)
            return 1.0 if now["smallest"] is None else min(1.0, now["smallest"] / smallest(one))

        return {"limits": rows, "proposals": widths, "builds": {},
                "holes": [{key: one[key] for key in ("effect", "at", "direction", "usual")} | {"passes": share(one)} for one in holes]}


def run_by(name, program, scenario, kept):
    """Whether the scenario passes with its proposals, by a program, in each class of processors."""
    with tempfile.TemporaryDirectory() as folder:
        golden = Golden(folder)
        golden.state(scenario, kept["proposals"])
        for cpu_class in CLASSES:
            if f"{name} {cpu_class}" in kept["builds"]:
                continue
            said, done = document(program, golden, ["run", scenario, "--out", "out"], cpu_class)
            if said is None:
                sys.exit(f"{scenario} by {name}\n{done.stderr}")
            kept["builds"][f"{name} {cpu_class}"] = done.returncode == 0


def table(kept):
    rows = ["| scenario | limits looked at | seen at 1.2 of it, and not at 0.8 | not seen above | seen below | usual errors that pass | "
            "halved by the proposals | what passes then, median | builds that pass with them |",
            "|---|---|---|---|---|---|---|---|---|"]

    def row(name, ones):
        limits = [limit for one in ones for limit in one["limits"]]
        shares = [hole["passes"] for one in ones for hole in one["holes"]]
        builds = [passes for one in ones for passes in one["builds"].values()]
        right = sum(limit["seen_above"] and not limit["seen_below"] for limit in limits)
        return (f"| {name} | {len(limits)} | {right} | {sum(not limit['seen_above'] for limit in limits)} | "
                f"{sum(limit['seen_below'] for limit in limits)} | {len(shares)} | {sum(share <= 0.5 for share in shares)} | "
                f"{f'{statistics.median(shares):.2g}' if shares else ''} | {sum(builds)} of {len(builds)} |")

    rows += [row(f"`{name}`", [one]) for name, one in sorted(kept.items())]
    return rows + [row(f"all {len(kept)}", list(kept.values()))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("scenarios", nargs="*")
    parser.add_argument("--builds", nargs="+", default=[])
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    kept = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}

    def keep():
        RESULTS.write_text(json.dumps(dict(sorted(kept.items())), indent=1) + "\n")

    if arguments.write or arguments.check:
        blocks = [(PAGE, "limits", table(kept))]
        if arguments.write:
            block.write_all(blocks)
        differing = block.differing(blocks, "ci/limits.py")
        if differing:
            print(differing)
        return 1 if differing else 0
    for name, program in (one.split("=", 1) for one in arguments.builds):
        for scenario in kept:
            run_by(name, str(pathlib.Path(program).resolve()), scenario, kept[scenario])
            keep()
            print(name, scenario, kept[scenario]["builds"], flush=True)
    if arguments.builds:
        return 0
    if not arguments.program:
        parser.error("a program is wanted")
    program = str(pathlib.Path(arguments.program).resolve())
    for scenario in arguments.scenarios or [one for one in SCENARIOS if one not in kept]:
        kept[scenario] = judged(program, scenario)
        keep()
        print(scenario, *table({scenario: kept[scenario]})[2:3], flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
