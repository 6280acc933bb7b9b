#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every block of commands of three pages of the guide names who runs it, and is run or excused.

The first line of a fenced sh block, which a reader sees:
    # user               an ordinary user; sudo in front of a command makes it root's
    # root               root
    # user, terminal 2   a terminal of its own: Ctrl-C ends what still runs there
    # user, on the PC    where, if not on the guarded machine
The line above its fence, which a reader does not see:
    <!-- ctest: run exit=3 -->    readme_commands.py runs it on this machine, and the guest too
    <!-- guest: run OPTIONS -->   the guest runs it (tests/can_vm/pages.py). Options:
        exit=0,14                 the exit codes of its last command [default: 0]
        prints="OK    system"     what it prints, with any of its exit codes
        until="ready"             it goes on in its terminal after these words, or a second (now)
        after="1 prints ready"    it begins when terminal 1 has printed this
        then="2 ends with 10"     afterwards the command in terminal 2 ends so, or prints words
    <!-- guest: left out: WHY --> nobody runs it
A fenced text block right after it (one blank line between) must be in what it printed.
"""
import dataclasses
import pathlib
import re
import shlex
import sys

from readme_commands import MARK, text_block
from sources import finish

PAGES = ("docs/guide/live.md", "docs/guide/bring-up.md", "docs/guide/every-day.md")
GUEST_MARK = re.compile(r"\s*<!-- guest: (run(?P<options> .*)?|left out: (?P<why>.+)) -->\s*$")
WHO = re.compile(r"# (?P<user>user|root)(, terminal (?P<terminal>\d))?(, on the (PC|Jetson))?$")
OPTIONS = {"exit", "prints", "until", "after", "then"}


@dataclasses.dataclass
class Block:
    place: str  # page and line
    user: str
    commands: str
    terminal: str = ""
    exit_codes: tuple = (0,)
    prints: str = ""
    until: str = ""
    after: str = ""
    then: str = ""
    left_out: str = ""  # why
    output: str = ""


def options_of(mark):
    """Of a mark that runs; raises ValueError where it has others."""
    if match := MARK.match(mark):
        if "data" in match.group("options").split():
            raise ValueError("the guest has no shared data")
        words = shlex.split(match.group("options"))
    elif match := GUEST_MARK.match(mark):
        if match.group("why"):
            return {"left_out": match.group("why")}
        words = shlex.split(match.group("options") or "")
    else:
        raise ValueError("neither run nor left out: wanted a mark as tests/style/guide_blocks.py "
                         "describes it in the line above its fence")
    options = dict(word.partition("=")[::2] for word in words)
    if unknown := options.keys() - OPTIONS:
        raise ValueError(f"no such option: {', '.join(sorted(unknown))}")
    codes = tuple(int(code) for code in options.pop("exit", "0").split(","))
    return {"exit_codes": codes, **options}


def blocks_of(page, text):
    """Its blocks in order; faults as text where a block is neither run nor excused."""
    lines = text.split("\n")
    for index, line in enumerate(lines):
        if line.strip() != "```sh":
            if "<!-- guest:" in line and lines[index + 1:index + 2] != ["```sh"]:
                yield f"{page}:{index + 1}: a mark without a block: wanted ```sh on the next line"
            continue
        place, end = f"{page}:{index + 2}", lines.index("```", index)
        who = WHO.match(lines[index + 1])
        if who is None:
            yield f"{place}: the block names nobody: wanted # user or # root in its first line"
            continue
        try:
            options = options_of(lines[index - 1])
        except ValueError as error:
            yield f"{place}: {error}"
            continue
        yield Block(place, who.group("user"), "\n".join(lines[index + 1:end]) + "\n",
                    who.group("terminal") or "", output=text_block(lines, end + 2), **options)


def main():
    root = pathlib.Path(sys.argv[1])
    finish([fault for page in PAGES
            for fault in blocks_of(page, (root / page).read_text(encoding="utf-8"))
            if isinstance(fault, str)])


if __name__ == "__main__":
    main()
