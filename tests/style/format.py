#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clang-format 14 has nothing to change. Another version would format differently: not asked."""
import pathlib
import shutil
import subprocess
import sys

from sources import finish, is_cpp, skip, tracked_files


def main():
    root = pathlib.Path(sys.argv[1])
    tool = shutil.which("clang-format-14")
    if tool is None:
        skip("clang-format-14 is not installed (./setup.sh --all installs it)")
    names = [name for name in tracked_files(root) if is_cpp(name)]
    run = subprocess.run([tool, "--dry-run", "--Werror", *names], cwd=root, text=True,
                         stderr=subprocess.PIPE, check=False)
    places = [line for line in run.stderr.split("\n") if "[-Wclang-format-violations]" in line]
    faults = [place.split(" error:")[0] + " is not formatted" for place in places]
    if run.returncode != 0:
        files = sorted({place.split(":")[0] for place in places})
        faults.append(f"run: clang-format-14 -i {' '.join(files)}" if files else run.stderr)
    finish(faults)


if __name__ == "__main__":
    main()
