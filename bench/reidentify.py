#!/usr/bin/env python3
"""Re-identifies the thesis' drive lines from synthetic chirps, and predicts what is mounted on them next.

usage: bench/reidentify.py [BUILD_FOLDER] [--method two_stage|response] [--starts N] [--out DIR] [--json FILE]

Records are the program's own, from solver `reference`, with white noise of 1 N m on T_shaft (the chirp has 1000 N m). All
that the fits know are the bounds of Tables A.2 and A.6 and the machine's inertia I1: from its air-gap torque to the shaft
torque nothing changes when all inertias, stiffnesses and dampings grow by one factor. They start from the middle of the
bounds, then anywhere within.

1. Tables A.1, A.4, A.5 and A.7, each from a chirp of its own setup 1: in two stages by (2.69) to (2.72), and in one by the
   frequency response, each followed by the free-run error.
2. All three structures from a chirp of the soft rotor's setup 1 (Table A.5); the flanges of setups 2 and 3 are then added
   to I5, and their chirps predicted.
"""
import argparse
import json
import math
import pathlib
import subprocess

root = pathlib.Path(__file__).resolve().parent.parent
parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("build", nargs="?", default=root / "build", type=pathlib.Path)
parser.add_argument("--method", action="append", choices=("two_stage", "response"), help="default: both")
parser.add_argument("--starts", type=int, default=24)
parser.add_argument("--out", type=pathlib.Path, default=root / "out" / "reidentify")
parser.add_argument("--json", type=pathlib.Path)
arguments = parser.parse_args()
out = arguments.out.resolve()
out.mkdir(parents=True, exist_ok=True)

NOISE = 1.0  # N m
CHIRP = ["input.T_airgap.source.rate_Hz_per_s=500", "run.duration_s=4"]  # to 2000 Hz, as in the thesis
INERTIA, STIFFNESS, DAMPING = (0.01, 10.0), (1e5, 1e8), (0.0, 1000.0)  # Tables A.2, A.6


def shaft(name):
    return {f"plant.shaft.{name}.stiffness_Nm_per_rad": STIFFNESS, f"plant.shaft.{name}.damping_Nms_per_rad": DAMPING}


def chain(shafts):
    keys = {f"plant.inertia.I{k}": INERTIA for k in range(2, 6)}
    for name in shafts:
        keys |= shaft(name)
    return keys


ROTOR = {"plant.rotor.I1.stiffness_Nm_per_rad": STIFFNESS, "plant.rotor.I1.damping_Nms_per_rad": DAMPING,
         "plant.inertia.I4": INERTIA, "plant.inertia.I5": INERTIA, **shaft("k3"), **shaft("k4")}


STRUCTURES = {
    "straight chain, Table A.1": ("heavy_duty/straight_chain", chain(["k1", "k2", "k3", "k4"])),
    "alternative, Table A.4": ("heavy_duty/alternative", chain(["k12", "k13", "k23", "k24", "k25"])),
    "soft rotor, Table A.5": ("heavy_duty/soft_rotor", ROTOR),
    "soft rotor, Table A.7": ("r2r/soft_rotor", ROTOR),
}
METHODS = arguments.method or ("two_stage", "response")
MOUNTED = {1: 0.0, 2: 0.13, 3: 0.37}  # kg m^2 on the heavy-duty test bed, behind I5


def call(*words):
    """The program's JSON; 1 (a limit that is not for changed runs) is as good as 0."""
    file = out / "last.json"
    file.unlink(missing_ok=True)
    done = subprocess.run([arguments.build / "dynoproof", *map(str, words), "--json", file], cwd=root,
                          capture_output=True, text=True)
    if done.returncode not in (0, 1) or not file.exists():
        raise SystemExit(f"dynoproof {' '.join(map(str, words))}\n{done.stderr}")
    return json.loads(file.read_text())


def changes(settings):
    return [word for setting in settings for word in ("--set", setting)]


def record(scenario):
    """A chirp as a logger would have written it."""
    noise = f'output.T_shaft.sensor=[{{ type = "noise", std = {NOISE}, seed = 3 }}]'
    call("run", scenario, "--solver", "reference", "--out", out, *changes([*CHIRP, noise]))
    return out / f"{scenario}.h5"


def fit(scenario, keys, data, *more):
    """`identify` within the bounds of these keys."""
    bounds = [word for key, (low, high) in keys.items() for word in ("--bound", f"{key}={low}:{high}")]
    return call("identify", scenario, "--data", data, "--map", out / "map.toml", "--free", ",".join(keys), *bounds, *more)


def middle(bounds):
    return math.sqrt(bounds[0] * bounds[1]) if bounds[0] > 0.0 else 0.03 * bounds[1]


def identify(scenario, keys, data, method):
    """In one or two stages from the bounds alone, then by the free-run error from there."""
    found = {stage: out / f"{scenario.replace('/', '_')}_{method}_{stage}.toml" for stage in ("first", "last")}
    start = changes(f"{key}={middle(bounds)}" for key, bounds in keys.items())
    first = fit(scenario, keys, data, *start, "--method", method, "--starts", arguments.starts, "--out", found["first"])
    last = fit(found["first"], keys, data, "--method", "free_run", "--starts", 1, "--out", found["last"])
    return first, last, found["last"]


def truth(scenario, keys):
    """What the scenario's file says, and the NRMSE that the noise alone makes: by a fit that has nothing to do."""
    done = fit(scenario, keys, out / f"{scenario}.h5", "--starts", 1)
    return {key: one["nominal"] for key, one in done["parameters"].items()}, done["nrmse_before"]


def farthest(found, true):
    """Largest relative error of inertias and stiffnesses, and largest error of a damping over the largest damping."""
    size = max(value for key, value in true.items() if "damping" in key)
    errors = {True: 0.0, False: 0.0}
    for key, value in true.items():
        damping = "damping" in key
        error = abs(found[key]["value"] - value) / (size if damping else value)
        errors[damping] = max(errors[damping], error)
    return errors[False], errors[True]


(out / "map.toml").write_text('time = { column = "time", unit = "s" }\n'
                              '[input.T_airgap]\ncolumn = "T_airgap"\n[output.T_shaft]\ncolumn = "T_shaft"\n')
rows, predicted, of_setup_1 = [], [], {}
for name, (family, keys) in STRUCTURES.items():
    scenario = f"{family}_setup_1"
    data = record(scenario)
    true, noise = truth(scenario, keys)
    for method in METHODS:
        first, last, found = identify(scenario, keys, data, method)
        of_setup_1[scenario, method] = last, found
        inertia, damping = farthest(last["parameters"], true)
        rows.append({"table": name, "method": method, "nrmse_first": first["nrmse_after"], "nrmse": last["nrmse_after"],
                     "nrmse_noise": noise, "starts": first["starts"],
                     "inertia_stiffness": inertia, "damping": damping, "converged": first["converged"],
                     "not_told_apart": last["not_told_apart"]})
        print(f"{name:28} {method:10} NRMSE {first['nrmse_after']:8.4f} -> {last['nrmse_after']:8.4f} (noise {noise:.4f})   "
              f"I, k within {inertia:8.2%}   c within {damping:8.2%}   "
              f"{first['converged']} of {first['starts']} starts   {len(last['not_told_apart'])} not told apart", flush=True)

print()
flanges = {setup: record(f"heavy_duty/soft_rotor_setup_{setup}") for setup in MOUNTED}
for name, (family, keys) in list(STRUCTURES.items())[:3]:
    for method in METHODS:
        scenario = f"{family}_setup_1"
        if family == "heavy_duty/soft_rotor":
            last, found = of_setup_1[scenario, method]
        else:
            _, last, found = identify(scenario, keys, flanges[1], method)
        i5 = last["parameters"]["plant.inertia.I5"]["value"]
        row = {"structure": name, "method": method, "nrmse": {}}
        for setup, inertia in MOUNTED.items():
            run = call("run", found, "--data", flanges[setup], "--map", out / "map.toml", "--out", out / "predicted",
                       "--set", f"plant.inertia.I5={i5 + inertia}")
            checks = run["scenarios"][0]["checks"]
            row["nrmse"][setup] = next(c["value"] for c in checks if c["name"] == "record T_shaft")
        predicted.append(row)
        print(f"{name:28} {method:10} T_shaft, NRMSE of setup " +
              "   ".join(f"{setup}: {value:8.4f}" for setup, value in row["nrmse"].items()), flush=True)

if arguments.json:
    arguments.json.write_text(json.dumps({"reidentified": rows, "predicted": predicted}, indent=1))
