#!/usr/bin/env python3
"""How often the proposed scheme fails on the spread of plants, and which parameter decides: the table in engine/thesis/README.md.

machine_robustness.py PROGRAM [--write]     runs the campaign machine_robustness (a quarter of an hour on a core) and prints the table; --write
puts it there. Ends with 1 where the page says otherwise."""
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "ci"))
import block  # noqa: E402

PAGE = "engine/thesis/README.md"
AXES = {"input.T_load.source.start_time_s": ("onset of the load", "s"), "plant.inertia.I5": ("inertia of the device", "kg m^2"),
        "plant.rotor.I1.stiffness_Nm_per_rad": ("stiffness of the rotor", "N m/rad"), "plant.shaft.k3.stiffness_Nm_per_rad": ("stiffness k3", "N m/rad"),
        "plant.shaft.k4.stiffness_Nm_per_rad": ("stiffness k4", "N m/rad"), "plant.rotor.I1.damping_Nms_per_rad": ("damping of the rotor", "N m s/rad"),
        "plant.shaft.k4.damping_Nms_per_rad": ("damping c4", "N m s/rad"), "output.T_shaft.sensor.0.std": ("noise", "N m")}


def rows(program):
    with tempfile.TemporaryDirectory() as folder:
        asked = subprocess.run([program, "sweep", "bench/campaigns/machine_robustness.toml", "--out", folder], cwd=ROOT, capture_output=True, text=True)
        if asked.returncode != 0:
            sys.exit(asked.stdout + asked.stderr)
        with open(pathlib.Path(folder, "machine_robustness", "table.csv"), newline="") as table:
            return list(csv.DictReader(table))


def wilson(hits, of):
    """95 % interval of a share."""
    z, p = 1.96, hits / of
    middle, half = p + z * z / (2 * of), z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    return (middle - half) / (1 + z * z / of), (middle + half) / (1 + z * z / of)


def share(runs, failed):
    hits = sum(failed(run) for run in runs)
    low, high = wilson(hits, len(runs))
    return f"{100 * hits / len(runs):.1f} % [{100 * max(low, 0.0):.1f}, {100 * high:.1f}]"


def thirds(runs, key):
    ordered = sorted(runs, key=lambda run: float(run[key]))
    n = len(ordered)
    return [ordered[i * n // 3:(i + 1) * n // 3] for i in range(3)]


def chance(groups, failed):
    """Probability that three groups alike differ by as much: chi-square with two degrees of freedom."""
    counts = [(sum(failed(run) for run in group), len(group)) for group in groups]
    p = sum(hits for hits, _ in counts) / sum(of for _, of in counts)
    if p in (0.0, 1.0):
        return 1.0
    return math.exp(-0.5 * sum((hits - p * of) ** 2 / (of * p * (1 - p)) for hits, of in counts))


def main(program, *options):
    runs = rows(program)
    fails = {"any": lambda run: run["verdict"] != "pass", "unstable": lambda run: float(run["unstable_at_end"]) > 0.0,
             "slow": lambda run: 0.0 < float(run["growth_at_end"]) < 2.0, "beyond": lambda run: float(run["beyond_filters"]) > 0.0, "false": lambda run: float(run["false_placements"]) > 0.0}
    text = [f"Of {len(runs)} runs {share(runs, fails['any'])} fail: {share(runs, fails['unstable'])} are unstable in the end "
            f"({share(runs, fails['beyond'])} whatever two filters with r = 0.995 would do; {share(runs, fails['slow'])} grow by less than 2 1/s, for which 5 s are "
            f"short), {share(runs, fails['false'])} have a filter where nothing grew.", "",
            "| parameter | lowest third | middle | highest third | by chance |", "|---|---|---|---|---|"]
    lines = []
    for key, (name, unit) in AXES.items():
        groups = thirds(runs, key)
        edges = [float(groups[1][0][key]), float(groups[2][0][key])]
        lines.append((chance(groups, fails["any"]), f"| {name}, parted at {edges[0]:.3g} and {edges[1]:.3g} {unit} | " + " | ".join(share(group, fails["any"]) for group in groups)))
    text += [f"{line} | {p:.1g} |" for p, line in sorted(lines)]
    print("\n".join(text))
    if "--write" in options:
        block.write(PAGE, "robustness", text)
    elif block.read(PAGE, "robustness") != text:
        sys.exit(f"{PAGE} says otherwise: bench/machine_robustness.py PROGRAM --write")


if len(sys.argv) < 2:
    sys.exit(__doc__)
main(*sys.argv[1:])
