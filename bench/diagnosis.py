#!/usr/bin/env python3
"""The diagnosis on a fixed set of blind cases, and two results of it side by side, case by case.

  bench/diagnosis.py run build out.json [--jobs 2] [--share 0.1]   diagnoses the set; goes on where it was interrupted
  bench/diagnosis.py run build out.json --inexact                  the same in worlds that no model matches
  bench/diagnosis.py run build out.json --quiet                    each effect in a record without noise, as of a newcomer's run
  bench/diagnosis.py run build out.json --fresh                    600 effects and 600 with nothing hidden that nobody tuned anything by
  bench/diagnosis.py compare before.json after.json                who changed, whether it can be chance, CPU seconds

Two programs are told apart by the same cases, not by figures over other draws: of 300 cases some 10 change by a good step,
which is far below the scatter of a rate over 300 draws and far above chance when all ten become right.
"""
import argparse
import concurrent.futures
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import zlib

ALL = ["backlash", "charge_air", "coupling", "fuel_gas", "heavy_duty_lumped", "heavy_duty_soft", "r2r_soft"]
INDEPENDENT = ["charge_air", "fuel_gas", "heavy_duty_lumped"]
# kind, generator, scenarios, how many count, first seed. Half of the effects come from generators that share no code with
# the engine; what lies outside the list exists for the lumped line alone.
SET = [
    ("effect", "reference", ALL, 75, 2801),
    ("effect", "independent", INDEPENDENT, 75, 2802),
    ("null", "reference", ALL, 50, 2803),
    ("decoy", "reference", ALL, 25, 2804),
    ("decoy", "independent", INDEPENDENT, 25, 2805),
    ("unknown", "independent", ["heavy_duty_lumped"], 30, 2806),
    ("pair", "reference", ALL, 30, 2807),
]
# Draws for a figure that one can trust: whoever mends a case of these takes other seeds for the next figure.
FRESH = [
    ("effect", "reference", ALL, 300, 3701),
    ("effect", "independent", INDEPENDENT, 300, 3702),
    ("null", "reference", ALL, 300, 3703),
    ("decoy", "reference", ALL, 150, 3704),
    ("decoy", "independent", INDEPENDENT, 150, 3705),
]
INEXACT = [("effect", "inexact", ALL, 200, 3401), ("null", "inexact", ALL, 100, 3401)]
QUIET_SEED = 350_100_000
DURATION_S = 1
MOST_CPU_S = 300  # the goal for the longest case; what takes longer is stopped and counts as that


def key(case):
    return f"{case['kind']} {case['seed']} {case['number']}"


def quiet(build):
    """Each effect that the program knows, by a seed of its own, which stays when others come."""
    listed = subprocess.run([f"{build}/dynoproof", "list", "--json", "-"], capture_output=True, text=True, check=True)
    return [("effect", f"quiet {one['name']}", ALL, 1, QUIET_SEED + zlib.crc32(one["name"].encode()) % 100_000)
            for one in json.loads(listed.stdout)["effects"]]


def world(generator):
    """The options of blind_suite that make it."""
    if generator == "inexact":
        return ["--inexact"]
    if generator.startswith("quiet "):
        return ["--generator", "reference", "--noise", "0", "--effect", generator.removeprefix("quiet ")]
    return ["--generator", generator]


def diagnose(build, kind, generator, scenarios, seed, number, folder):
    """One case as blind_suite tells it; None where the draw does not count."""
    out = pathlib.Path(folder) / f"{kind}_{seed}_{number}"
    command = [f"{build}/tests/blind_suite", f"{build}/dynoproof", "--kind", kind, *world(generator), "--seed", str(seed), "--number", str(number),
               "--cases", "1", "--duration", str(DURATION_S), "--most-cpu", str(MOST_CPU_S), "--out", str(out), "--json", f"{out}.json"]
    for name in scenarios:
        command += ["--scenario", f"diagnose/{name}"]
    done = subprocess.run(command, capture_output=True, text=True)
    try:
        cases = json.loads(pathlib.Path(f"{out}.json").read_text())
    except (OSError, ValueError):
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return cases[0] | {"seed": seed} if cases else None


def run(build, file, jobs, share, specs):
    results = json.loads(file.read_text()) if file.exists() else {"cases": [], "not_counted": []}
    known = {key(case): case for case in results["cases"]}
    passed_over = set(results["not_counted"])
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(jobs) as pool:

        def save():
            results["cases"] = [known[k] for k in sorted(known, key=lambda k: (k.split()[1], int(k.split()[2])))]
            results["not_counted"] = sorted(passed_over)
            text = json.dumps(results, indent=0, separators=(",", ":"))
            with tempfile.NamedTemporaryFile("w", dir=file.parent, delete=False) as new:
                new.write(text + "\n")
            os.replace(new.name, file)

        # Round about by parts, so that an interrupted run is a smaller set and not a lopsided one.
        parts = [{"spec": spec, "next": 0, "left": math.ceil(share * spec[3])} for spec in specs]
        running = {}
        while True:
            for part in sorted(parts, key=lambda p: -p["left"] / p["spec"][3]):
                kind, generator, scenarios, _, seed = part["spec"]
                while part["left"] > 0 and len(running) < jobs:
                    k = f"{kind} {seed} {part['next']}"
                    number, part["next"] = part["next"], part["next"] + 1
                    if k in passed_over:
                        continue
                    part["left"] -= 1
                    if k not in known:
                        running[pool.submit(diagnose, build, kind, generator, scenarios, seed, number, folder)] = (k, part)
                        break
            if not running:
                if all(part["left"] == 0 for part in parts):
                    return save()
                continue
            for future in concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED).done:
                k, part = running.pop(future)
                case = future.result()
                if case is None:
                    passed_over.add(k)
                    part["left"] += 1
                else:
                    known[k] = case
                    left = sum(p["left"] for p in parts) + len(running)
                    print(f"{k:<22} {case['scenario']:<28} {case['outcome']:<12} {case['cpu_s']:6.1f} s CPU, {left} to go", flush=True)
                save()


def chance(worse, better):
    """McNemar's exact test: how often as uneven a split of the cases that changed comes by chance."""
    n, k = worse + better, min(worse, better)
    return min(1.0, 2.0 * sum(math.comb(n, i) for i in range(k + 1)) / 2.0**n) if n else 1.0


def interval(hits, of):
    """Wilson's 95 % interval of a share, in percent."""
    if of == 0:
        return 0.0, 100.0
    z, p = 1.959964, hits / of
    centre, half = p + z * z / (2 * of), z * math.sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    return 100 * (centre - half) / (1 + z * z / of), 100 * (centre + half) / (1 + z * z / of)


def is_good(case):
    """What a user wants: the cause alone or in the set, nothing where there is nothing, no name for what is not in the list."""
    return case["outcome"] in (("abstained",) if case["kind"] == "unknown" else ("right", "in the set"))


def alike(a, b):
    """Whether two draws are the same one: sizes may differ by a last bit, where a program sums in another order."""
    if isinstance(a, float) and isinstance(b, float):
        return math.isclose(a, b, rel_tol=1e-9)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(alike, a, b))
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(alike(a[k], b[k]) for k in a)
    return a == b


def compare(before, after):
    a, b = ({key(case): case for case in json.loads(file.read_text())["cases"]} for file in (before, after))
    both = [k for k in a if k in b]
    if not both:
        sys.exit("the two have no case in common: nothing was compared")
    drawn = [k for k in both if any(not alike(a[k][field], b[k][field]) for field in ("scenario", "causes", "noise"))]
    if drawn:
        sys.exit(f"{len(drawn)} cases were drawn differently, {drawn[0]} first: they are other cases")
    changed = [k for k in both if (a[k]["outcome"], a[k]["found"]) != (b[k]["outcome"], b[k]["found"])]
    for k in sorted(changed, key=lambda k: (is_good(b[k]) - is_good(a[k]), k)):
        truth = " + ".join(f"{c['effect']}@{c['at']}" for c in a[k]["causes"]) or a[k]["unknown"] or "nothing"
        print(f"{k:<20} {a[k]['scenario'].removeprefix('diagnose/'):<18} {truth:<44} {a[k]['outcome']} {a[k]['found']}-> "
              f"{b[k]['outcome']} {b[k]['found']}")
    print(f"\n{'':<10}{'cases':>6}{'good before':>31}{'good after':>31}{'worse':>7}{'better':>7}{'chance':>8}"
          f"{'CPU s: mean':>16}{'median':>14}{'longest':>14}")
    for kind in ["effect", "pair", "unknown", "null", "decoy", "all"]:
        chosen = [k for k in both if kind in (a[k]["kind"], "all")]
        if not chosen:
            continue
        good = [sum(is_good(of[k]) for k in chosen) for of in (a, b)]
        worse = sum(is_good(a[k]) and not is_good(b[k]) for k in chosen)
        better = sum(is_good(b[k]) and not is_good(a[k]) for k in chosen)
        shares = ["{} = {:.1f} % ({:.1f} ... {:.1f})".format(n, 100 * n / len(chosen), *interval(n, len(chosen))) for n in good]
        cpu = [sorted(of[k]["cpu_s"] for k in chosen) for of in (a, b)]
        times = ["{:.1f} {:.1f}".format(*(f(c) for c in cpu)) for f in (statistics.mean, statistics.median, max)]
        print(f"{kind:<10}{len(chosen):>6}{shares[0]:>31}{shares[1]:>31}{worse:>7}{better:>7}{chance(worse, better):>8.3f}"
              f"{times[0]:>16}{times[1]:>14}{times[2]:>14}")
    for what in ("wrong", "false alarm", "broken", "stopped"):
        print(f"{what:<12} {sum(a[k]['outcome'] == what for k in both):>4} {sum(b[k]['outcome'] == what for k in both):>4}")
    inside = [(sum(of[k]["inside"] for k in both), sum(of[k]["of"] for k in both)) for of in (a, b)]
    print("parameters inside their 95 % intervals: " + ", ".join(f"{hits} of {of}" for hits, of in inside))
    left_out = len(set(a) ^ set(b))
    if left_out:
        print(f"{left_out} cases are in one of the two only and were not compared")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("run")
    one.add_argument("build", help="build folder with dynoproof and tests/blind_suite")
    one.add_argument("file", type=pathlib.Path, help="results; cases that it has already are kept")
    one.add_argument("--jobs", type=int, default=2)
    one.add_argument("--share", type=float, default=1.0, help="the first part of each kind only, 0 ... 1")
    which = one.add_mutually_exclusive_group()
    which.add_argument("--inexact", action="store_true", help="worlds that no model matches (tests/blind/inexact.h), in place of the set")
    which.add_argument("--quiet", action="store_true", help="each effect once, in a record without noise, in place of the set")
    which.add_argument("--fresh", action="store_true", help="seeds that nothing was tuned by, in place of the set")
    two = commands.add_parser("compare")
    two.add_argument("before", type=pathlib.Path)
    two.add_argument("after", type=pathlib.Path)
    arguments = parser.parse_args()
    if arguments.command == "run":
        build = os.path.abspath(arguments.build)
        specs = INEXACT if arguments.inexact else FRESH if arguments.fresh else quiet(build) if arguments.quiet else SET
        run(build, arguments.file.resolve(), arguments.jobs, arguments.share, specs)
    else:
        compare(arguments.before, arguments.after)


if __name__ == "__main__":
    main()
