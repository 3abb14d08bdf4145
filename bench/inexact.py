#!/usr/bin/env python3
"""What the diagnosis makes of worlds that no model matches, by what is inexact in them.

  bench/inexact.py keep COMMIT RESULTS.json ...   keeps results of bench/diagnosis.py run --inexact as bench/inexact.json
  bench/inexact.py write                          the table of the page; `check`: 1 where it is another

A case with two things that are inexact stands in two rows, and once in the last one.
"""
import argparse
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "ci"))
import block  # noqa: E402
import confidence  # noqa: E402

FILE = ROOT / "bench/inexact.json"
PAGE = ("engine/diagnosis/README.md", "inexact")
KEPT = ("seed", "number", "kind", "scenario", "inexact", "inexact_size", "size", "strength", "noise", "causes", "verdict", "found",
        "outcome", "cpu_s")
WORDS = {"absorber": "a small mass on a spring", "soft_stop": "a drive that goes soft near its limit", "creeping": "friction that creeps",
         "hum": "hum", "filtered": "filtered outputs", "quantised": "quantised outputs", "drifting": "sensors that warm up",
         "coloured": "coloured noise", "noisy_input": "noisy inputs", "decimated": "every second or fourth row",
         "fitted": "three numbers fitted to the record"}


def keep(commit, files):
    cases = {}
    for file in files:
        for case in json.loads(pathlib.Path(file).read_text())["cases"]:
            cases[case["kind"], case["seed"], case["number"]] = {field: case[field] for field in KEPT}
    exact = [key for key, case in cases.items() if not case["inexact"]]
    if exact:
        sys.exit(f"{len(exact)} cases are exact, {exact[0]} first: these belong to bench/diagnosis.py compare")
    if not cases:
        sys.exit("there is no case in these files")
    return {"commit": commit, "cases": [cases[key] for key in sorted(cases)]}


def share(cases, outcomes):
    hits = sum(case["outcome"] in outcomes for case in cases)
    return str(hits) if hits else ""


def row(name, cases):
    effects = [case for case in cases if case["causes"]]
    nothing = [case for case in cases if not case["causes"]]
    cells = [name, str(len(effects))]
    cells += [share(effects, (one,)) for one in ("right", "in the set", "abstained", "missed", "wrong")]
    cells += [str(len(nothing)), share(nothing, ("right", "abstained")), share(nothing, ("near",)), share(nothing, ("false alarm",))]
    cells.append(share(cases, ("broken", "stopped")))
    return "| " + " | ".join(cells) + " |"


def page(kept):
    cases = kept["cases"]
    lines = ["| what is inexact | effects | right | in a set | abstained | missed | wrong | nothing hidden | no name | near | "
             "false alarm | broken, stopped |", "|" + "---|" * 12]
    for what, words in WORDS.items():
        some = [case for case in cases if what in case["inexact"]]
        if some:
            lines.append(row(words, some))
    seconds = sorted(case["cpu_s"] for case in cases)
    return lines + [row("all", cases), "",
                    f"Program {kept['commit']}, {len(cases)} cases; CPU s a case: median {seconds[len(seconds) // 2]:.0f}, longest {seconds[-1]:.0f}."]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    keeping = commands.add_parser("keep")
    keeping.add_argument("commit", type=confidence.commit)
    keeping.add_argument("results", nargs="+")
    commands.add_parser("write")
    commands.add_parser("check")
    arguments = parser.parse_args()
    if arguments.command == "keep":
        kept = keep(arguments.commit, arguments.results)
        FILE.write_text('{"commit": "%s", "cases": [\n' % kept["commit"] + ",\n".join(map(json.dumps, kept["cases"])) + "\n]}\n")
        return 0
    text = page(json.loads(FILE.read_text()))
    if arguments.command == "write":
        block.write(*PAGE, text)
        return 0
    if block.read(*PAGE) != text:
        print(f"{PAGE[0]} says otherwise: bench/inexact.py write")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
