#!/usr/bin/env python3
"""Lists the checks that use less than 1 % or more than 50 % of their tolerance: the first may be too wide to catch anything,
the second will fail one day for no reason. Exact checks (limit 0) have no margin and are left out.
margins.py RUN.json [--low SHARE] [--high SHARE]. Ends with 0, with 2 for a file that cannot be read, with 4 when it holds
no check with a tolerance."""
import argparse
import json
import math
import sys


def share(check):
    """How much of its limit a check uses; None for an exact one, infinite for one that came to no number."""
    value, limit = check["value"], check["limit"]
    if limit == 0:
        return None
    if value is None or limit is None:
        return math.inf
    if check["limit_is"] == "at_least":
        return limit / value if value > 0 else math.inf
    return value / limit


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", help="what `dynoproof run --json` wrote")
    parser.add_argument("--low", type=float, default=0.01)
    parser.add_argument("--high", type=float, default=0.5)
    options = parser.parse_args()
    try:
        with open(options.run, encoding="utf-8") as file:
            scenarios = json.load(file)["scenarios"]
        shares = [(share(check), scenario["id"], check) for scenario in scenarios for check in scenario["checks"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        print(f"{options.run}: {error!r} is no result of `dynoproof run --json`", file=sys.stderr)
        return 2
    judged = [one for one in shares if one[0] is not None]
    if not judged:
        print(f"{options.run}: no check with a tolerance", file=sys.stderr)
        return 4

    def show(title, chosen):
        print(f"{title}: {len(chosen)} of {len(judged)} checks")
        for used, scenario, check in chosen:
            print(f"  {100 * used:10.3g} %  {scenario}: {check['name']} ({check['kind']}, limit {check['limit']}"
                  f"{'' if check['unit'] == '1' else ' ' + check['unit']}): {check['origin']}")

    judged.sort(key=lambda one: -one[0])
    show(f"more than {100 * options.high:g} % of the tolerance used", [one for one in judged if one[0] > options.high])
    show(f"less than {100 * options.low:g} % used", [one for one in reversed(judged) if one[0] < options.low])
    return 0


sys.exit(main())
