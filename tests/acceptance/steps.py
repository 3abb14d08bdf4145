"""What the tests of a newcomer's steps share: the program in a folder of its own, and the examples of a page."""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]


def section(page, heading):
    """What stands below a heading of a page, up to the next one of the second level."""
    return re.search(rf"^#+ {re.escape(heading)}\n(.*?)(?=^## |\Z)", (ROOT / page).read_text(), re.M | re.S)[1]


def blocks(page, language, heading=""):
    """The fenced blocks of a page in a language, below a heading if one is named."""
    text = section(page, heading) if heading else (ROOT / page).read_text()
    return re.findall(rf"```{language}\n(.*?)```", text, re.S)


def commands(script):
    """The lines of a shell block with the exit code that each states, "# exit 1", else 0."""
    for line in script.splitlines():
        command, _, comment = line.partition(" # ")
        stated = re.match(r"exit (\d)", comment.strip())
        if command.strip():
            yield command.strip(), int(stated[1]) if stated else 0


class Steps(unittest.TestCase):
    program = ""  # set by the test's main part

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name).resolve()
        # As on the pages: build/dynoproof, and `dynoproof` on the path. Nothing of the caller's own settings.
        (self.folder / "build").symlink_to(pathlib.Path(self.program).parent)
        known = {key: os.environ[key] for key in ("HOME", "LANG") if key in os.environ}
        self.environment = {**known, "PATH": f"{pathlib.Path(self.program).parent}:{os.environ['PATH']}",
                            "GIT_CONFIG_GLOBAL": "/dev/null", "GIT_AUTHOR_NAME": "t", "GIT_AUTHOR_EMAIL": "t@example.com",
                            "GIT_COMMITTER_NAME": "t", "GIT_COMMITTER_EMAIL": "t@example.com"}

    def shell(self, command, folder=None, exit=0, **variables):
        """`exit`: the code that it has to end with; None: any that is an answer."""
        done = subprocess.run(["bash", "-eo", "pipefail", "-c", command], cwd=folder or self.folder, capture_output=True,
                              text=True, timeout=900, env={**self.environment, **variables})
        self.assertIn(done.returncode, (0, 1, 2, 4, 5) if exit is None else (exit,), f"{command}\n{done.stdout}\n{done.stderr}")
        return done

    def document(self, command, exit=0):
        return json.loads(self.shell(f"{command} --json -", exit=exit).stdout)

    def script(self, text):
        """Runs the commands of a block one by one; `cd` holds for those that follow."""
        folder, said = self.folder, ""
        for command, exit in commands(text):
            if command.startswith("cd "):
                folder = folder / command[3:]
                continue
            done = self.shell(command, folder, exit)
            said += done.stdout + done.stderr
        return said
