#!/usr/bin/env python3
"""Holds every #include of the engine against the layers: dependencies point down only."""
import pathlib
import re
import sys

# A layer may include itself and what stands behind it.
MAY_INCLUDE = {
    "base": [],
    "mechanics": ["base"],
    "model": ["mechanics", "base"],
    "control10k": [],  # goes to a real-time target as it is
    "plugins": ["model", "mechanics", "base", "control10k"],
    "scenario": ["model", "base"],
    "sim": ["model", "mechanics", "base"],
    "trace": ["base"],
    "score": ["base"],
    "oracles": ["model", "base"],
    "experiment": ["scenario", "sim", "trace", "score", "oracles", "model", "mechanics", "base", "control10k"],
    "diagnosis": ["experiment", "scenario", "sim", "trace", "score", "model", "mechanics", "base"],
    "history": ["score", "base"],
    "campaign": ["experiment", "scenario", "sim", "trace", "score", "model", "mechanics", "base", "control10k"],
    "reports": ["campaign", "history", "diagnosis", "experiment", "score", "trace", "model", "mechanics", "base"],
    "app": ["reports", "campaign", "history", "diagnosis", "experiment", "scenario", "sim", "trace", "score", "model",
            "mechanics", "base"],
}
FOLDERS = {"oracles": "golden/oracles", "reports": "reports"}

root = pathlib.Path(__file__).resolve().parent.parent
faults = []
for layer, below in MAY_INCLUDE.items():
    folder = root / FOLDERS.get(layer, f"engine/{layer}")
    for path in sorted(folder.rglob("*.h")) + sorted(folder.rglob("*.cc")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#include "([a-z0-9_]+)/', line)
            if match and match[1] in MAY_INCLUDE and match[1] not in [layer, *below]:
                faults.append(f"{path.relative_to(root)}:{number}: {layer} must not include {match[1]}")
print("\n".join(faults) if faults else f"layers: {len(MAY_INCLUDE)} hold")
sys.exit(1 if faults else 0)
