#!/usr/bin/env python3
"""Holds the 10 kHz core and the engine against bench/budgets.toml: instructions a step under callgrind (exact on any machine, so +1 % is a
finding), and with --time also times, which bind only where the machine is fit to be asked.
check_budgets.py [--time] [--json FILE] [BUILD]. Ends with 0 held, 5 broken, 4 nothing could be decided."""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent


def instructions(program, arguments):
    with tempfile.TemporaryDirectory() as folder:
        command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={folder}/out", program, *arguments]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
    return int(re.search(r"Collected : (\d+)", done.stderr)[1])


def fitness():
    """How late this machine wakes: the 99th percentile of 300 sleeps of 1 ms, in microseconds."""
    late = []
    for _ in range(300):
        begin = time.perf_counter()
        time.sleep(0.001)
        late.append(time.perf_counter() - begin - 0.001)
    return 1e6 * sorted(late)[297]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", nargs="?", default="build")
    parser.add_argument("--time", action="store_true")
    parser.add_argument("--json")
    options = parser.parse_args()
    budgets = tomllib.loads((ROOT / "bench/budgets.toml").read_text())
    folder = ROOT / options.build / "bench"
    results, worst = [], 0

    def judge(name, value, limit, unit, verdict):
        results.append({"name": name, "value": value, "limit": limit, "unit": unit, "verdict": verdict})
        print(f"{name:<44}{value:>12.2f} {unit:<14} limit {limit:<10.2f} {verdict}")
        return {"pass": 0, "inconclusive": 4, "fail": 5}[verdict]

    for name, budget in budgets["instructions"].items():
        try:
            few, many = budget["steps"]
            program = str(folder / budget.get("program", "core_steps"))
            count = (instructions(program, [name, str(many)]) - instructions(program, [name, str(few)])) / (many - few)
        except FileNotFoundError:
            print(f"valgrind or {program} is not here: nothing was counted")
            worst = max(worst, 4)
            continue
        limit = budget["per_step"] * (1.0 + budgets["tolerance"])
        verdict = "pass" if count <= limit else "fail"
        worst = max(worst, judge(f"instructions a step, {name}", count, limit, "instructions", verdict))
        if count < budget["per_step"] * (1.0 - budgets["tolerance"]):
            print(f"   fewer than recorded ({budget['per_step']}): enter the new count in bench/budgets.toml")
    if options.time:
        medians = {}
        for program in sorted({budget.get("program", "core_bench") for budget in budgets["time"].values()}):
            done = subprocess.run([str(folder / program), "--benchmark_format=json", "--benchmark_repetitions=5",
                                   "--benchmark_filter=" + "|".join(f"^{name}$" for name in budgets["time"])],
                                  check=True, capture_output=True, text=True)
            medians |= {one["run_name"]: one for one in json.loads(done.stdout)["benchmarks"]
                        if one.get("aggregate_name") == "median"}
        jitter = fitness()
        fit = jitter <= budgets["fitness"]["wake_p99_us"]
        print(f"the machine wakes {jitter:.0f} us late (99th percentile): {'fit' if fit else 'not fit, times do not bind'}")
        for name, budget in budgets["time"].items():
            one = medians[name]
            held = one["cpu_time"] <= budget["ns"]
            verdict = "pass" if held else "fail" if fit else "inconclusive"
            code = judge(f"time a step, {name}", one["cpu_time"], budget["ns"], "ns", verdict)
            worst = 5 if 5 in (worst, code) else max(worst, code)
            if "simulated_per_s" in one:
                print(f"   {one['simulated_per_s']:.0f} simulated seconds per second")
    if options.json:
        pathlib.Path(options.json).write_text(json.dumps(results, indent=2) + "\n")
    sys.exit(worst)


main()
