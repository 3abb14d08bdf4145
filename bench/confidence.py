#!/usr/bin/env python3
"""How far a verdict of the diagnosis is to be trusted: how often one of its kind was right about made cases.

  bench/confidence.py count COMMIT RESULTS.json ...   counts results of bench/diagnosis.py run
  bench/confidence.py write                           the table of the program, and the one of its page; `check`: 1 where they are others

`count` keeps bench/confidence.json: by verdict, with one effect shown or several, how many cases there were and in how many every effect
that was shown had been hidden. Of each seed the cases with even numbers calibrate, and those with odd ones tell how well that holds.
"""
import argparse
import json
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "ci"))
import block  # noqa: E402

FILE = ROOT / "bench/confidence.json"
TABLE = ROOT / "engine/diagnosis/confidence_cases.h"
PAGE = ("engine/diagnosis/README.md", "confidence")
VERDICTS = {"effect_found": "kEffectFound", "main_cause": "kMainCause", "ambiguous": "kAmbiguous", "unexplained": "kUnexplained"}
ENOUGH = 20  # confidence.cc


def shown(case):
    return case["found"].split()


def is_right(case):
    hidden = {f"{cause['effect']}@{cause['at']}" for cause in case["causes"]}
    return set(shown(case)) <= hidden


def kind(case):
    return case["verdict"], len(shown(case)) > 1


def counted(cases):
    """By kind of verdict: cases, and right ones among them. A verdict that shows no effect has nothing to be sure of."""
    table = {}
    for case in cases:
        if case["verdict"] in VERDICTS and shown(case):
            row = table.setdefault(kind(case), [0, 0])
            row[0] += 1
            row[1] += is_right(case)
    return [{"verdict": v, "several": s, "cases": n, "right": k} for (v, s), (n, k) in sorted(table.items())]


def confidence(row):
    return (row["right"] + 0.5) / (row["cases"] + 1)


def halves(cases):
    """Each part in two by its numbers, even and odd: neither has other scenarios or kinds than the other."""
    return [[case for case in cases if case["number"] % 2 == half] for half in (0, 1)]


def count(commit, files):
    cases = {}
    for file in files:
        loaded = json.loads(pathlib.Path(file).read_text())
        for case in loaded["cases"] if isinstance(loaded, dict) else loaded:
            cases[case["seed"], case["kind"], case["number"]] = case  # of one seed there may be a null and an effect of the same number
    first, second = halves(list(cases.values()))
    parts = {seed: sum(1 for s, _, _ in cases if s == seed) for seed in sorted({s for s, _, _ in cases})}
    return {"commit": commit, "cases_by_seed": parts, "all": counted(cases.values()), "calibrating": counted(first), "checking": counted(second)}


def header(kept):
    rows = "".join(f"    {{Conclusion::{VERDICTS[row['verdict']]}, {str(row['several']).lower()}, {row['cases']}, {row['right']}}},\n"
                   for row in kept["all"])
    return f"""// Written by bench/confidence.py from bench/confidence.json: made cases by their verdict, of the program {kept['commit']}.
#pragma once

#include "diagnosis/conclusion.h"

namespace dynoproof::diagnosis {{

struct MadeCases {{
  Conclusion verdict;
  bool several;  // effects were shown
  int count, right;
}};
// clang-format off
inline constexpr MadeCases kMadeCases[] = {{
{rows}}};
// clang-format on

}}  // namespace dynoproof::diagnosis
"""


def page(kept):
    lines = ["| verdict | effects shown | cases | right | `confidence` | by one half | right in the other |", "|---|---|---|---|---|---|---|"]

    def found(half, row):
        same = [one for one in kept[half] if (one["verdict"], one["several"]) == (row["verdict"], row["several"])]
        return same[0] if same else None

    for row in kept["all"]:
        by, there = found("calibrating", row), found("checking", row)
        lines.append(f"| {row['verdict']} | {'several' if row['several'] else 'one'} | {row['cases']} | {row['right']} | "
                     f"{f'{confidence(row):.2f}' if row['cases'] >= ENOUGH else 'null'} | {f'{confidence(by):.2f}' if by else '-'} | "
                     f"{f'''{there['right']} of {there['cases']}''' if there else '-'} |")
    seeds = ", ".join(f"{seed}: {n}" for seed, n in kept["cases_by_seed"].items())
    return lines + ["", f"Program {kept['commit']}; cases by seed {seeds}."]


def commit(text):
    """A commit's abbreviated name, for argparse."""
    if not re.fullmatch("[0-9a-f]{7,40}", text):
        raise argparse.ArgumentTypeError(f"no commit: {text}")
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    counting = commands.add_parser("count")
    counting.add_argument("commit", type=commit)
    counting.add_argument("results", nargs="+")
    commands.add_parser("write")
    commands.add_parser("check")
    arguments = parser.parse_args()
    if arguments.command == "count":
        FILE.write_text(json.dumps(count(arguments.commit, arguments.results), indent=1) + "\n")
        return 0
    kept = json.loads(FILE.read_text())
    if arguments.command == "write":
        TABLE.write_text(header(kept))
        block.write(*PAGE, page(kept))
        return 0
    others = [str(TABLE.relative_to(ROOT))] if TABLE.read_text() != header(kept) else []
    others += [PAGE[0]] if block.read(*PAGE) != page(kept) else []
    if others:
        print(f"{', '.join(others)} says otherwise: bench/confidence.py write")
    return 1 if others else 0


if __name__ == "__main__":
    sys.exit(main())
