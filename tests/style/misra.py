#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""MISRA C:2012 of the board library, by rule numbers; deviations: firmware_if/board/misra.txt."""
import pathlib
import re
import shutil
import subprocess
import sys

from sources import finish, skip

ROOM = "firmware_if/board"


def main():
    root = pathlib.Path(sys.argv[1])
    if shutil.which("cppcheck") is None:
        skip("cppcheck is not installed")
    files = sorted(str(path.relative_to(root)) for path in (root / ROOM).glob("*.c"))
    run = subprocess.run(
        ["cppcheck", "--addon=misra", "--std=c99", "--language=c", "--quiet", "-I.",
         "--enable=style,warning,portability", "--suppress=missingIncludeSystem",
         f"--suppressions-list={ROOM}/misra.txt", *files],
        cwd=root, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if "misra" in run.stdout and "addon" in run.stdout.lower():
        skip("cppcheck has no MISRA addon here")
    finish([line for line in run.stdout.split("\n") if re.match(ROOM, line)])


if __name__ == "__main__":
    main()
