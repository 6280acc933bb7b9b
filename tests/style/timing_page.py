#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The table of docs/theory/timing.md is what tests/tools/timing_table.py makes of the records."""
import pathlib
import subprocess
import sys

from sources import finish


def main():
    root = pathlib.Path(sys.argv[1])
    made = subprocess.run([sys.executable, "-B", root / "tests/tools/timing_table.py",
                           root / "docs/measurements"], text=True, capture_output=True, check=True)
    page = (root / "docs/theory/timing.md").read_text(encoding="utf-8")
    finish([] if made.stdout and made.stdout in page else
           ["docs/theory/timing.md: its table is not that of tests/tools/timing_table.py:\n"
            + made.stdout])


if __name__ == "__main__":
    main()
