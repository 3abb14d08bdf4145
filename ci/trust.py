#!/usr/bin/env python3
"""What README.md says about how far to trust the program: figures that other scripts have measured and written into their
pages, gathered in one short table, each with the page that has the whole of it.

trust.py [--write]     prints the table; --write puts it there. Ends with 1 where the page says otherwise or a figure is gone."""
import json
import re
import sys

import block

PAGE = "README.md"


def only(pattern, text, page):
    """The one place of a page that has this form: a figure that is gone or stands there twice is nobody's figure."""
    found = re.findall(pattern, text, re.MULTILINE)
    if len(found) != 1:
        sys.exit(f"trust: {page} has {len(found)} places of the form {pattern}")
    return found[0]


def comparison():
    table = "\n".join(block.read("tests/README.md", "comparer"))
    late, tenth, false = (only(pattern, table, "tests/README.md") for pattern in (
        r"one sample late \|[^|]*\| (\d+ of \d+)", r"spike between kept samples \| 0.1 ranges \| (\d+ of \d+)",
        r"False failures: (\d+ of \d+) comparisons"))
    return ("Does a comparison with a golden trace see a change?",
            f"{late} delays by one sample and {tenth} spikes of a tenth of the range between two kept samples were seen; "
            f"{false} comparisons failed falsely", "tests/README.md#the-comparison-with-golden-traces")


def mutants():
    page = "tests/mutants/README.md"
    rows = re.findall(r"^\| .* \| \d+ of \d+ \|$", (block.ROOT / page).read_text(), re.MULTILINE)
    seen = [row for row in rows if not re.search(r"\| 0 of \d+ \|$", row)]
    return ("Does a check see a fault in the physics?",
            f"{len(seen)} of {len(rows)} seeded faults failed a check: wrong signs, a per cent in a stiffness, dropped terms, "
            "a sample's delay", page)


def probes():
    spots, limits = (json.loads((block.ROOT / f"engine/probe/{name}.json").read_text()) for name in ("blind_spots", "limits"))
    tried, passing = (sum(one["all"][key] for one in spots.values()) for key in ("tried", "pass"))
    stated = [limit for one in limits.values() for limit in one["limits"]]
    true = sum(limit["seen_above"] and not limit["seen_below"] for limit in stated)
    return ("What would the checks not see?",
            f"of {tried} usual errors in {len(spots)} shipped scenarios {passing} pass all checks; a run with an error a fifth larger than "
            f"`probe` says would pass failed, and one a fifth smaller passed, of {true} of {len(stated)} limits in scenarios as users "
            "write them", "engine/probe/README.md#the-shipped-scenarios")


def readers():
    results = json.loads((block.ROOT / "tests/fuzz/results.json").read_text())
    fuzz, flips = results["fuzz"].values(), results["flips"]
    hours, files, findings = (sum(one[key] for one in fuzz) for key in ("seconds", "files", "findings"))
    bits, wrong = (sum(one[key] for one in flips) for key in ("bits", "wrong"))
    return ("Is a damaged file read as other numbers?",
            f"{len(fuzz)} readers were fuzzed for {hours / 3600:.1f} hours with {files / 1e6:.0f} million files: {findings} findings; "
            f"of {bits} bits turned in MAT files and traces, one at a time, {wrong} gave other values", "tests/README.md#damaged-files")


def kills():
    rows = [[int(cell) for cell in re.findall(r"\| (\d+)(?= \|)", row)] for row in block.read("tests/README.md", "kills")[2:]]
    points, at_random, broken = (sum(row[k] for row in rows) for k in (1, 2, 3))
    return ("Is anything lost when it is killed, or the disk is full?",
            f"{len(rows)} commands that write were ended, or failed, at {points} of their calls that change files, and killed {at_random} "
            f"times at random: {broken} times something was lost or half there", "tests/README.md#kills-and-full-disks")


def claims():
    line = "\n".join(block.read("tests/README.md", "claims"))
    total, same, assumed, derived, against = (only(pattern, line, "tests/README.md") for pattern in (
        r"of (\d+) claims", r"(\d+) reproduced,", r"(\d+) reproduced with", r"(\d+) derived", r"(\d+) contradicted"))
    return ("Does it agree with the thesis?",
            f"of {total} claims {int(same) + int(assumed)} are reproduced, {assumed} of them with assumed data, {derived} agree with a "
            f"derivation, {against} are contradicted with the reason", "tests/README.md#the-claims-of-the-thesis")


def diagnosis():
    page = "engine/diagnosis/README.md"
    text = (block.ROOT / page).read_text()
    good = {kind: only(rf"^{kind} +\d+ +\d+ = .*?\) +(\d+) = ", text, page) for kind in ("effect", "pair", "unknown", "null", "decoy")}
    of = {kind: only(rf"^{kind} +(\d+) ", text, page) for kind in good}
    wrong, alarms = (only(rf"^{word} +\d+ +(\d+)$", text, page) for word in ("wrong", "false alarm"))
    measured = [row for row in block.read(page, "measured") if re.match(r"\| .*@", row)]
    right, in_set = (sum(f" | {word} | " in row for row in measured) for word in ("right", "in the set"))
    return ("Does `diagnose` name the cause?",
            f"hidden in made records: {good['effect']} of {of['effect']} effects and {good['pair']} of {of['pair']} pairs named or in the "
            f"set, {good['unknown']} of {of['unknown']} that it does not know left unnamed, {wrong} wrong; nothing to find: "
            f"{int(of['null']) + int(of['decoy'])} records, {alarms} alarms; measured: {right} of {len(measured)} right, "
            f"{in_set} in the set",
            page + "#beside-the-diagnosis-before")


def main(options):
    rows = ["| question | what was tried, and what came out |", "|---|---|"]
    rows += [f"| {question} | {answer} ([all]({page})) |"
             for question, answer, page in (comparison(), mutants(), probes(), readers(), kills(), claims(), diagnosis())]
    if options == ["--write"]:
        block.write(PAGE, "trust", rows)
    elif options:
        sys.exit(__doc__)
    print("\n".join(rows))
    if block.read(PAGE, "trust") != rows:
        sys.exit(f"{PAGE} says otherwise: ci/trust.py --write")


main(sys.argv[1:])
