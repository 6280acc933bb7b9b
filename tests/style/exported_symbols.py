#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The shared library exports the names of firmware_if/axguard.h, all of them and nothing else: what
a program could link to by accident would have to stay as it is."""
import pathlib
import re
import subprocess
import sys

from sources import finish, read_text


def main():
    root, library = pathlib.Path(sys.argv[1]), sys.argv[2]
    text = subprocess.run(["nm", "--dynamic", "--defined-only", "--format=posix", library],
                          capture_output=True, check=True, text=True).stdout
    exported = {line.split()[0].split("@")[0] for line in text.splitlines()}
    header = read_text(root, "firmware_if/axguard.h")
    wanted = set(re.findall(r"AXG_API [^;(]*?(axg_\w+)\(", header))
    finish([f"{library}: exports {name}" for name in sorted(exported - wanted)] +
           [f"{library}: does not export {name}" for name in sorted(wanted - exported)])


if __name__ == "__main__":
    main()
