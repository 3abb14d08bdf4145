#!/usr/bin/env python3
"""Where verdicts are made, NaN never passes: what is called a limit is compared by Within() or Reaches() of base/within.h,
or the line says in a comment why there is no NaN ("NaN: ..."). check_nan.py [ROOT]"""
import pathlib
import re
import sys

FOLDERS = ["score", "experiment", "history", "campaign", "thesis", "app"]

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
limit = r"[\w.\->]*(?:limit|allowed|toleran|threshold|budget|relevant|at_most|at_least|most_|least_|options\.alpha)[\w.\->]*(?:\(\))?"
factor = r"(?:[\w.]+ \* )?"
number = r"(?:-?[\d.]|static_cast<)"  # a limit beside a number: whether it is a limit at all; whole numbers
comparison = re.compile(rf" [<>]=? {factor}{limit}|(?<![\w.]){limit} [<>]=? (?!{number})")

faults, files = [], 0
for folder in FOLDERS:
    for path in sorted((root / "engine" / folder).glob("*.h")) + sorted((root / "engine" / folder).glob("*.cc")):
        files += 1
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code, _, comment = line.partition("//")
            code = re.sub(r'"(\\.|[^"\\])*"', '""', code)
            found = comparison.search(code)
            if found and "NaN:" not in comment:
                faults.append(f"{path.relative_to(root)}:{number}: \"{found[0].strip()}\": NaN may pass here; take Within() "
                              "or Reaches() of base/within.h, or say why there is none (// NaN: ...)")
if not files:
    sys.exit("NaN: no source found: does this script still know where verdicts are made?")
print("\n".join(faults) if faults else f"NaN: {files} files compare with limits by Within() and Reaches()")
sys.exit(1 if faults else 0)
