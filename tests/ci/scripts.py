"""What the tests of ci/*.py share: small results of `dynoproof run --json`, and calling a script."""
import json
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent


def check(name, value, limit, verdict="pass", kind="oracle", limit_is="at_most"):
    return {"name": name, "kind": kind, "verdict": verdict, "value": value, "limit": limit,
            "limit_is": limit_is, "unit": "1", "origin": "made up", "explanation": ""}


def run_of(*checks, scenario="a/b"):
    return {"exit": 0, "scenarios": [{"id": scenario, "title": "", "verdict": "pass", "trace": "", "figures": {},
                                      "checks": list(checks)}]}


def call(script, *documents, arguments=()):
    """Exit code, stdout and stderr of a script that is given each document (dict: as JSON, str: as it is) as a file."""
    with tempfile.TemporaryDirectory() as folder:
        names = []
        for index, document in enumerate(documents):
            names.append(f"{folder}/{index}.json")
            text = document if isinstance(document, str) else json.dumps(document)
            pathlib.Path(names[-1]).write_text(text)
        done = subprocess.run([str(ROOT / script), *names, *arguments], capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout, done.stderr
