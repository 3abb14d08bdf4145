#!/usr/bin/env python3
"""Whether the limits that `dynoproof probe` states are the true ones: an effect at 1.2 times its limit must fail a check, at 0.8 times it
must pass them all. Each is a run of its own, by `run --set effect=...`, which shares nothing with the search.

  ci/limits.py build/dynoproof [ID ...]    probes these (or the list) and keeps figures in engine/probe/limits.json, as they come
  ci/limits.py --write                     the table in engine/probe/README.md, from that file; `--check`: 1 where it is another

Of each scenario up to ten limits of effects with one number are drawn, of all its checks and of those without the golden trace."""
import argparse
import json
import os
import pathlib
import random
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
    "backlash/clamped", "backlash/clamped_damped", "backlash/experiment_1", "coupling/driven_oil", "coupling/idle_kelvin_voigt",
    "coupling/idle_oil", "heavy_duty/alternative_setup_1", "heavy_duty/alternative_setup_2", "heavy_duty/soft_rotor_setup_1",
    "heavy_duty/straight_chain_setup_1", "heavy_duty/straight_chain_setup_2", "heavy_duty/straight_chain_setup_3",
    "pressure/charge_air_legacy", "pressure/charge_air_proposed", "pressure/fuel_gas_legacy", "pressure/fuel_gas_proposed",
    "r2r/soft_rotor_setup_1", "suppression/adaptive", "suppression/r2r_experiment_1", "suppression/unsuppressed",
]
MOST = 10  # of a scenario
WITHIN = 0.2


def document(program, folder, words):
    file = pathlib.Path(folder) / "said.json"
    file.unlink(missing_ok=True)
    environment = {**os.environ, "DYNOPROOF_SCENARIOS": str(ROOT / "scenarios"), "DYNOPROOF_GOLDEN": str(ROOT / "golden")}
    done = subprocess.run([program, *words, "--json", str(file)], cwd=folder, capture_output=True, text=True, env=environment)
    return (json.loads(file.read_text()) if file.exists() else None), done


def limits(program, scenario, more, folder):
    """The limits that a probe states of effects with one number, and the checks that it asked; what is seen at the least strength that it
    tries has none."""
    said, done = document(program, folder, ["probe", scenario, "--jobs", "1", "--effects", *EFFECTS, *more])
    if done.returncode != 0:
        if "no check takes part" in done.stderr:
            return [], []
        sys.exit(f"{scenario}: probe ends with {done.returncode}\n{done.stderr}")
    found = [one for one in said["limits"] if one["state"] == "seen" and not one["at_once"] and len(one["parameters"]) == 1]
    return found, said["asked"]


def at(limit, factor):
    """The number of the effect at so many times its limit."""
    (name, value), = limit["parameters"].items()
    sign = 1 if limit["direction"] != "-" else -1
    neutral = value - sign * limit["smallest"]
    return name, neutral + sign * factor * limit["smallest"]


def is_seen(program, scenario, limit, factor, asked, folder):
    """Whether a run with the effect fails a check that was asked; None where the effect takes no such number."""
    name, value = at(limit, factor)
    effect = f'effect=[{{ name = "{limit["effect"]}", at = "{limit["at"]}", parameters = {{ {name} = {value!r} }} }}]'
    said, done = document(program, folder, ["run", scenario, "--out", "out", "--set", effect])
    if done.returncode == 2:
        return None
    if said is None or len(said.get("scenarios", [])) != 1:
        sys.exit(f"{scenario} with {effect}\n{done.stderr}")
    checks = said["scenarios"][0]["checks"]
    return not checks or any(one["verdict"] != "pass" and one["name"] in asked for one in checks)


def judged(program, scenario):
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for golden, more in ((True, []), (False, ["--without", "golden"])):
            found, asked = limits(program, scenario, more, folder)
            draw = random.Random(scenario)
            for limit in draw.sample(found, min(len(found), MOST)):
                above = is_seen(program, scenario, limit, 1 + WITHIN, asked, folder)
                below = is_seen(program, scenario, limit, 1 - WITHIN, asked, folder)
                if above is None or below is None:
                    continue
                rows.append({"effect": limit["effect"], "at": limit["at"], "direction": limit["direction"], "golden": golden,
                             "smallest": limit["smallest"], "seen_above": above, "seen_below": below})
    return rows


def table(kept):
    rows = ["| scenario | limits looked at | seen at 1.2 of it, and not at 0.8 | not seen above | seen below |", "|---|---|---|---|---|"]

    def row(name, ones):
        right = sum(one["seen_above"] and not one["seen_below"] for one in ones)
        return (f"| {name} | {len(ones)} | {right} | {sum(not one['seen_above'] for one in ones)} | "
                f"{sum(one['seen_below'] for one in ones)} |")

    rows += [row(f"`{name}`", ones) for name, ones in sorted(kept.items())]
    return rows + [row(f"all {len(kept)}", [one for ones in kept.values() for one in ones])]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("scenarios", nargs="*")
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    kept = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    if arguments.write or arguments.check:
        blocks = [(PAGE, "limits", table(kept))]
        if arguments.write:
            block.write_all(blocks)
        differing = block.differing(blocks, "ci/limits.py")
        if differing:
            print(differing)
        return 1 if differing else 0
    if not arguments.program:
        parser.error("a program is wanted")
    program = str(pathlib.Path(arguments.program).resolve())
    for scenario in arguments.scenarios or [one for one in SCENARIOS if one not in kept]:
        kept[scenario] = judged(program, scenario)
        RESULTS.write_text(json.dumps(kept, indent=1) + "\n")
        print(scenario, len(kept[scenario]), sum(one["seen_above"] and not one["seen_below"] for one in kept[scenario]), flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
