#!/usr/bin/env python3
"""Compares results of one set of scenarios from builds with other compilers and options: every verdict must be the same,
and the largest spread of a value over its limit, by kind of check, says how much of the tolerances the build decides.
spread.py A.json B.json ... (what `dynoproof run --json` wrote). Ends with 0, with 1 where verdicts, limits or the checks
themselves differ or nothing was compared, with 2 for files that cannot be read."""
import json
import math
import sys


def read(name):
    """(scenario, check, occurrence) -> check."""
    with open(name, encoding="utf-8") as file:
        scenarios = json.load(file)["scenarios"]
    checks = {}
    for scenario in scenarios:
        for check in scenario["checks"]:
            which = 0
            while (key := (scenario["id"], check["name"], which)) in checks:
                which += 1
            checks[key] = {field: check[field] for field in ("kind", "verdict", "value", "limit")}
    return checks


def spread(checks):
    """Largest minus least value over the limit; None where no build came to a number."""
    values = [check["value"] for check in checks]
    if all(value is None for value in values):
        return None
    if any(value is None for value in values):
        return math.inf
    width, limit = max(values) - min(values), checks[0]["limit"]
    return 0.0 if width == 0 else width / abs(limit) if limit else math.inf


def main(names):
    if len(names) < 2 or "--help" in names:
        print(__doc__)
        return 0 if "--help" in names else 2
    try:
        runs = [read(name) for name in names]
    except (OSError, ValueError, KeyError, TypeError) as error:
        print(f"spread: {error!r}: no result of `dynoproof run --json`", file=sys.stderr)
        return 2
    faults, largest, compared = [], {}, 0
    for key in sorted(set().union(*runs)):
        label = f"{key[0]}: {key[1]}"
        missing = [name for name, run in zip(names, runs) if key not in run]
        if missing:
            faults.append(f"{label}: not in {', '.join(missing)}")
            continue
        checks = [run[key] for run in runs]
        compared += 1
        for field in ("verdict", "limit"):
            if len({check[field] for check in checks}) > 1:
                faults.append(f"{label}: {field} " + ", ".join(f"{check[field]} ({check['value']}) in {name}"
                                                               for name, check in zip(names, checks)))
        used = spread(checks)
        kind = checks[0]["kind"]
        if used is not None and used >= largest.get(kind, (-1.0,))[0]:
            largest[kind] = (used, label)
    print(f"{compared} checks of {len(names)} builds; largest spread over the limit:")
    for kind, (used, label) in sorted(largest.items(), key=lambda item: -item[1][0]):
        print(f"  {kind:<12}{used:>12.3g}  {label}")
    if compared == 0:
        faults.append("no check is in all of them: nothing was compared")
    for fault in faults:
        print(f"spread: {fault}", file=sys.stderr)
    return 1 if faults else 0


sys.exit(main(sys.argv[1:]))
