#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The options of every command as the tables of docs/reference/commands.md, from --help.
    tests/tools/command_tables.py BUILD PAGE            prints the page with its tables made anew
    tests/tools/command_tables.py BUILD PAGE --write    writes it
"""
import collections
import dataclasses
import pathlib
import re
import subprocess
import sys

from made_parts import table, with_parts

PROGRAMS = ("axguard", "axguardd", "axguard-lab", "axguard-certcheck")
KINDS = {"TEXT": "text", "INT": "integer", "UINT": "integer", "FLOAT": "number"}
COMMANDS_TO_SHARE = 3  # an option of so many commands stands in the shared table
HELP_COLUMN = 30
SHARED = "options of several commands"


@dataclasses.dataclass(frozen=True)
class Option:
    name: str
    value: str
    meaning: str


def thousands(text):
    return re.sub(r"\b\d{5,}\b", lambda match: f"{int(match.group()):,}", text)


def value_of(kind):
    """`INT:INT in [1 - 20]`, `TEXT:{a,b}` or `TEXT` as a reader has it."""
    if allowed := re.match(r"\w+:\{(.+)\}", kind):
        return ", ".join(f"`{word}`" for word in allowed.group(1).split(","))
    if limits := re.match(r"\w+:\w+ in \[(\S+) - (\S+)\]", kind):
        low, high = limits.groups()
        return thousands(f"{low} to " + (str(int(float(high))) if "e" in high else high))
    return KINDS.get(kind, kind)


def option_of(head, meaning):
    match = re.match(r"(?P<name>\S+)(?: (?P<kind>[A-Z]+\S*(?: in \[.*?\])?))?"
                     r"(?P<rest>( \.\.\.| REQUIRED)*)$", head)
    if match is None:
        raise ValueError(f"no option: {head}")
    kind = match.group("kind") or ""
    name = match.group("name").replace("{-}", "[=FILE]")
    value = value_of(kind)
    if "REQUIRED" in match.group("rest"):
        value = f"{value}, required".removeprefix(", ")
    if "..." in match.group("rest"):
        value += ", repeatable"
    shown = ", ".join(f"`{part}`" for part in name.split(","))
    return Option(shown, value, thousands(meaning))


def options_of(text):
    """Of the help text of one command: its positionals, then its options."""
    lines = text.split("\n")
    for index, line in enumerate(lines):
        if not re.match(r"  \S", line) or lines[index - 1] in ("Example:", ""):
            continue
        if index + 1 < len(lines) and lines[index + 1].startswith(" " * HELP_COLUMN):
            head, meaning = line.strip(), lines[index + 1].strip()
        else:
            head, meaning = line[:HELP_COLUMN].strip(), line[HELP_COLUMN:].strip()
        if head not in ("-h,--help", "--version"):
            yield option_of(head, meaning)


def commands_of(build):
    """Example, purpose and options of each `PROGRAM COMMAND`."""
    commands = {}
    for program in PROGRAMS:
        def help_of(*words, path=build / program):
            return subprocess.run([path, *words, "--help"], text=True, capture_output=True,
                                  check=True).stdout
        top = help_of()
        has_commands = "SUBCOMMAND" in top
        for name in re.findall(r"^  ([a-z][a-z-]*)\s", top, re.M) if has_commands else [""]:
            text = help_of(name) if name else top
            example = re.match(r"Example:\n  (.+)\n", text).group(1)
            purpose = re.search(r"\n\n(.+)\nUsage:", text).group(1)
            commands[f"{program} {name}".rstrip()] = (example, purpose, list(options_of(text)))
    return commands


def parts_of(commands):
    users = collections.defaultdict(list)
    for name, (_, _, options) in commands.items():
        for option in options:
            users[option].append(name)
    shared = {option: names for option, names in users.items()
              if len(names) >= COMMANDS_TO_SHARE}
    made = {SHARED: table(["Option", "Value", "Meaning"],
                          [list(dataclasses.astuple(option)) for option in shared])}
    for name, (example, purpose, options) in commands.items():
        stop = "" if purpose.endswith("?") else "."
        text = f"{purpose}{stop}\n\n```sh\n{example}\n```\n\n"
        own = [list(dataclasses.astuple(option)) for option in options if option not in shared]
        if own:
            text += table(["Option", "Value", "Meaning"], own) + "\n\n"
        names = [option.name for option in options if option in shared]
        if names:
            text += wrapped(f"Also, [as several commands](#{SHARED.replace(' ', '-')}): " +
                            ", ".join(names) + ".")
        made[name] = text
    return made


def wrapped(text, columns=100):
    lines = [""]
    for word in text.split(" "):
        if lines[-1] and len(lines[-1]) + 1 + len(word) > columns:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return "\n".join(lines)


def main():
    build, page = (pathlib.Path(argument) for argument in sys.argv[1:3])
    text = with_parts(page.read_text(encoding="utf-8"), parts_of(commands_of(build)))
    if "--write" in sys.argv[3:]:
        page.write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
