#!/usr/bin/env python3
"""Every link of a page to another file of the project leads to a file, and to a heading where it names one. Fails on one that
does not. check_links.py [ROOT]"""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)


def prose(page):
    return re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S)


def anchor(heading):
    """As the forges make it: no punctuation, hyphens for spaces."""
    return re.sub(r"[^\w\- ]", "", re.sub(r"\[(.*?)\]\(.*?\)", r"\1", heading).lower()).replace(" ", "-")


pages = [root / name for name in subprocess.run(["git", "-C", str(root), "ls-files", "--cached", "--others", "--exclude-standard", "*.md"],
                                                capture_output=True, text=True, check=True).stdout.split("\n") if name]
faults, count = [], 0
for page in pages:
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if re.match(r"[a-z]+:", target):
            continue
        count += 1
        name, _, place = target.partition("#")
        to = (page.parent / name).resolve() if name else page
        if not to.exists():
            faults.append(f"{page.relative_to(root)}: {target}: there is no such file")
        elif place and place not in map(anchor, re.findall(r"^#+ (.*)$", prose(to), re.M)):
            faults.append(f"{page.relative_to(root)}: {target}: the page has no such heading")
print("\n".join(faults) if faults else f"links: all {count} lead somewhere")
sys.exit(1 if faults else 0)
