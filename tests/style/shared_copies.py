#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No file of the shared data is in this repository: its licences are not ours."""
import hashlib
import pathlib
import sys

from sources import finish, skip, tracked_files

OWN_LICENCE = "LICENSE"  # the text of Apache-2.0 is the same wherever it lies
SIZE_BYTES_MIN = 64  # shorter files are alike by chance


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


def copies(ours, theirs):
    """Pairs (ours, theirs) of equal files; only files of equal size are read."""
    by_size = {}
    for path in theirs:
        size = path.stat().st_size
        if size >= SIZE_BYTES_MIN:
            by_size.setdefault(size, []).append(path)
    for path in ours:
        for other in by_size.get(path.stat().st_size, []):
            if digest(path) == digest(other):
                yield path, other


def main():
    root, shared = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    theirs = [path for path in shared.rglob("*") if path.is_file()] if shared.is_dir() else []
    if not theirs:
        skip(f"no shared data at {shared} (AXG_SHARED_DATA)")
    ours = [root / name for name in tracked_files(root) if name != OWN_LICENCE]
    finish([f"{path.relative_to(root)}: is a copy of {other.relative_to(shared)} of the shared data"
            for path, other in copies(ours, theirs)])


if __name__ == "__main__":
    main()
