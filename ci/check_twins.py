#!/usr/bin/env python3
"""Two constants, classes or functions of one name in two sources of a layer are mostly one thing that stands twice: give it a place
that both include. Fails on each. Functions of one name with other parameters are apart. check_twins.py [ROOT]"""
import collections
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parent.parent)
APART = root / "engine/plugins/plant"
NAMESPACE = re.compile(r"namespace ([\w:]+) \{")
CLASS = re.compile(r"(?:struct|class|enum(?: class)?) (\w+)(?: final)?(?: :.*)? \{")
DECLARED = re.compile(r"(?:struct|class|enum(?: class)?|using) (\w+)\b")
CONSTANT = re.compile(r"(?:const|constexpr|constinit|static|thread_local) .*")
NAMES = re.compile(r"\b(k[A-Z]\w*)\b(?=(?:\[[^\]]*\])? = |\{)")
FUNCTION = re.compile(r"(?!using |namespace |static_assert|return )[\w:<>,*&\[\] ]*?[\w>*&] \*?&?(\w+)\(")


def parameters(text):
    """What tells overloads apart: the types of a declaration's parameters, without names and default values."""
    depth, types = 0, [""]
    for letter in text:
        depth += (letter in "(<[{") - (letter in ")>]}")
        if depth < 0:
            break
        if letter == "," and depth == 0:
            types.append("")
        else:
            types[-1] += letter
    return tuple(re.sub(r"\s+", "", re.sub(r"\s*\b\w+(\[\w*\])?\s*(=.*)?$", "", one.strip()) or one) for one in types)


def classes(text):
    """(namespace, name) of the classes that a header declares."""
    namespace = ""
    for line in text.splitlines():
        if match := NAMESPACE.fullmatch(line):
            namespace = match[1]
        elif match := DECLARED.match(line):
            yield namespace, match[1]


def helpers(text):
    """(namespace, name, parameters) of all that stands in a source's unnamed namespace, one for each declaration."""
    namespace, unnamed, lines = "", False, text.splitlines()
    for number, line in enumerate(lines):
        if match := NAMESPACE.fullmatch(line):
            namespace = match[1]
        elif line.startswith("namespace {"):
            unnamed = True
        elif line.startswith("}  // namespace") and line.strip() == "}  // namespace":
            unnamed = False
        elif unnamed and line[:1] not in (" ", "}", "/", "#", ""):
            code = line.split("//")[0]
            if match := CLASS.match(code):
                yield namespace, match[1], None
            elif CONSTANT.match(code) and "(" not in code.split("=")[0]:
                for name in NAMES.findall(code):
                    yield namespace, name, None
            elif match := FUNCTION.match(code):
                yield namespace, match[1], parameters(" ".join(lines[number:number + 6])[match.end():])


faults, seen = [], 0
folders = [path for path in sorted((root / "engine").iterdir()) if path.is_dir()] + [root / "reports"]
declared = {one: path for folder in folders for path in sorted(folder.rglob("*.h")) for one in classes(path.read_text())}
for folder in folders:
    places = collections.defaultdict(set)
    for path in sorted(folder.rglob("*.cc")):
        if APART in path.parents:
            continue
        for one in helpers(path.read_text()):
            places[one].add(str(path.relative_to(root)))
            seen += 1
            if one[:2] in declared:
                faults.append(f"{path.relative_to(root)}: has a {one[1]} beside that of {declared[one[:2]].relative_to(root)}")
    faults += [f"{' and '.join(sorted(files))}: both have a {name} in {namespace}"
               for (namespace, name, _), files in sorted(places.items(), key=str) if len(files) > 1]
if seen == 0:
    sys.exit("twins: nothing found: does this script still know how a source looks?")
print("\n".join(faults) if faults else f"twins: {seen} helpers, no two of a layer with one name")
sys.exit(1 if faults else 0)
