#!/usr/bin/env python3
"""Holds every #include of the engine against the layers: dependencies point down only. And every source has a header of
its own name, so that what it gives is found by its name."""
import pathlib
import re
import sys

# A layer may include itself and what stands behind it.
MAY_INCLUDE = {
    "base": [],
    "linear": ["base"],
    "model": ["linear", "base"],
    "control10k": [],  # goes to a real-time target as it is
    "plugins": ["model", "linear", "base", "control10k"],
    "scenario": ["model", "base"],
    "sim": ["model", "linear", "base"],
    "trace": ["base"],
    "score": ["base"],
    "oracles": ["model", "base"],
    "experiment": ["scenario", "sim", "trace", "score", "oracles", "model", "linear", "base", "control10k"],
    "fmu": ["experiment", "scenario", "sim", "model", "base"],
    "estimation": ["experiment", "scenario", "sim", "score", "model", "linear", "base"],
    "identification": ["estimation", "experiment", "scenario", "sim", "score", "model", "linear", "base"],
    "diagnosis": ["identification", "estimation", "experiment", "scenario", "sim", "trace", "score", "model", "linear", "base"],
    "probe": ["experiment", "scenario", "sim", "trace", "score", "model", "base"],
    "reduce": ["experiment", "scenario", "sim", "trace", "score", "model", "base"],
    "history": ["score", "base"],
    "campaign": ["experiment", "scenario", "sim", "trace", "score", "model", "linear", "base", "control10k"],
    "thesis": ["campaign", "identification", "experiment", "plugins", "scenario", "sim", "trace", "score", "model", "linear", "base",
               "control10k"],
    "reports": ["probe", "campaign", "history", "diagnosis", "identification", "experiment", "score", "trace", "model", "linear", "base"],
    "app": ["fmu", "reports", "probe", "reduce", "campaign", "history", "diagnosis", "identification", "estimation", "experiment", "scenario", "sim", "trace", "score", "model",
            "linear", "base"],
}
# engine/thesis can be deleted: only its own commands and the program's two hooks, main.cc and app.cc, know it.
KNOW_THESIS = ["engine/thesis/commands/", "engine/app/main.cc", "engine/app/app.cc"]
COMMANDS_MAY_INCLUDE = ["app", "reports"]
FOLDERS = {"oracles": "golden/oracles", "reports": "reports"}

# Sources without a header of their own name, and where what they give is declared.
DECLARED_ELSEWHERE = {
    "engine/app/main.cc": "nothing but main()",
    "engine/fmu/serve.cc": "fmu/unit.h: Serve(), what an exported unit asks",
    "engine/fmu/slave/slave.cc": "the functions of FMI 2.0",
    "engine/fmu/write.cc": "fmu/unit.h: Write()",
    "engine/linear/dense_eigenvalues.cc": "linear/dense.h: one header, but what compiles long side by side",
    "engine/linear/dense_exponential.cc": "linear/dense.h",
    "engine/linear/dense_svd.cc": "linear/dense.h",
    "engine/plugins/register_all.cc": "model/registry.h: RegisterBuiltIns()",
    "engine/sim/realtime_solver.cc": "sim/solver.h: one of two implementations",
    "engine/sim/reference_solver.cc": "sim/solver.h: the other one",
    "engine/plugins/plant/drive_line/drive_line_builder.cc": "drive_line.h: DriveLine::Create()",
    "engine/plugins/plant/drive_line/drive_line_traits.cc": "drive_line.h: DriveLine::Traits()",
}
# Each command is an Add...() in app.h or in commands.h.
COMMANDS = re.compile(r"engine/(app|thesis/commands)/\w+_command\.cc")

root = pathlib.Path(__file__).resolve().parent.parent
faults = []
for layer, below in MAY_INCLUDE.items():
    folder = root / FOLDERS.get(layer, f"engine/{layer}")
    for path in sorted(folder.rglob("*.h")) + sorted(folder.rglob("*.cc")):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            match = re.match(r'\s*#include "([a-z0-9_]+)/', line)
            allowed = [layer, *below]
            if str(path.relative_to(root)).startswith(tuple(KNOW_THESIS)):
                allowed += ["thesis", *COMMANDS_MAY_INCLUDE]
            if match and match[1] in MAY_INCLUDE and match[1] not in allowed:
                faults.append(f"{path.relative_to(root)}:{number}: {layer} must not include {match[1]}")
for path in sorted((root / "engine").rglob("*.cc")) + sorted((root / "reports").rglob("*.cc")):
    name = str(path.relative_to(root))
    if not path.with_suffix(".h").exists() and name not in DECLARED_ELSEWHERE and not COMMANDS.fullmatch(name):
        faults.append(f"{name}: has no header of its name: give it one, or merge it")
for name in DECLARED_ELSEWHERE:
    if (root / name).with_suffix(".h").exists() or not (root / name).exists():
        faults.append(f"ci/check_layers.py: {name} is no exception any more")
print("\n".join(faults) if faults else f"layers: {len(MAY_INCLUDE)} hold")
sys.exit(1 if faults else 0)
