#!/usr/bin/env python3
"""Compares the benchmarks of two builds, run in turn in one job: which became better, the same, or worse?

usage: bench/ab.py BASE HEAD [--json FILE] [--markdown FILE]     BASE, HEAD: build folders
       bench/ab.py --prove BUILD [--runs 300]                    false alarms and power of this very gate, measured

Both builds run alternately on one processor, in an order drawn anew for each round; a round gives one ratio head/base a
benchmark, each the median of many short repetitions (not the best: on a shared host a processor has two speeds, and
whether a few repetitions meet the rarer one is chance). The verdict looks at the interval of the median ratio from order
statistics: nothing is assumed of the scatter's law. After 15 rounds, and again after 31 and 63 where nothing was decided:
  worse          the interval lies above 1 and reaches the smallest relevant change, 3 %
  better         below 1, likewise
  same           the interval lies within 3 % of 1
  inconclusive   else: too much scatter here
Intervals hold jointly for all benchmarks and all looks at 99.8 %. A benchmark that the head has lost fails.
Ends with 5 worse or missing, 4 inconclusive (none worse), 2 bad usage, 0 else."""
import argparse
import json
import math
import os
import pathlib
import random
import statistics
import subprocess
import sys

RELEVANT = 0.03                  # smallest change that matters
ALPHA = 0.002                    # of a wrong interval, all benchmarks and looks together
LOOKS = (15, 31, 63)             # rounds
PROGRAMS = {                     # program: benchmarks of the gate; the closed loop propagates a line of 70 masses
    "core_bench": "^CoreStep|^TorqueControlAndMachine|^TwoNotches|^ClosedLoop",
}


def measure(build, extra_percent=0, programs=PROGRAMS):
    """{benchmark: ns}, the median of many short repetitions."""
    times = {}
    for program, pattern in programs.items():
        path = pathlib.Path(build) / "bench" / program
        if not path.exists():
            continue
        command = [path, "--benchmark_format=json", f"--benchmark_filter={pattern}", "--benchmark_min_time=0.0005",
                   "--benchmark_repetitions=25"]
        done = subprocess.run(command, capture_output=True, text=True,
                              env={**os.environ, "DYNOPROOF_EXTRA_WORK_PERCENT": str(extra_percent)})
        if done.returncode != 0:
            sys.exit(f"{path} failed:\n{done.stderr}")
        for one in json.loads(done.stdout)["benchmarks"]:
            if one["run_type"] != "iteration" or one.get("error_occurred"):
                continue
            name = one["run_name"] + (" " + one["label"] if one.get("label") else "")
            times.setdefault(name, []).append(one["cpu_time"])
    return {name: statistics.median(taken) for name, taken in times.items()}


def stay():
    """Keeps this process and what it starts on one processor: on a shared host they differ by more than what is looked
    for, and a ratio of two of them says nothing."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def interval(ratios, alpha):
    """Of the median, from order statistics: covers with at least 1 - alpha whatever the ratios' law."""
    n, ordered = len(ratios), sorted(ratios)
    below, k = 0.0, 0                # largest k with 2 P(Binomial(n, 1/2) < k) <= alpha
    while 2.0 * (below + math.comb(n, k) / 2.0**n) <= alpha:
        below += math.comb(n, k) / 2.0**n
        k += 1
    return (ordered[k - 1], ordered[n - k]) if k > 0 else (0.0, math.inf)


def verdict(low, high):
    if low > 1.0 and high >= 1.0 + RELEVANT:
        return "worse"
    if high < 1.0 and low <= 1.0 - RELEVANT:
        return "better"
    return "same" if 1.0 - RELEVANT < low and high < 1.0 + RELEVANT else "inconclusive"


def gate(sample, say=lambda text: None):
    """`sample(side)` measures base (0) or head (1). {benchmark: (median, low, high, verdict, rounds)}."""
    ratios, results = {}, {}
    for number in range(1, LOOKS[-1] + 1):
        order = random.sample((0, 1), 2)
        taken = {side: sample(side) for side in order}
        for name in sorted({*taken[0], *taken[1]}):
            if name in taken[0] and name in taken[1]:
                ratios.setdefault(name, []).append(taken[1][name] / taken[0][name])
            else:
                said = "new" if name in taken[1] else "missing"
                results[name] = (math.nan, math.nan, math.nan, said, number)
        if number in LOOKS:
            level = ALPHA / len(LOOKS) / max(1, len(ratios))
            for name, values in ratios.items():
                if name in results and results[name][3] != "inconclusive":
                    continue  # decided at an earlier look
                low, high = interval(values, level)
                results[name] = (statistics.median(values), low, high, verdict(low, high), number)
            if all(one[3] != "inconclusive" for one in results.values()):
                break
            say(f"{number} rounds: " + ", ".join(name for name, one in results.items() if one[3] == "inconclusive") + " undecided")
    return results


def table(results):
    lines = [f"{'benchmark':<44} {'head/base':>9}   {'interval':<17} {'rounds':>6}  verdict"]
    for name, (median, low, high, said, rounds) in sorted(results.items()):
        lines.append(f"{name:<44} {median:>9.4f}   {f'{low:.4f} ... {high:.4f}':<17} {rounds:>6}  {said}")
    return "\n".join(lines)


def exit_code(results):
    said = {one[3] for one in results.values()} - {"new"}
    if not said:
        print("nothing was compared", file=sys.stderr)
        return 4
    return 5 if said & {"worse", "missing"} else 4 if "inconclusive" in said else 0


def upper(alarms, runs):
    """One-sided 95 % bound of a rate (Clopper, Pearson), by bisection."""
    low, high = 0.0, 1.0
    for _ in range(60):
        p = 0.5 * (low + high)
        reached = sum(math.comb(runs, k) * p**k * (1 - p) ** (runs - k) for k in range(alarms + 1))
        low, high = (p, high) if reached > 0.05 else (low, p)
    return high


def prove(build, runs, report):
    """Unchanged code against itself, and against itself with some steps done twice (real work, not scaled times)."""
    quick = {"core_bench": "^CoreStep"}
    outcome = {}
    for extra, count in ((10, runs // 10), (5, runs // 10), (3, runs // 10), (0, runs)):
        found = {"worse": 0, "better": 0, "inconclusive": 0, "same": 0}
        for number in range(count):
            results = gate(lambda side: measure(build, extra if side else 0, quick))
            said = [one[3] for one in results.values()]
            found[next(kind for kind in ("worse", "better", "inconclusive", "same") if kind in said)] += 1
            print(f"\r{extra:>3} % more work: {number + 1} of {count}, {found}", end="", file=sys.stderr)
        print(file=sys.stderr)
        outcome[extra] = {**found, "runs": count}
    alarms = outcome[0]["worse"] + outcome[0]["better"]
    bound = upper(alarms, runs)
    print(f"unchanged code: {alarms} false alarms in {runs} runs, at most {100 * bound:.2f} % (95 %); "
          f"{outcome[0]['inconclusive']} inconclusive")
    for extra in (3, 5, 10):
        print(f"{extra} % more work: found in {outcome[extra]['worse']} of {outcome[extra]['runs']} runs, "
              f"{outcome[extra]['inconclusive']} inconclusive, {outcome[extra]['same']} called the same")
    if report:
        pathlib.Path(report).write_text(json.dumps({"runs": outcome, "false_alarm_upper_95": bound}, indent=2) + "\n")
    return 0 if bound < 0.02 else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("builds", nargs="*")
    parser.add_argument("--prove", metavar="BUILD")
    parser.add_argument("--runs", type=int, default=300)
    parser.add_argument("--json")
    parser.add_argument("--markdown")
    options = parser.parse_args()
    stay()
    if options.prove:
        sys.exit(prove(options.prove, options.runs, options.json))
    if len(options.builds) != 2:
        parser.error("two build folders are compared: BASE HEAD")
    for build in options.builds:
        if not (pathlib.Path(build) / "bench").is_dir():
            parser.error(f"{build} is no build folder with bench/ in it")
    results = gate(lambda side: measure(options.builds[side]), lambda text: print(text, file=sys.stderr))
    print(table(results))
    code = exit_code(results)
    if options.json:
        rows = [{"name": name, "ratio": one[0], "interval": one[1:3], "verdict": one[3], "rounds": one[4]}
                for name, one in sorted(results.items())]
        pathlib.Path(options.json).write_text(json.dumps({"exit": code, "benchmarks": rows}, indent=2) + "\n")
    if options.markdown:
        pathlib.Path(options.markdown).write_text("```\n" + table(results) + "\n```\n")
    sys.exit(code)


if __name__ == "__main__":
    main()
