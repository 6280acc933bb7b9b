#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The pages as they are installed: with the figures and records that they link, and without links
to what is not installed, of which the text stays. tests/style/links.py checks those.

Example: toolchains/install_pages.py . build/host-package/packaged/pages --changelog CHANGELOG"""
import argparse
import pathlib
import posixpath
import re
import shutil

TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")
LINK = re.compile(r"(?<!!)\[((?:[^\[\]]|!\[[^\]]*\]\([^)]*\))*)\]\((?!\w+:|#)([^)#\s]+)(#[^)]*)?\)")


def pages_of(root):
    return [root / name for name in TOP] + sorted((root / "docs").rglob("*.md"))


def targets_of(text, here):
    """(path from the top, match) of each link and picture to a file."""
    pattern = re.compile(r"\]\((?!\w+:|#)([^)#\s]+)(?:#[^)]*)?\)")
    for match in pattern.finditer(text):
        yield posixpath.normpath(posixpath.join(here, match.group(1)))


def without_links(text, here, installed):
    """Turns links to what is not installed into their text."""
    def turned(match):
        path = posixpath.normpath(posixpath.join(here, match.group(2)))
        inner = LINK.sub(turned, match.group(1))
        if path not in installed:
            return inner
        return f"[{inner}]({match.group(2)}{match.group(3) or ''})"
    return LINK.sub(turned, text)


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("root", type=pathlib.Path)
    options.add_argument("out", type=pathlib.Path)
    options.add_argument("--changelog", type=pathlib.Path, help="the changes without any link")
    given = options.parse_args()
    texts = {str(path.relative_to(given.root)): path.read_text(encoding="utf-8")
             for path in pages_of(given.root)}
    installed = set(texts)
    for name, text in texts.items():
        for path in targets_of(text, posixpath.dirname(name)):
            if path.startswith("docs/") and (given.root / path).is_file():
                installed.add(path)
    shutil.rmtree(given.out, ignore_errors=True)
    for name in sorted(installed):
        into = given.out / name
        into.parent.mkdir(parents=True, exist_ok=True)
        if name in texts:
            text = without_links(texts[name], posixpath.dirname(name), installed)
            into.write_text(text, encoding="utf-8")
        else:
            shutil.copyfile(given.root / name, into)
    if given.changelog:
        given.changelog.write_text(without_links(texts["CHANGELOG.md"], "", set()),
                                   encoding="utf-8")


if __name__ == "__main__":
    main()
