#!/usr/bin/env python3
"""Diagnosis and experiments know no effect and no plant by name: what these are they declare themselves, as EffectTraits
and PlantTraits. Fails on a registered name in quotes, and on a comparison with an effect's name. check_names.py [ROOT]"""
import pathlib
import re
import sys

FOLDERS = ["engine/diagnosis", "engine/identification", "engine/experiment"]

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
# Effects stand in the conformance table, each plant names itself in its Info().
effects = re.findall(r'^    \{"(\w+)",', (root / "tests/conformance/effects_test.cc").read_text(), re.M)
plants = [name for path in sorted((root / "engine/plugins/plant").rglob("*.cc"))
          for name in re.findall(r'return \{"plant",\s*"(\w+)"', path.read_text())]
if not effects or not plants:
    sys.exit("names: no effect or no plant found: does this script still know where they are registered?")
quoted = re.compile(f'"({"|".join(effects + plants)})"')
compared = re.compile(r'info\(\)\.name\s*([!=]=\s*"|\.(starts|ends)_with|\.find\()')

faults = []
for folder in FOLDERS:
    for path in sorted((root / folder).rglob("*.h")) + sorted((root / folder).rglob("*.cc")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            code = line.split("//")[0]
            for match in [quoted.search(code), compared.search(code)]:
                if match:
                    faults.append(f"{path.relative_to(root)}:{number}: {match[0]}: ask for a trait instead of a name")
print("\n".join(faults) if faults else f"names: {len(effects)} effects and {len(plants)} plants stay unnamed")
sys.exit(1 if faults else 0)
