#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Links between pages lead somewhere, headings included; pages, sections and tests that comments
name exist.

Every page of a shelf is linked from the shelf's index."""
import pathlib
import posixpath
import re
import sys

from sources import finish, is_code, is_cpp, read_text, tracked_files

LINK = re.compile(r"\]\((?!https?://|mailto:)([^)#\s]*)(?:#([^)]*))?\)")
SHELF_PAGE = re.compile(r"docs/[a-z]+/[^/]+\.md$")
FENCE = re.compile(r"^(`{3,}|~{3,}).*?^\1\s*$", re.S | re.M)
PAGE = re.compile(r"(?<![\w./])docs/[a-z0-9_/-]+\.md")
COMMENT = re.compile(r"(?:^[ \t]*//[^\n]*\n)+", re.M)
SECTIONS = re.compile(rf"({PAGE.pattern}), (\"[^\"]+\"(?:(?:,| and) \"[^\"]+\")*)")
TESTS = re.compile(r"\bTests: ([^.]*)\.")


def without_fences(text):
    return FENCE.sub(lambda block: "\n" * block.group().count("\n"), text)


def headings(text):
    """The anchors that a page's headings have, as GitHub makes them."""
    anchors = set()
    for match in re.finditer(r"^#+ +(.*?) *$", without_fences(text), re.M):
        title = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", match.group(1)).lower()
        anchor = re.sub(r"[^\w\- ]", "", title).replace(" ", "-")
        again = sum(1 for one in anchors if re.fullmatch(re.escape(anchor) + r"(-\d+)?", one))
        anchors.add(f"{anchor}-{again}" if anchor in anchors else anchor)
    return anchors


def targets(name, text):
    """(line, path from the root, heading) of every page that a page or a comment names."""
    if name.endswith(".md"):
        folder = posixpath.dirname(name)
        for number, line in enumerate(without_fences(text).split("\n"), 1):
            for match in LINK.finditer(line):
                target = posixpath.join(folder, match.group(1)) if match.group(1) else name
                yield number, posixpath.normpath(target), match.group(2)
    elif is_code(name) and not name.startswith("tests/style/"):
        for number, line in enumerate(text.split("\n"), 1):
            for match in PAGE.finditer(line):
                yield number, match.group(), None


def sections(text):
    """(line, page, section) of every section that a comment names: docs/PAGE.md, "SECTION"."""
    for block in COMMENT.finditer(text):
        line = text.count("\n", 0, block.start()) + 1
        for match in SECTIONS.finditer(re.sub(r"\n[ \t]*//[/!]?<? ?", " ", block.group())):
            for section in re.findall(r'"([^"]+)"', match.group(2)):
                yield line, match.group(1), section


def has_section(page, section):
    """Of a heading, a point in bold or one of a table's first column; numbers are left out."""
    opens = r"(?m)^(?:#+ +|[ \t]*(?:[-*] )?\*\*|\| `?)(?:\d+\.? )?"
    return re.search(opens + re.escape(section), page) is not None


def named_tests(text):
    """(line, test) of every "Tests: ONE_test, OTHER_test." in a comment."""
    for block in COMMENT.finditer(text):
        line = text.count("\n", 0, block.start()) + 1
        for match in TESTS.finditer(re.sub(r"\n[ \t]*//[/!]?<? ?", " ", block.group())):
            for name in re.findall(r"\b\w+_tests?\b", match.group(1)):
                yield line, name


def fault_of(root, target, heading):
    if not (root / target).exists():
        return f"{target} is not there"
    if heading and target.endswith(".md") and heading not in headings(read_text(root, target)):
        return f"{target} has no heading #{heading}"
    return None


def unlinked(pages):
    """Pages of a shelf that its index does not link. pages: the text of each by its name."""
    for name in filter(SHELF_PAGE.match, pages):
        index = posixpath.join(posixpath.dirname(name), "index.md")
        linked = {target for _, target, _ in targets(index, pages.get(index, ""))}
        if name != index and name not in linked:
            yield f"{name}: {index} does not link it"


def main():
    root = pathlib.Path(sys.argv[1])
    texts = {name: read_text(root, name) for name in tracked_files(root)
             if name.endswith(".md") or is_code(name)}
    faults = []
    for name, text in texts.items():
        for number, target, heading in targets(name, text):
            fault = fault_of(root, target, heading)
            faults += [f"{name}:{number}: {fault}"] if fault else []
    tests = {pathlib.PurePath(name).stem for name in texts if name.startswith("tests/")}
    for name, text in texts.items():
        if not is_cpp(name):
            continue
        faults += [f"{name}:{line}: {page} has no section \"{section}\""
                   for line, page, section in sections(text)
                   if not has_section(texts.get(page, ""), section)]
        faults += [f"{name}:{line}: no test is called {test}"
                   for line, test in named_tests(text) if test not in tests]
    finish(faults + list(unlinked(texts)))


if __name__ == "__main__":
    main()
