#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Links between pages lead somewhere, and so do the pages that comments name."""
import pathlib
import re
import sys

from sources import finish, is_code, read_text, tracked_files

LINK = re.compile(r"\]\((?!https?://|#|mailto:)([^)#\s]+)(?:#[^)]*)?\)")
FENCE = re.compile(r"^(`{3,}|~{3,}).*?^\1\s*$", re.S | re.M)
PAGE = re.compile(r"(?<![\w./])docs/[a-z0-9_/-]+\.md")


def targets(name, text):
    """(line, path from the root) of every page that a page or a comment names."""
    if name.endswith(".md"):
        text = FENCE.sub(lambda block: "\n" * block.group().count("\n"), text)
        folder = pathlib.PurePosixPath(name).parent
        for number, line in enumerate(text.split("\n"), 1):
            for match in LINK.finditer(line):
                yield number, folder / match.group(1)
    elif is_code(name) and not name.startswith("tests/style/"):
        for number, line in enumerate(text.split("\n"), 1):
            for match in PAGE.finditer(line):
                yield number, pathlib.PurePosixPath(match.group())


def main():
    root = pathlib.Path(sys.argv[1])
    faults = []
    for name in tracked_files(root):
        if name.endswith(".md") or is_code(name):
            faults += [f"{name}:{number}: {target} is not there"
                       for number, target in targets(name, read_text(root, name))
                       if not (root / target).exists()]
    finish(faults)


if __name__ == "__main__":
    main()
