#!/usr/bin/env python3
"""What `dynoproof reduce` leaves of failing scenarios, and whether that still fails for the same fault: of the seeded faults in the
program (tests/mutants) beside the sound program, and of faults drawn at random in a scenario.

  ci/reductions.py build/dynoproof --mutants build/tests/mutants [NAME ...]    the seeded faults
  ci/reductions.py build/dynoproof --random 40 [--first 0]                     faults drawn from seeds 0, 1, ... until 40 fail a check
  ci/reductions.py --write                   tables in engine/reduce/README.md, a summary in README.md; `--check`: 1 where they are others

Figures are kept in engine/reduce/reductions.json, as they come; what is there is not done again. The fault is the same one where what
is left fails the same check, and passes it without the fault: with the sound program, or with the old value, or without the effect."""
import argparse
import json
import math
import os
import pathlib
import random
import re
import statistics
import subprocess
import sys
import tempfile
import tomllib

import block

ROOT = pathlib.Path(__file__).resolve().parent.parent
RESULTS = ROOT / "engine/reduce/reductions.json"
PAGE = "engine/reduce/README.md"
# What a golden trace holds and a run of which takes a second or so: a hundred of them are affordable.
CHEAP = [
    "backlash/clamped", "heavy_duty/straight_chain_setup_1", "heavy_duty/straight_chain_setup_2",
    "heavy_duty/straight_chain_setup_3", "heavy_duty/alternative_setup_1", "heavy_duty/alternative_setup_2",
    "heavy_duty/alternative_setup_3", "r2r/soft_rotor_setup_1", "heavy_duty/soft_rotor_setup_1",
    "pressure/fuel_gas_legacy", "pressure/fuel_gas_proposed", "pressure/charge_air_legacy", "pressure/charge_air_proposed",
    "suppression/r2r_experiment_1", "suppression/adaptive", "suppression/unsuppressed", "coupling/driven_oil",
]


def call(words):
    """Runs a program over this tree's scenarios, wherever it lies itself."""
    environment = {**os.environ, "DYNOPROOF_SCENARIOS": str(ROOT / "scenarios"), "DYNOPROOF_GOLDEN": str(ROOT / "golden")}
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True, env=environment)


def plain(name):
    """A check's name without its numbers, which move along with what is left."""
    return re.sub(r"[0-9][0-9.]*", "#", name)


def fails(program, file, check, folder, *more):
    """Whether a run fails the check; None where it says nothing of it."""
    document = folder / "run.json"
    document.unlink(missing_ok=True)
    call([program, "run", str(file), "--out", str(folder / "out"), "--json", str(document), *more])
    if not document.exists():
        return None
    scenarios = json.loads(document.read_text()).get("scenarios", [])
    if len(scenarios) != 1:
        return None
    if check == "run":
        return scenarios[0]["verdict"] == "broken"
    of = [one["verdict"] != "pass" for one in scenarios[0].get("checks", []) if plain(one["name"]) == plain(check)]
    return any(of) if of else None


def reduced(program, scenario, settings, check, sound, folder):
    """The document of a reduction and the file that it left; None and why not."""
    small, document = folder / "small.toml", folder / "reduce.json"
    words = [program, "reduce", scenario, "--out", str(small), "--json", str(document)]
    if check:
        words += ["--check", check]
    if sound:
        words += ["--sound", sound]
    for one in settings:
        words += ["--set", one]
    done = call(words)
    return (json.loads(document.read_text()), small) if done.returncode == 0 else (None, done.stderr.strip())


def figures(document, small, same, what, scenario):
    return {"what": what, "scenario": scenario, "check": document["check"], "lines": document["lines"], "values": document["values"],
            "seconds": document["seconds"], "runs": document["runs"], "same": same, "left": small.read_text().split("\n", 1)[1]}


def of_seeded(program, mutants, one):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        faulty = str(mutants / f"mutant_{one['name']}")
        document, small = reduced(faulty, one["scenario"], one.get("set", []), one["check"], program, folder)
        if document is None:
            return {"what": one["what"], "scenario": one["scenario"], "fault": small}
        same = fails(faulty, small, document["check"], folder) is True and fails(program, small, document["check"], folder) is False
        return figures(document, small, same, one["what"], one["scenario"])


def numbers(values):
    """Numbers of the model: path and value."""
    for line in values:
        path, text = line.split(" = ", 1)
        if path.startswith(("plant.", "control.", "part.")) and re.fullmatch(r"-?[0-9.e+-]+", text) and float(text) != 0.0:
            yield path, text


def drawn(program, seed):
    """A scenario, what goes to --set, what takes it back from what is left of it, in several ways, and words for it."""
    draw = random.Random(seed)
    scenario = draw.choice(CHEAP)
    said = json.loads(call([program, "describe", scenario, "--json", "-"]).stdout)["scenarios"][0]
    if draw.random() < 0.5:
        path, text = draw.choice(sorted(numbers(said["values"])))
        kind = draw.random()
        share = draw.choice([-1, 1]) * 10 ** draw.uniform(-2.5, -0.3)
        new = 0.0 if kind < 0.1 else -float(text) if kind < 0.2 else float(text) * (1 + share)
        if re.fullmatch(r"-?[0-9]+", text):
            new = int(text) + draw.choice([-1, 1])

        def back(left):
            """The old value, in two digits, or, of a body that others have become one with, what it has lost."""
            now = left
            for key in path.split("."):
                now = now.get(key) if isinstance(now, dict) else None
            joint = [f"{path}={now + float(text) - new!r}"] if isinstance(now, (int, float)) else []
            return [f"{path}={text}", f"{path}={float(f'{float(text):.1e}')!r}", *joint]

        return scenario, [f"{path}={new!r}"], back, f"`{path}` {new:.4g} for {float(text):.4g}"
    effect, place = draw.choice([(effect, place) for effect, places in sorted(said["places"].items()) for place in sorted(places)])
    about = json.loads(call([program, "describe", effect, "--json", "-"]).stdout)["effects"][0]
    sizes = {}
    for one in about["parameters"]:
        size = one["start"] * 10 ** draw.uniform(-0.5, 0.7)
        whole = float(one["start"]).is_integer() and abs(one["start"]) >= 1.0 and one["unit"] == "1"
        sizes[one["name"]] = one["start"] if whole else min(max(float(f"{size:.3g}"), one["lower"]), one["upper"])
    inline = ", ".join(f"{name} = {value!r}" for name, value in sizes.items())
    text = f'effect=[{{ name = "{effect}", at = "{place}", parameters = {{ {inline} }} }}]'
    return scenario, [text], lambda left: ["effect=[]"], f"`{effect}` at {place}: {', '.join(f'{n} {v:.3g}' for n, v in sizes.items())}"


def of_random(program, seed):
    """The figures of a seed; None where its fault fails no check, or cannot be built."""
    scenario, settings, back, what = drawn(program, seed)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        document, small = reduced(program, scenario, settings, "", "", folder)
        if document is None:
            return None
        verdicts = [fails(program, small, document["check"], folder, "--set", one) for one in back(tomllib.loads(small.read_text()))]
        same = fails(program, small, document["check"], folder) is True and False in verdicts
        return figures(document, small, same, what, scenario)


def share(of):
    return of["after"] / of["before"] if of["before"] else math.nan


def summary(rows, goal):
    done = [one for one in rows if "lines" in one]
    of = lambda key: 100 * statistics.median(share(one[key]) for one in done)
    return (f"{goal} {len(done)} of {len(rows)} were reduced: median {of('lines'):.0f} % of the lines, {of('values'):.0f} % of the values and "
            f"{of('seconds'):.2g} % of the simulated time; {max(one['runs'] for one in done)} runs at most; the same fault in "
            f"{sum(one['same'] for one in done)}.")


def table(rows):
    lines = ["| fault | scenario | check | lines | values | s | runs | same fault |", "|---|---|---|---|---|---|---|---|"]
    for one in rows:
        if "lines" not in one:
            lines.append(f"| {one['what']} | `{one['scenario']}` | not reduced: {one['fault'].splitlines()[0]} | | | | | |")
            continue
        pair = lambda of: f"{of['after']:.3g} of {of['before']:.3g}"
        lines.append(f"| {one['what']} | `{one['scenario']}` | {one['check']} | {pair(one['lines'])} | {pair(one['values'])} | "
                     f"{pair(one['seconds'])} | {one['runs']} | {'yes' if one['same'] else 'no'} |")
    return lines


def rows_of(kept):
    at_random = [one for _, one in sorted(kept["random"].items(), key=lambda item: int(item[0])) if one is not None]
    return list(kept["seeded"].values()), at_random


def summaries(kept):
    seeded, at_random = rows_of(kept)
    return ([summary(seeded, "- Of seeded faults in the program")] if seeded else []) + (
        [summary(at_random, "- Of faults drawn at random in a scenario"), summary(seeded + at_random, "- Of all together")] if at_random else [])


def page(kept):
    seeded, at_random = rows_of(kept)
    text = ["\n".join(summaries(kept)), "", *table(seeded)]
    if at_random:
        text += ["", f"Drawn at random; another {len(kept['random']) - len(at_random)} fail no check, or are refused:", "", *table(at_random)]
    return "\n".join(text).split("\n")


def results():
    return json.loads(RESULTS.read_text()) if RESULTS.exists() else {"seeded": {}, "random": {}}


def keep(kind, key, one):
    """Both kinds may be under way at once: what the other has kept stays."""
    kept = results()
    kept[kind][key] = one
    RESULTS.write_text(json.dumps(kept, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", nargs="?")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--mutants", type=pathlib.Path)
    parser.add_argument("--random", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    kept = results()
    if options.write or options.check:
        blocks = [(PAGE, "reductions", page(kept)), ("README.md", "reduced", summaries(kept))]
        return block.write_all(blocks) if options.write else block.differing(blocks, "ci/reductions.py")
    if not options.program:
        parser.error("a program is needed")
    program = str(pathlib.Path(options.program).resolve())
    if options.mutants:
        for one in tomllib.loads((ROOT / "tests/mutants/mutants.toml").read_text())["mutant"]:
            if one["name"] in (options.names or [one["name"]]) and (options.names or one["name"] not in kept["seeded"]):
                kept["seeded"][one["name"]] = of_seeded(program, options.mutants.resolve(), one)
                said = kept["seeded"][one["name"]]
                print(one["name"], {key: said.get(key) for key in ("lines", "values", "seconds", "runs", "same", "fault")}, flush=True)
                keep("seeded", one["name"], said)
    seed = options.first
    while sum(one is not None for one in kept["random"].values()) < options.random:
        if str(seed) not in kept["random"]:
            kept["random"][str(seed)] = one = of_random(program, seed)
            print(seed, "fails no check" if one is None else {key: one[key] for key in ("what", "lines", "seconds", "runs", "same")}, flush=True)
            keep("random", str(seed), one)
        seed += 1
    return None


if __name__ == "__main__":
    sys.exit(main())
