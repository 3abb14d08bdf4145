#!/usr/bin/env python3
"""How many claims of the thesis have which standing, as `reproduce all` counts them: the line in tests/README.md.

claims.py PROGRAM [--write]     prints the line; --write puts it there. Ends with 1 where the page says otherwise."""
import json
import subprocess
import sys

import block

PAGE = "tests/README.md"
WORDS = {"reproduced": "reproduced", "reproduced_assumed": "reproduced with assumed data", "derived": "derived",
         "contradicted": "contradicted", "misprint": "misprint", "not_checkable": "not checkable"}


def main(program, *options):
    asked = subprocess.run([program, "reproduce", "all", "--json", "-"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, cwd=block.ROOT)
    document = json.loads(asked.stdout)
    counts = document["summary"]
    line = f"of {len(document['claims'])} claims: " + ", ".join(f"{counts[key]} {words}" for key, words in WORDS.items())
    print(line)
    if "--write" in options:
        block.write(PAGE, "claims", [line])
    elif block.read(PAGE, "claims") != [line]:
        sys.exit(f"{PAGE} says otherwise: ci/claims.py PROGRAM --write")


if len(sys.argv) < 2:
    sys.exit(__doc__)
main(*sys.argv[1:])
