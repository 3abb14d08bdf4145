#!/usr/bin/env python3
"""What the checks of the shipped scenarios would not see: `dynoproof probe` of each, once with all of its checks and once without the
golden trace, which holds whatever somebody has blessed.

  ci/blind_spots.py build/dynoproof             probes those without figures and keeps these in engine/probe/blind_spots.json, as they come
  ci/blind_spots.py build/dynoproof ID ...      these, whether or not there are figures; `--jobs N`: runs at a time
  ci/blind_spots.py --write                     the table in engine/probe/README.md, from that file; `--check`: 1 where it is another

Ends with 1 where a probe fails."""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import block

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "engine/probe/blind_spots.json"
PAGE = "engine/probe/README.md"


def probe(program, scenario, more, jobs):
    """The document of a probe; None where no check takes part."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "p.json"
        done = subprocess.run([program, "probe", scenario, "--jobs", str(jobs), "--json", str(file), *more], capture_output=True, text=True)
        if done.returncode == 0:
            return json.loads(file.read_text())
        if "no check takes part" in done.stderr:
            return None
        sys.exit(f"{scenario}: probe ends with {done.returncode}\n{done.stderr}")


def figures(document):
    if document is None:
        return None
    seen = [one for one in document["limits"] if one["state"] in ("seen", "unseen")]
    holes = [one for one in seen if one["hole"]]
    # Two directions of one effect are one error.
    places = {(one["effect"], one["at"]) for one in holes}
    return {"tried": len({(one["effect"], one["at"]) for one in seen}), "pass": len(places), "runs": document["runs"],
            "worst": sorted({one["effect"] for one in holes})}


def table(kept):
    rows = ["| scenario | usual errors tried | pass all checks | pass without the golden trace | kinds of those that pass all |",
            "|---|---|---|---|---|"]

    def cell(one):
        return "no other check" if one is None else f"{one['pass']}"

    for name, one in sorted(kept.items()):
        every, rest = one["all"], one["without_golden"]
        rows.append(f"| `{name}` | {every['tried']} | {cell(every)} | {cell(rest)} | {', '.join(every['worst'])} |")
    total = sum(one["all"]["tried"] for one in kept.values())
    passing = sum(one["all"]["pass"] for one in kept.values())
    rows.append(f"| all {len(kept)} | {total} | {passing} | | |")
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("scenarios", nargs="*")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_intermixed_args()
    kept = json.loads(RESULTS.read_text()) if RESULTS.exists() else {}
    if options.write:
        return block.write(PAGE, "blind_spots", table(kept))
    if options.check:
        return block.differing([(PAGE, "blind_spots", table(kept))], "ci/blind_spots.py")
    if not options.program:
        parser.error("a program is needed")
    program = str(pathlib.Path(options.program).resolve())
    names = options.scenarios
    if not names:
        listed = json.loads(subprocess.run([program, "list", "--json", "-"], capture_output=True, text=True, check=True).stdout)
        names = [one["id"] for one in listed["scenarios"] if one["id"] not in kept]
    for name in names:
        kept[name] = {"all": figures(probe(program, name, [], options.jobs)),
                      "without_golden": figures(probe(program, name, ["--without", "golden"], options.jobs))}
        if kept[name]["all"] is None:
            del kept[name]
            print(f"{name}: no check takes part", flush=True)
            continue
        print(f"{name}: {kept[name]['all']['pass']} of {kept[name]['all']['tried']} pass", flush=True)
        RESULTS.write_text(json.dumps(dict(sorted(kept.items())), indent=1) + "\n")
    return None


if __name__ == "__main__":
    sys.exit(main())
