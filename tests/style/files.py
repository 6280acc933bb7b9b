#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What every file of code looks like from outside: licence, name, length, no path of a machine."""
import pathlib
import re
import sys

from sources import is_code, finish, read_text, tracked_files

LICENCE = "SPDX-License-Identifier: Apache-2.0"
# What links LinuxCNC's HAL is a program of its own under HAL's licence.
HAL = re.compile(r"firmware_if/linuxcnc/axguard_\w+\.[ch]$")
HAL_LICENCE = "SPDX-License-Identifier: GPL-2.0-or-later"
LINE_COLUMNS_MAX = 100
FILE_LINES_MAX = 600
NAME = re.compile(r"[a-z0-9_]+(-[a-z0-9_]+)*(\.[a-z0-9_]+)*$")
# A command that installs from PyPI, its continued lines included.
PIP_INSTALL = re.compile(r"\bpip3?\s+install\b(?:\\\n|[^\n])*")
NAMES_OF_TOOLS = {"CMakeLists.txt", "CMakePresets.json", "README.md", "LICENSE"}
# Folders that exist on one machine only. Written so that this file does not name them itself.
MACHINE_PATH = re.compile(r"(?<![\w.~$}\-])/(?:wor[k]|hom[e]|roo[t])/")


def faults_in(name, text):
    lines = text.split("\n")
    if is_code(name):
        head = lines[:3] if lines[0].startswith("#") else lines[:1]
        licence = HAL_LICENCE if HAL.match(name) else LICENCE
        if not any(licence in line for line in head):
            yield f"{name}:1: wanted '{licence}' as the first line (after #!)"
        if len(lines) > FILE_LINES_MAX:
            yield f"{name}: {len(lines)} lines, wanted at most {FILE_LINES_MAX}: one idea a file"
        for number, line in enumerate(lines, 1):
            if len(line) > LINE_COLUMNS_MAX:
                yield f"{name}:{number}: {len(line)} columns, wanted at most {LINE_COLUMNS_MAX}"
            if line.rstrip() != line:
                yield f"{name}:{number}: blanks at the end of the line"
    for match in PIP_INSTALL.finditer(text) if lines[0].endswith("sh") else ():
        if "--require-hashes" not in match.group():
            number = text.count("\n", 0, match.start()) + 1
            yield f"{name}:{number}: pip install without --require-hashes: anybody's file would do"
    for number, line in enumerate(lines, 1):
        match = MACHINE_PATH.search(line)
        if match:
            yield f"{name}:{number}: {match.group()} is a folder of one machine"


def name_fault(name):
    path = pathlib.PurePath(name)
    if not is_code(name) or path.name in NAMES_OF_TOOLS:
        return None
    # Files of CMake and CI are named as those tools and people name them, with a hyphen.
    if not NAME.match(path.name) or ("-" in path.name and path.suffix not in {".cmake", ".sh"}):
        return f"{name}: wanted a snake_case name"
    return None


def main():
    root = pathlib.Path(sys.argv[1])
    faults = []
    for name in tracked_files(root):
        fault = name_fault(name)
        faults += [fault] if fault else []
        data = (root / name).read_bytes()
        if b"\0" not in data[:8192] and pathlib.PurePath(name).suffix != ".stl":
            faults += faults_in(name, read_text(root, name))
    finish(faults)


if __name__ == "__main__":
    main()
