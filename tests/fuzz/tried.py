#!/usr/bin/env python3
"""What readers of files were tried with, as counted: results.json beside this script, and the table of it in
tests/README.md.

tried.py fuzz out/fuzz/runs     adds what ci/fuzz.sh has written there to what was counted before, and empties that file, so that
                                nothing counts twice; findings are those of the last time, for an earlier one is mended
tried.py flips LOG              takes over what `DYNOPROOF_BIT_FLIPS=all trace_test --gtest_filter='BitFlips.*'` printed
tried.py readme [--check]       writes the table into that page; --check: ends with 1 where it is another one"""
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent.parent / "ci"))
import block  # noqa: E402

PAGE = "tests/README.md"
RESULTS = HERE / "results.json"
READERS = {"csv": "CSV, LabVIEW", "mat": "MAT v4 to v7.3", "hdf5": "HDF5: traces, files of others", "scenario": "scenarios",
           "map": "maps of records", "golden": "golden tolerances", "campaign": "campaigns", "history": "results for the history"}
FORMATS = {"OfACompressedMat5": ["mat"], "OfACompressedMat73": ["mat"], "OfOurTraces": ["hdf5", "hdf5"]}
HEAD = "| reader of | stored files | fuzzed, hours | files tried | findings left | bits turned, one at a time | of these, other values |"


def take_fuzz(lines, before):
    fuzz = {reader: dict(one, findings=0) for reader, one in before.items()}
    for line in lines:
        reader, seconds, files, findings = line.split()
        one = fuzz.setdefault(reader, {"seconds": 0, "files": 0, "findings": 0})
        for key, count in (("seconds", seconds), ("files", files), ("findings", findings)):
            one[key] += int(count)
    return {reader: fuzz[reader] for reader in READERS if reader in fuzz}


def take_flips(text):
    flips, test, seen = [], None, 0
    for line in text.splitlines():
        if begins := re.match(r"\[ RUN +\] BitFlips\.(\w+)", line):
            test, seen = begins[1], 0
        if counts := re.search(r" (\d+) bits: refused (\d+), unchanged (\d+), a name .* gone (\d+), other values (\d+)", line):
            flips.append(dict(zip(("bits", "refused", "unchanged", "gone", "wrong"), map(int, counts.groups())),
                              test=test, reader=FORMATS[test][seen]))
            seen += 1
    if sorted(one["test"] for one in flips) != sorted(name for name, of in FORMATS.items() for _ in of):
        sys.exit("tried: the log has not every format of BitFlips.*")
    return flips


def number(count):
    return f"{count:,}".replace(",", " ")


def table(results):
    rows = [HEAD, "|" + "---|" * HEAD.count(" | ") + "---|"]
    for reader, name in READERS.items():
        stored = sum(1 for _ in (HERE / "corpus" / reader).iterdir())
        fuzz = results["fuzz"].get(reader, {"seconds": 0, "files": 0, "findings": 0})
        flips = [one for one in results["flips"] if one["reader"] == reader]
        bits, wrong = (sum(one[key] for one in flips) for key in ("bits", "wrong"))
        rows.append(f"| {name} | {stored} | {fuzz['seconds'] / 3600:.2f} | {number(fuzz['files'])} | {fuzz['findings']} | "
                    f"{number(bits) if bits else ''} | {wrong if bits else ''} |")
    return rows


def main(arguments):
    if not arguments or arguments[0] not in ("fuzz", "flips", "readme"):
        sys.exit(__doc__)
    results = json.loads(RESULTS.read_text()) if RESULTS.exists() else {"fuzz": {}, "flips": []}
    if arguments[0] == "readme":
        if "--check" not in arguments:
            block.write(PAGE, "fuzz", table(results))
        elif wrong := [row for row in table(results) if row not in block.read(PAGE, "fuzz")]:
            sys.exit("\n".join([f"{PAGE} has not these rows, write them by `tried.py readme`:"] + wrong))
        elif block.read(PAGE, "fuzz") != table(results):
            sys.exit(f"{PAGE} has other rows besides, write them by `tried.py readme`")
        return
    file = pathlib.Path(arguments[1])
    text = file.read_text()
    results[arguments[0]] = take_fuzz(text.splitlines(), results["fuzz"]) if arguments[0] == "fuzz" else take_flips(text)
    RESULTS.write_text(json.dumps(results, indent=1) + "\n")
    if arguments[0] == "fuzz":
        file.write_text("")


main(sys.argv[1:])
