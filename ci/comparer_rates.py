#!/usr/bin/env python3
"""The comparer's own error rates, measured on the shipped golden traces.

comparer_rates.py BUILD RUNS RUN.json... [--readme check|write]

RUNS is the folder of traces that `run` of all scenarios left, RUN.json what it and runs of other builds or classes of vector
instructions (DYNOPROOF_CPU_CLASS) wrote with --json; ci/nightly.sh has them. Nothing is simulated anew. The comparisons
with golden data that fail in a RUN.json are false failures, with the upper bound at 95 % that none in N leaves (3/N). Then
BUILD/bench/comparer_rates alters the traces in known ways and counts what is seen. Prints both as tests/README.md has them;
--readme write puts them there and a sentence of them into README.md, --readme check holds what is there against them. Ends
with 0; with 1 where a comparison failed falsely or a page says otherwise; with 2 where something could not run."""
import argparse
import json
import pathlib
import subprocess
import sys

import block

PAGE = "tests/README.md"


class Broken(Exception):
    pass


def comparisons_of(result):
    """The comparisons with golden data in what `run --json` wrote, as (scenario, name, passed)."""
    return [(scenario["id"], check["name"], check["verdict"] == "pass")
            for scenario in json.loads(result.read_text())["scenarios"] for check in scenario["checks"]
            if check["name"].startswith("golden ")]


def percent(seen, total):
    return f"{seen} of {total} ({100 * seen / total:.0f} %)"


def text_of(rates, comparisons, runs):
    failed = sum(1 for one in comparisons if not one[2])
    lines = [
        f"The comparison with golden traces was tried on {rates['signals']} signals of {rates['traces']} golden traces, altered",
        "in runs that pass (`ci/comparer_rates.py`). A half-width is what the tube allows, mostly 1e-7 of the nominal.",
        "",
        "| deviation | size | seen |",
        "|---|---|---|",
    ]
    for rate in rates["rates"]:
        size = f"{rate['size']:g} {rate['of']}" if rate["of"] else "what changes by more than the tube"
        lines.append(f"| {rate['kind']} | {size} | {percent(rate['seen'], rate['total'])} |")
    lines += [
        "",
        f"False failures: {failed} of {len(comparisons)} comparisons in {runs} run{'s' if runs > 1 else ''} of all scenarios"
        + (f", below {300 / len(comparisons):.2g} % at 95 %." if failed == 0 else "."),
    ]
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("runs", type=pathlib.Path)
    parser.add_argument("results", type=pathlib.Path, nargs="+", metavar="RUN.json")
    parser.add_argument("--readme", choices=["check", "write"])
    options = parser.parse_args()
    try:
        comparisons = [one for result in options.results for one in comparisons_of(result)]
        if not comparisons:
            raise Broken("no comparison with golden data in what was given")
        for scenario, name, passed in comparisons:
            if not passed:
                print(f"{scenario}: {name} fails", file=sys.stderr)
        tool = subprocess.run([str(options.build / "bench/comparer_rates"), str(block.ROOT / "golden"), str(options.runs)],
                              capture_output=True, text=True)
        if tool.returncode != 0:
            raise Broken(tool.stderr.strip())
        lines = text_of(json.loads(tool.stdout), comparisons, len(options.results))
        print("\n".join(lines))
        if options.readme == "write":
            block.write(PAGE, "comparer", lines)
        elif options.readme == "check" and block.read(PAGE, "comparer") != lines:
            print(f"{PAGE} says otherwise: ci/comparer_rates.py BUILD RUNS RUN.json... --readme write", file=sys.stderr)
            return 1
        return 0 if all(passed for _, _, passed in comparisons) else 1
    except (Broken, block.Missing, OSError, ValueError, KeyError, TypeError) as error:
        print(f"comparer_rates: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
