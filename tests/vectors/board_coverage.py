#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""permit2.json runs every line of the board library, as gcov counts them.

Example: board_coverage.py . cc"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77


def main():
    root, compiler = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    version = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=False)
    if shutil.which("gcov") is None or "clang" in version.stdout:
        print("skipped: needs gcc and gcov")
        sys.exit(SKIPPED)
    sources = [str(path) for path in sorted((root / "firmware_if/board").glob("*.c"))]
    player = root / "tests/vectors/play_permit2.c"
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([compiler, "-std=c99", "-O0", "--coverage", f"-I{root}", "-o", "play",
                        *sources, str(player)], cwd=folder, check=True)
        subprocess.run(["./play", str(root / "tests/vectors/permit2.json")], cwd=folder,
                       check=True, stdout=subprocess.DEVNULL)
        data = sorted(str(path) for path in pathlib.Path(folder).glob("*.gcda"))
        subprocess.run(["gcov", *data], cwd=folder, check=True, stdout=subprocess.DEVNULL)
        faults, lines = [], 0
        for source in sources:
            name = pathlib.Path(source).name
            for line in (pathlib.Path(folder) / f"{name}.gcov").read_text().split("\n"):
                lines += bool(re.match(r"\s*\d", line))
                if line.lstrip().startswith("#####"):
                    faults.append(f"{name}:{':'.join(line.split(':')[1:])}")
    for fault in faults:
        print("never run:", fault)
    print(f"{lines} passed, {len(faults)} failed")
    sys.exit(1 if faults or lines < 400 else 0)


if __name__ == "__main__":
    main()
