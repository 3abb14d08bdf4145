#!/usr/bin/env python3
"""Manual pages and bash completion, from what the program says of itself.

manual.py PROGRAM FOLDER     writes FOLDER/man1/dynoproof.1, a page for each command, and FOLDER/dynoproof"""
import pathlib
import re
import subprocess
import sys


def said(program, *words):
    return subprocess.run([program, *words], capture_output=True, text=True, check=True).stdout


class Command:
    """A command as its --help has it: a summary, lists ("Options:") of entries with their texts, examples."""

    def __init__(self, program, words=()):
        self.name, self.words = " ".join(["dynoproof", *words]), words
        self.lists, self.examples, head, entries = {}, [], [], None
        for line in said(program, *words, "--help").splitlines():
            if heading := re.match(r"(\w+):$", line):
                entries = self.lists.setdefault(heading[1], [])
            elif "Examples" in self.lists:
                self.examples += [line.strip()] if line.strip() else []
            elif entries is None:
                head.append(line)
            elif entry := re.match(r"  (\S.*?)(?:  +(.*))?$", line):
                entries.append([entry[1], entry[2] or ""])
            elif line.startswith(" "):  # the text of a long entry stands below it
                entries[-1][1] = " ".join([entries[-1][1], line.strip()]).strip()
        self.lists.pop("Examples", None)
        self.usage = "".join(next(line for line in head if line.startswith("Usage: ")).partition("[")[1:])
        self.summary = " ".join(line for line in head if line and not line.startswith("Usage: "))
        self.below = [Command(program, (*words, entry)) for entry, _ in self.lists.get("Subcommands", [])]

    def all(self):
        return [self, *[one for below in self.below for one in below.all()]]

    def options(self, valued=False):
        """--names; valued: of those that a value follows."""
        return [name for entry, _ in self.lists.get("Options", []) if " " in entry or not valued
                for name in re.findall(r"--[a-z-]+", entry.split(" ")[0])]

    def choices(self):
        """The words that an option or a positional takes, where its entry has them in braces."""
        return {entry.split(" ")[0]: found[1].split(",") for title in ("Options", "Positionals")
                for entry, _ in self.lists.get(title, []) if (found := re.search(r"\{([\w,]+)\}", entry))}


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text.startswith((".", "'")) else text


def page(command, version):
    title = command.name.replace(" ", "-")
    lines = [".\\\" Written by ci/manual.py from the program's own help.", f'.TH {title.upper()} 1 "" "{version}"', ".SH NAME",
             f"{roff(title)} \\- {roff(command.summary)}", ".SH SYNOPSIS", f".B {roff(command.name)}", roff(command.usage)]
    for heading, entries in command.lists.items():
        lines.append(f".SH {heading.upper()}")
        for entry, text in entries:
            lines += [".TP", f".B {roff(entry)}", roff(text)]
    if command.examples:
        lines += [".SH EXAMPLES", ".nf", *map(roff, command.examples), ".fi"]
    return "\n".join(lines) + "\n"


def completion(top):
    every = top.all()
    words = {" ".join(one.words): [below.words[-1] for below in one.below] + one.options() +
             [word for entry, values in one.choices().items() if not entry.startswith("-") for word in values] for one in every}
    taken = {entry: values for one in every for entry, values in one.choices().items() if entry.startswith("-")}
    files = {name for one in every for name in one.options(valued=True)} - set(taken)
    lines = ["# Bash completion of dynoproof, written by ci/manual.py from the program's own help.",
             "_dynoproof() {", '  local word=${COMP_WORDS[COMP_CWORD]} command= words=', "  COMPREPLY=()",
             "  case ${COMP_WORDS[COMP_CWORD-1]} in",
             *[f'    {option}) COMPREPLY=($(compgen -W "{" ".join(values)}" -- "$word")); return ;;' for option, values in sorted(taken.items())],
             f'    {"|".join(sorted(files))}) return ;;  # a value: a file, by the shell', "  esac",
             '  [ "$COMP_CWORD" -lt 2 ] || command=${COMP_WORDS[1]}', "  case $command in",
             f'    {"|".join(one.words[0] for one in top.below if one.below)}) [ "$COMP_CWORD" -lt 3 ] || command+=" ${{COMP_WORDS[2]}}" ;;',
             "  esac", '  case "$command" in',
             *[f'    "{name}") words="{" ".join(known)}" ;;' for name, known in words.items()], "  esac",
             '  COMPREPLY=($(compgen -W "$words" -- "$word"))', "}", "complete -o default -F _dynoproof dynoproof"]
    return "\n".join(lines) + "\n"


def main(program, folder):
    top, folder = Command(program), pathlib.Path(folder)
    (folder / "man1").mkdir(parents=True, exist_ok=True)
    version = said(program, "--version").split(" (")[0]
    for one in top.all():
        (folder / "man1" / (one.name.replace(" ", "-") + ".1")).write_text(page(one, version))
    (folder / "dynoproof").write_text(completion(top))


if len(sys.argv) != 3:
    sys.exit(__doc__)
main(*sys.argv[1:])
