#!/usr/bin/env python3
"""Puts the propagator and its peers side by side in one run, on r2r/soft_rotor_setup_1: a 10 s chirp held at 10 kHz.

usage: bench/peers.py [BUILD_FOLDER]      SciPy and Octave take part where they are installed.
"""
import json
import pathlib
import shutil
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent
build = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else root / "build")
rows = []
# The best of several repetitions: what disturbs on a shared machine only ever adds.
for program, repetitions in (("propagator_bench", 7), ("solver_bench", 1)):
    path = build / "bench" / program
    if not path.exists():
        sys.exit(f"{path} is missing: build first (ci/test.sh)")
    out = subprocess.run([path, "--benchmark_format=json", "--benchmark_min_time=0.3",
                          f"--benchmark_repetitions={repetitions}"], capture_output=True, text=True, check=True)
    found = {}
    for one in json.loads(out.stdout)["benchmarks"]:
        if "per_step" in one and one["run_type"] == "iteration":
            row = (one["name"] + (" " + one["label"] if one.get("label") else ""), 1e9 * one["per_step"], one["error"], one.get("GHz"))
            found[row[0]] = min(row, found.get(row[0], row), key=lambda r: r[1])
    rows += found.values()
pythons = [p for p in (sys.executable, "/usr/bin/python3") if subprocess.run([p, "-c", "import scipy"], capture_output=True).returncode == 0]
for command, script in ((pythons[0] if pythons else "python3 with SciPy", "lsim.py"), ("octave-cli", "lsim.m")):
    if shutil.which(command) is None:
        print(f"{script}: {command} is not installed, left out", file=sys.stderr)
        continue
    out = subprocess.run([command, root / "bench" / "peers" / script], capture_output=True, text=True)
    if out.returncode != 0:
        print(f"{script}: left out: {out.stderr.strip().splitlines()[-1] if out.stderr.strip() else 'failed'}", file=sys.stderr)
        continue
    one = json.loads(out.stdout.strip().splitlines()[-1])
    rows.append((one["name"], one["per_step_ns"], one["error"], None))
best = min(time for name, time, *_ in rows if name.startswith("Modal/pairs:71"))
print(f"{'method':<52} {'ns a step':>12} {'cycles':>10} {'error':>10} {'times the best with all modes':>30}")
for name, time, error, GHz in sorted(rows, key=lambda row: row[1]):
    cycles = f"{time * GHz:.0f}" if GHz else ""
    print(f"{name:<52} {time:>12.1f} {cycles:>10} {error:>10.1e} {time / best:>30.1f}")
