#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A header with its comments as Doxygen reads them: // above a declaration becomes ///, // behind
one becomes ///<. The first comment of the file describes the file. Doxyfile names this filter.
    tests/tools/doc_comments.py HEADER
"""
import pathlib
import re
import sys

RULER = re.compile(r"\s*// -{3}")
ABOVE = re.compile(r"(\s*)// ?(.*)$")
BEHIND = re.compile(r"(.*\S\s+)// (.*)$")


def converted(text):
    lines, is_head, column = [], True, None  # column: of the comment behind the line before
    for line in text.split("\n"):
        above, behind = ABOVE.match(line), BEHIND.match(line)
        if RULER.match(line):
            above, line = None, ""
        elif line.startswith("// SPDX"):
            line = "/// @file"
        elif above and column is not None and len(above.group(1)) == column:
            line = f"{above.group(1)}///< {above.group(2)}"  # goes on
        elif above:
            line = f"{above.group(1)}/// {above.group(2)}".rstrip()
            column = None
        elif behind:
            column = len(behind.group(1))
            line = f"{behind.group(1)}///< {behind.group(2)}"
        else:
            column = None
        if is_head and not above:
            is_head = False
            lines.append("")  # the file's own comment belongs to no declaration
        lines.append(line)
    return "\n".join(lines)


if __name__ == "__main__":
    sys.stdout.write(converted(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8")))
