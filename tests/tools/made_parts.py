# SPDX-License-Identifier: Apache-2.0
"""Parts of a page that a program makes. A part begins and ends with a line that a reader of the
rendered page does not see:
    <!-- made: NAME -->
    <!-- end -->
"""
import re

PART = re.compile(r"^<!-- made: (?P<name>[^>]+?) -->\n.*?^<!-- end -->\n", re.S | re.M)


def names_of_parts(page):
    return [match.group("name") for match in PART.finditer(page)]


def with_parts(page, made):
    """The page with each part made anew; `made` has the text of every part by its name."""
    names = names_of_parts(page)
    if sorted(names) != sorted(made):
        missing, unknown = sorted(set(made) - set(names)), sorted(set(names) - set(made))
        raise ValueError(f"parts of the page: missing {missing}, unknown {unknown}, "
                         f"{len(names)} of {len(made)}")
    return PART.sub(lambda match: f"<!-- made: {match.group('name')} -->\n\n"
                                  f"{made[match.group('name')].strip()}\n\n<!-- end -->\n", page)


def table(head, rows):
    """In Markdown; a bar within a cell is escaped."""
    lines = [head, ["---"] * len(head)] + rows
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |"
                     for line in lines)
