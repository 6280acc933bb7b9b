#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The commands of the README and of three pages of the guide do what these pages say.

A fenced sh block runs when the line above its fence is a mark, invisible to a reader:
    <!-- ctest: run -->                  ends with 0
    <!-- ctest: run exit=10 -->          its last command ends with 10
    <!-- ctest: run data -->             needs the shared data; left out without it
A fenced text block right after it (one blank line between) must be in what it printed.
readme_example.py compares the README's prose with the example's machine and stop.
All marked blocks of a page run in order, in one scratch folder that shows the repository's files,
with this build's programs in PATH and as build/host-release/. Blocks that install or build are not
marked: the test of a fresh Debian runs those.
"""
import dataclasses
import os
import pathlib
import re
import subprocess
import sys
import tempfile

import readme_example
from sources import finish, read_text, skip

MARK = re.compile(r"\s*<!-- ctest: run(?P<options>( data| exit=\d+)*) -->\s*$")


PAGES = ("README.md", "docs/guide/first-machine.md", "docs/guide/bring-up.md",
         "docs/guide/every-day.md")


@dataclasses.dataclass
class Block:
    line: int
    commands: str
    exit_code: int
    needs_data: bool
    output: str
    page: str = PAGES[0]


def marked_blocks(text, page=PAGES[0]):
    lines = text.split("\n")
    for index, line in enumerate(lines):
        if "<!-- ctest:" not in line:
            continue
        mark = MARK.match(line)
        if mark is None or index + 1 >= len(lines) or lines[index + 1].strip() != "```sh":
            raise ValueError(f"{page}:{index + 1}: wanted a mark as tests/style/"
                             f"readme_commands.py describes it, and ```sh on the next line")
        options = mark.group("options")
        code = re.search(r"exit=(\d+)", options)
        end = index + 2
        while end < len(lines) and lines[end].strip() != "```":
            end += 1
        yield Block(index + 2, "\n".join(lines[index + 2:end]) + "\n",
                    int(code.group(1)) if code else 0, "data" in options.split(),
                    text_block(lines, end + 2), page)


def text_block(lines, start):
    """What stands in the fenced text block that begins there; nothing where there is none."""
    if lines[start - 1:start + 1] != ["", "```text"]:
        return ""
    return "\n".join(lines[start + 1:lines.index("```", start + 1)]) + "\n"


def run_block(block, folder, environment):
    """The fault, or None."""
    done = subprocess.run(["bash", "-euo", "pipefail", "-c", block.commands], cwd=folder,
                          env=environment, text=True, stdin=subprocess.DEVNULL,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode == block.exit_code:
        if block.output in done.stdout:
            return None
        return (f"{block.page}:{block.line}: the text block after it is not what it printed\n"
                f"--- printed:\n{done.stdout[-4000:]}")
    return (f"{block.page}:{block.line}: ended with {done.returncode}, wanted {block.exit_code}\n"
            f"{block.commands}--- printed:\n{done.stdout[-4000:]}")


def show_repository(root, build, shared, folder):
    """Links to every top-level entry, so that paths in the README hold and nothing is written."""
    repository = folder / "axguard"
    repository.mkdir()
    for entry in root.iterdir():
        if entry.name not in {"build", ".git"}:
            (repository / entry.name).symlink_to(entry)
    (repository / "build").mkdir()
    (repository / "build" / "host-release").symlink_to(build)
    if shared.is_dir():
        (folder / "shared").mkdir()
        (folder / "shared" / "data").symlink_to(shared)
    return repository


def run_page(blocks, places, environment):
    """Faults, and how many blocks were left out for want of the shared data."""
    faults, left_out = [], 0
    with tempfile.TemporaryDirectory() as name:
        folder = show_repository(*places, pathlib.Path(name))
        for block in blocks:
            if block.needs_data and not places[2].is_dir():
                left_out += 1
                continue
            fault = run_block(block, folder, environment)
            faults += [fault] if fault else []
        if blocks[0].page == PAGES[0] and not faults:
            faults += readme_example.faults_of(read_text(places[0], PAGES[0]), folder, environment)
    return faults, left_out


def main():
    places = [pathlib.Path(argument).resolve() for argument in sys.argv[1:4]]
    try:
        pages = [list(marked_blocks((places[0] / page).read_text(encoding="utf-8"), page))
                 for page in PAGES]
    except ValueError as error:
        finish([str(error)])
    if not all(pages):
        skip("a page has no block that is marked to run")
    environment = dict(os.environ, PATH=f"{places[1]}:{os.environ['PATH']}",
                       AXG_SHARED_DATA=str(places[2]))
    results = [run_page(blocks, places, environment) for blocks in pages]
    faults = [fault for found, _ in results for fault in found]
    left_out = sum(count for _, count in results)
    if not faults and left_out:
        skip(f"{left_out} of {sum(map(len, pages))} blocks need the shared data; the others passed")
    finish(faults)


if __name__ == "__main__":
    main()
