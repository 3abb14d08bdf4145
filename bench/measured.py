#!/usr/bin/env python3
"""What `diagnose` makes of records that somebody measured, beside what is documented of them.

usage: bench/measured.py RECORDS [BUILD_FOLDER] [--only PART_OF_A_NAME] [--out DIR] [--json FILE] [--readme]

RECORDS is the folder of the public records, which are no part of this repository (tests/real has the scenarios and maps). Each
record is diagnosed from a model without its documented cause: with numbers of a data sheet, and with numbers that were fitted
to the record by who did not think of that cause. Prints a row a case: what was hidden from the model, the verdict, NRMSE of the
free run on the hold-out before and after, CPU seconds. --readme: writes the table into engine/diagnosis/README.md. Ends with 1
where a verdict names anything else."""
import argparse
import json
import pathlib
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
REAL = ROOT / "tests" / "real"
FRICTION = ("coulomb_friction", "stribeck_friction", "asymmetric_friction", "dahl_friction")

# name, scenario, maps of data and hold-out, data, hold-out (several one after the other), --set, causes that are documented, where; NRMSE
# on the hold-out that a fit by hand reaches [%], where it compares the same signal
CASES = [
    ("servo axis, fitted", "servo_axis", ["servo_axis_map"], "servo_axis/DATA_EMPS.mat",
     "servo_axis/DATA_EMPS_PULSES.mat", [], FRICTION, "inertia:carriage", "-"),
    ("servo axis, data sheet", "servo_axis", ["servo_axis_map"], "servo_axis/DATA_EMPS.mat",
     "servo_axis/DATA_EMPS_PULSES.mat",
     ["plant.inertia.carriage=95.1", "plant.load.friction.b_pos_Nms_per_rad=203.5",
      "plant.load.friction.b_neg_Nms_per_rad=203.5"], FRICTION, "inertia:carriage", "-"),
    ("oscillator that hardens, fitted", "silverbox", ["silverbox_multisine", "silverbox_arrow"],
     "silverbox/SNLS80mV.mat", "silverbox/SNLS80mV.mat", [], ("cubic_stiffness",), "shaft:spring", "1.04"),
    ("magnetorheological damper, fitted", "mr_damper", ["mr_damper_train", "mr_damper_holdout"],
     "mr_damper/data_simulation_4.1_MRdamper.mat", "mr_damper/data_simulation_4.1_MRdamper.mat", [], FRICTION,
     "inertia:rod", "10 to 16"),
    ("band damper with play, fitted", "friction_damper", ["friction_damper_map"], "friction_damper/sine_0.5Hz_1in.csv",
     "friction_damper/sine_1Hz_1in.csv", [], FRICTION, "inertia:rod", "28, with its gap 16"),
    ("coupled drives, data sheet", "coupled_drives", ["coupled_drives_2", "coupled_drives_1"], "coupled_drives/drive.mat",
     "coupled_drives/drive.mat", [], ("sensor_rectified",), "output:z", "38"),
    ("motor that cogs, fitted", "cogging", ["cogging_map"], "cogging_motor/train.csv", "cogging_motor/holdout.csv", [],
     ("torque_ripple",), "inertia:rotor", "-"),
    ("motor that cogs, held at standstill", "cogging_standstill", ["cogging_static_map"],
     "cogging_motor/static_train_forward.csv", "cogging_motor/static_holdout_backward.csv", [], ("torque_ripple",), "inertia:rotor",
     "36.3"),
    ("pneumatic cylinder, data sheet", "pneumatic_cylinder", [f"pneumatic_cylinder_{bar}bar" for bar in (1, 5, 3, 7)],
     "pneumatic_cylinder/train.csv pneumatic_cylinder/train.csv", "pneumatic_cylinder/holdout.csv pneumatic_cylinder/holdout.csv", [],
     FRICTION, "inertia:piston", "18.6"),
]


def diagnose(case, arguments):
    name, scenario, maps, data, holdout, sets, causes, at, by_hand = case
    out = arguments.out / name.replace(" ", "_").replace(",", "")
    command = [str(arguments.build / "dynoproof"), "diagnose", str(REAL / f"{scenario}.toml"), "--out", str(out), "--json", "-", "--html",
               str(out / "page.html")]
    for option, files in (("--data", data), ("--holdout", holdout)):
        for file in files.split():
            command += [option, str(arguments.records / file)]
    for part in maps:
        command += ["--map", str(REAL / f"{part}.toml")]
    for change in sets:
        command += ["--set", change]
    out.mkdir(parents=True, exist_ok=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run = subprocess.run(command + ["--explain"], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    row = {"name": name, "cpu_s": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
           "by_hand": by_hand, "documented": [f"{cause}@{at}" for cause in causes]}
    try:
        result = json.loads(run.stdout)
    except json.JSONDecodeError:
        return row | {"verdict": f"exit {run.returncode}", "named": [], "right": "broken", "why": run.stderr[-300:]}
    (out / "result.json").write_text(json.dumps(result, indent=1))
    if "verdict" not in result:
        return row | {"verdict": f"exit {run.returncode}", "named": [], "right": "broken", "why": run.stderr[-300:]}
    named = [f"{effect['name']}@{effect['at']}" for effect in result["effects"]]
    sets_of = [one for several in result.get("ambiguous_with") or [] for one in several]
    documented = set(row["documented"])
    if result["verdict"] in ("effect_found", "main_cause"):
        right = "right" if documented & set(named) else "wrong"
    elif result["verdict"] == "ambiguous":
        right = "in the set" if documented & set(named + sets_of) else "wrong"
    else:
        right = "abstained" if result["verdict"] == "unexplained" else "missed"
    gains = result["gain"]["holdout"].values()
    return row | {"verdict": result["verdict"], "named": sets_of or named, "right": right,
                  "before": [gain["nrmse_before"] for gain in gains], "after": [gain["nrmse_after"] for gain in gains]}


HEAD = ("| record and nominal values | verdict | names | is | hold-out, % before | after | by hand | CPU s |",
        "|---|---|---|---|---|---|---|---|")
README = ROOT / "engine" / "diagnosis" / "README.md"
BEGIN, END = "<!-- measured: written by bench/measured.py -->", "<!-- end of measured -->"


def line_of(row):
    return (f"| {row['name']} | {row['verdict']} | {', '.join(row['named']) or row.get('why', '')} | {row['right']} | "
            f"{percent(row.get('before', []))} | {percent(row.get('after', []))} | {row['by_hand']} | {row['cpu_s']:.0f} |")


def write_readme(rows):
    lines = README.read_text().splitlines()
    begin, end = lines.index(BEGIN), lines.index(END)
    README.write_text("\n".join(lines[:begin + 1] + list(HEAD) + [line_of(row) for row in rows] + lines[end:]) + "\n")


def percent(values):
    return ", ".join(f"{100 * value:.3g}" if value is not None else "-" for value in values)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("records", type=pathlib.Path)
    parser.add_argument("build", nargs="?", default=ROOT / "build", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "measured")
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--readme", action="store_true")
    arguments = parser.parse_args()
    arguments.out = arguments.out.resolve()
    rows = []
    print("\n".join(HEAD), flush=True)
    for case in CASES:
        if arguments.only not in case[0]:
            continue
        row = diagnose(case, arguments)
        rows.append(row)
        print(line_of(row), flush=True)
        if arguments.json:
            arguments.json.write_text(json.dumps(rows, indent=1))
    if arguments.readme:
        write_readme(rows)
    return 1 if any(row["right"] in ("wrong", "broken") for row in rows) or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
