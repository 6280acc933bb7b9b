#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""codespell finds nothing in pages, code and messages."""
import pathlib
import shutil
import subprocess
import sys

from sources import finish, is_code, skip, tracked_files

# "to and fro", deques of std, 2^nd, a field of the seed paper's tables, now_ns in capitals; words
# that tests misspell on purpose; "in" behind the \n of a string; German names.
RIGHT = ["fro", "deques", "nd", "neight", "nowns", "independant", "nane", "nmae", "nin",
         "spindel", "ue"]
TEXTS = (".md", ".yml", ".yaml")


def main():
    root = pathlib.Path(sys.argv[1])
    tool = shutil.which("codespell")
    if tool is None:
        skip("codespell is not installed (./setup.sh --all installs it)")
    names = [name for name in tracked_files(root)
             if (is_code(name) or name.endswith(TEXTS)) and name != "tests/style/spelling.py"]
    run = subprocess.run([tool, "--ignore-words-list", ",".join(RIGHT), *names], cwd=root,
                         text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    finish(run.stdout.splitlines())


if __name__ == "__main__":
    main()
