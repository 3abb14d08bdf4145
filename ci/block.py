"""A part of a page that a script writes: the lines between `<!-- NAME: written by SCRIPT -->` and `<!-- end of NAME -->`."""
import pathlib

ROOT = pathlib.Path(__file__).resolve().parent.parent


class Missing(Exception):
    pass


def _found(page, name):
    lines = (ROOT / page).read_text().splitlines()
    begin = [i for i, line in enumerate(lines) if line.startswith(f"<!-- {name}: written by ")]
    end = [i for i, line in enumerate(lines) if line == f"<!-- end of {name} -->"]
    if len(begin) != 1 or len(end) != 1 or end[0] < begin[0]:
        raise Missing(f"{page} has not the two lines between which \"{name}\" stands")
    return lines, begin[0] + 1, end[0]


def read(page, name):
    lines, begin, end = _found(page, name)
    return lines[begin:end]


def write(page, name, text):
    lines, begin, end = _found(page, name)
    (ROOT / page).write_text("\n".join(lines[:begin] + text + lines[end:]) + "\n")


def write_all(blocks):
    """Writes each of several (page, name, text)."""
    for page, name, text in blocks:
        write(page, name, text)


def differing(blocks, script):
    """A sentence about the pages that say otherwise than their script would; None where none does."""
    pages = sorted({page for page, name, text in blocks if read(page, name) != text})
    return f"{', '.join(pages)} says otherwise: {script} --write" if pages else None
