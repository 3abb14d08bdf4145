#!/usr/bin/env python3
"""Manual pages and completion of every command, as ci/manual.py writes them. manual_test.py PROGRAM"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop()
SCRIPT = pathlib.Path(__file__).resolve().parents[2] / "ci/manual.py"


class Manual(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        subprocess.run([SCRIPT, PROGRAM, cls.folder], check=True)

    def completed(self, *words):
        """What bash proposes for the last of the words."""
        script = f"""source "{self.folder}/dynoproof"
            COMP_WORDS=({" ".join(f"'{word}'" for word in words)}); COMP_CWORD={len(words) - 1}; _dynoproof
            printf '%s\\n' "${{COMPREPLY[@]}}" """
        return set(subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True).stdout.split())

    def test_every_command_has_a_page(self):
        commands = self.completed("dynoproof", "") - {"--help", "--version"}
        self.assertGreater(len(commands), 15)
        pages = {path.name for path in (self.folder / "man1").iterdir()}
        self.assertLessEqual({f"dynoproof-{one}.1" for one in commands} | {"dynoproof.1", "dynoproof-history-add.1"}, pages)

    def test_a_page_says_what_the_help_says(self):
        text = (self.folder / "man1/dynoproof-run.1").read_text().replace("\\-", "-")
        for words in (".SH SYNOPSIS", "dynoproof run\n[OPTIONS] [scenarios...]", ".B --set TEXT", "folder of traces", ".SH EXAMPLES",
                      "instead of the scenario's own", "dynoproof run heavy_duty/ --jobs 2"):
            self.assertIn(words, text)

    @unittest.skipUnless(shutil.which("groff"), "groff is not installed")
    def test_the_pages_are_sound(self):
        for path in (self.folder / "man1").iterdir():
            done = subprocess.run(["groff", "-man", "-ww", "-z", path], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (0, ""), path.name)

    def test_completes_commands_options_and_words(self):
        self.assertEqual(self.completed("dynoproof", "che"), {"check-data"})
        self.assertEqual(self.completed("dynoproof", "history", "sh"), {"show"})
        self.assertEqual(self.completed("dynoproof", "run", "--sol"), {"--solver"})
        self.assertEqual(self.completed("dynoproof", "run", "--solver", "re"), {"realtime", "reference"})
        self.assertEqual(self.completed("dynoproof", "new", "la"), {"law"})
        self.assertEqual(self.completed("dynoproof", "bench", "--paced", "--real"), {"--realtime-priority"}, "no value follows --paced")
        self.assertEqual(self.completed("dynoproof", "run", "--data", "r"), set(), "files are the shell's")


unittest.main()
