#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Doxygen builds the reference of the C interface without a warning, and every call is in it."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

from sources import finish, skip

HEADERS = ("firmware_if/axguard.h", "firmware_if/board/axguard_board.h",
           "firmware_if/board/axguard_operator.h")
CALL = re.compile(r"\b(axg_\w+)\(")


def calls_of(root):
    """Names that a header declares as functions."""
    text = "\n".join((root / name).read_text(encoding="utf-8") for name in HEADERS)
    return set(CALL.findall(re.sub(r"//.*", "", text)))


def described(folder):
    """Functions of the reference that have a description."""
    names = set()
    for path in pathlib.Path(folder).glob("xml/*.xml"):
        for member in xml.etree.ElementTree.parse(path).iter("memberdef"):
            words = "".join(member.find("briefdescription").itertext())
            if member.get("kind") == "function" and words.strip():
                names.add(member.findtext("name"))
    return names


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    if shutil.which("doxygen") is None:
        skip("no doxygen (Debian: doxygen)")
    with tempfile.TemporaryDirectory() as folder:
        settings = f"@INCLUDE = docs/Doxyfile\nOUTPUT_DIRECTORY = {folder}\nGENERATE_XML = YES\n"
        made = subprocess.run(["doxygen", "-"], cwd=root, input=settings, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        if made.returncode:
            finish(made.stdout.strip().splitlines() or ["doxygen failed"])
        missing = calls_of(root) - described(folder)
    finish([f"{name} has no description in the reference" for name in sorted(missing)])


if __name__ == "__main__":
    main()
