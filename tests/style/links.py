#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Links between pages lead somewhere."""
import pathlib
import re
import sys

from sources import finish, read_text, tracked_files

LINK = re.compile(r"\]\((?!https?://|#|mailto:)([^)#\s]+)(?:#[^)]*)?\)")
FENCE = re.compile(r"^(`{3,}|~{3,}).*?^\1\s*$", re.S | re.M)


def targets(name, text):
    """(line, path from the root) of every file that a page links to."""
    text = FENCE.sub(lambda block: "\n" * block.group().count("\n"), text)
    folder = pathlib.PurePosixPath(name).parent
    for number, line in enumerate(text.split("\n"), 1):
        for match in LINK.finditer(line):
            yield number, folder / match.group(1)


def main():
    root = pathlib.Path(sys.argv[1])
    faults = []
    for name in tracked_files(root):
        if name.endswith(".md"):
            faults += [f"{name}:{number}: {target} is not there"
                       for number, target in targets(name, read_text(root, name))
                       if not (root / target).exists()]
    finish(faults)


if __name__ == "__main__":
    main()
