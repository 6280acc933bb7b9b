# SPDX-License-Identifier: Apache-2.0
"""A hook of mkdocs (mkdocs.yml): the pages above docs/ are part of the site, README.md in front.

Links between docs/ and the top folder are turned to where the pages are in the site. A link to a
source file has no place there and becomes its text; tests/style/links.py checks that it exists.
"""
import pathlib
import posixpath
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOP = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md")
LINK = re.compile(r"\[((?:[^\[\]]|!\[[^\]]*\]\([^)]*\))*)\]\((?!\w+:|#)([^)#\s]+)(#[^)]*)?\)")


def on_files(files, config):
    for name in TOP:
        files.append(File(name, str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def on_page_markdown(markdown, page, config, files):
    """Paths are taken from the repository's top, and given from the page's place in the site."""
    is_top = page.file.src_uri in TOP
    here = "" if is_top else posixpath.join("docs", posixpath.dirname(page.file.src_uri))

    def turned(match):
        text, path, anchor = match.group(1), match.group(2), match.group(3) or ""
        path = posixpath.normpath(posixpath.join(here, path))
        if path.startswith("docs/"):
            place = path[len("docs/"):]
        elif path in TOP:
            place = path
        else:
            return text
        own = posixpath.dirname(page.file.src_uri) or "."
        return f"[{turn_all(text)}]({posixpath.relpath(place, own)}{anchor})"

    def turn_all(text):
        return LINK.sub(turned, text)

    return turn_all(markdown)
