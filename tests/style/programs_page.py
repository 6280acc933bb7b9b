#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""docs/reference/commands.md names every command and option of this build's axguard and
axguard-lab, and no other."""
import pathlib
import re
import subprocess
import sys

from sources import finish

OPTION = re.compile(r"--[a-z][a-z-]*")
IN_COMMON = {"--help", "--version"}


def options_of_program(program, command):
    text = subprocess.run([program, command, "--help"], text=True, capture_output=True,
                          check=True).stdout
    # An option's own line begins with it; later mentions are prose or the example.
    lines = [line for line in text.split("\n") if re.match(r"\s+-", line)]
    heads = [re.match(r"\s+((?:-\w,)?--[a-z-]+)", line) for line in lines]
    return {OPTION.search(head.group(1)).group() for head in heads if head} - IN_COMMON


def options_of_page(section):
    rows = [line for line in section.split("\n") if line.startswith("| `-")]
    return {option for row in rows for option in OPTION.findall(row.split(" | ")[0])}


def main():
    root, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    page = (root / "docs/reference/commands.md").read_text(encoding="utf-8")
    sections = dict(re.findall(r"^## ((?:axguard-lab )?[a-z]+)\n(.*?)(?=^## |\Z)", page,
                               re.S | re.M))
    commands = {}  # title of the section: program and command
    for program in ("axguard", "axguard-lab"):
        text = subprocess.run([build / program, "--help"], text=True, capture_output=True,
                              check=True).stdout
        named = re.findall(r"^  ([a-z]+)\s", text, re.M)
        if not named:
            finish([f"{program} --help names no command"])
        for name in named:
            title = f"{program} {name}" if name in commands else name
            commands[title] = (program, name)
    faults = [f"docs/reference/commands.md: no section on {name}" for name in commands
              if name not in sections]
    faults += [f"docs/reference/commands.md: {name} is no command" for name in sections
               if name not in commands]
    for name in set(commands) & set(sections):
        program_name, command = commands[name]
        program = options_of_program(build / program_name, command)
        stated = options_of_page(sections[name])
        faults += [f"docs/reference/commands.md: {name}: {option} is missing"
                   for option in sorted(program - stated)]
        faults += [f"docs/reference/commands.md: {name}: {option} is no option"
                   for option in sorted(stated - program)]
    finish(faults)


if __name__ == "__main__":
    main()
