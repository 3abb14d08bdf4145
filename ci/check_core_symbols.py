#!/usr/bin/env python3
"""The 10 kHz core may call the C mathematical functions and the memory functions that a compiler itself puts in for
copies; nothing that could allocate, lock, throw or enter the system. Asks the linker's view of the library."""
import re
import subprocess
import sys

ALLOWED = {"cos", "sin", "tan", "sqrt", "exp", "log", "memcpy", "memset", "memmove", "sincos",
           "_GLOBAL_OFFSET_TABLE_", "__stack_chk_fail"}
listing = subprocess.run(["nm", "-C", sys.argv[1]], check=True, capture_output=True, text=True).stdout
defined = set(re.findall(r"^[0-9a-f]+ [A-TV-Zu] (.*)$", listing, re.M))
wanted = set(re.findall(r"^ +[Uw] (.*)$", listing, re.M)) - defined
foreign = sorted(name for name in wanted if name not in ALLOWED and not name.startswith("control10k::"))
if not defined:
    foreign.append("(the library is empty)")
print("\n".join(foreign) if foreign else f"core: {len(defined)} symbols, needs only {', '.join(sorted(wanted & ALLOWED))}")
sys.exit(1 if foreign else 0)
