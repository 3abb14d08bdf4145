#!/usr/bin/env python3
"""What of chapter 5 comes out with the induction machine, by the bandwidth of its current control: the table in engine/thesis/README.md.

machine_bandwidth.py PROGRAM [--write]     runs the campaigns machine_bandwidth and machine_bandwidth_runs (a minute) and prints
the table; --write puts it there. Ends with 1 where the page says otherwise."""
import csv
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "ci"))
import block  # noqa: E402

PAGE = "engine/thesis/README.md"
HEAD = ["| current control | bus | both grow at k_V = 9.7 | with two filters | algorithm: filters, T_shaft left | Exp. I: k_V = 1 / 4.5 / with two filters | Exp. II: k_V = 4.3 / with two filters | Exp. III: k_V = 2.1 / with one filter |",
        "|---|---|---|---|---|---|---|---|"]


def rows(program, campaign):
    with tempfile.TemporaryDirectory() as folder:
        asked = subprocess.run([program, "sweep", f"bench/campaigns/{campaign}.toml", "--out", folder], cwd=ROOT, capture_output=True, text=True)
        if asked.returncode != 0:
            sys.exit(asked.stdout + asked.stderr)
        with open(pathlib.Path(folder, campaign, "table.csv"), newline="") as table:
            return list(csv.DictReader(table))


def main(program, *options):
    runs = {}
    for row in rows(program, "machine_bandwidth_runs"):
        bandwidth, loaded = float(row["control.machine.current_bandwidth_Hz"]), float(row["input.T_load.source.start_time_s"]) < 3.0
        if not loaded:
            runs[bandwidth] = f"{float(row['placements']):.0f}, {float(row['T_rms']):.0f} N m"
        elif float(row["after_load"]) > 0.0:
            sys.exit(f"at {bandwidth:g} Hz the load is taken for a resonance, which the page denies")
    text = list(HEAD)
    for row in rows(program, "machine_bandwidth"):
        value = {key: f"{float(row[key]):.1f}" for key in row if key not in ("verdict", "why", "run", "seed")}
        bandwidth, bus = float(row["current_bandwidth_Hz"]), float(row["delay_samples"]) > 0.0
        text.append(f"| {bandwidth:.0f} Hz | {'a period' if bus else 'none'} | {value['first']}, {value['second']} | {value['held']} "
                    f"| {'' if bus else runs[bandwidth]} | {value['quiet_1']} / {value['loud_1']} / {value['held_1']} "
                    f"| {value['loud_2']} / {value['held_2']} | {value['edge_3']} / {value['held_3']} |")
    print("\n".join(text))
    if "--write" in options:
        block.write(PAGE, "bandwidth", text)
    elif block.read(PAGE, "bandwidth") != text:
        sys.exit(f"{PAGE} says otherwise: bench/machine_bandwidth.py PROGRAM --write")


if len(sys.argv) < 2:
    sys.exit(__doc__)
main(*sys.argv[1:])
