#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What has changed since everything was last checked, and what that reaches.

changed.py ROOT                       changed files and what includes them, a line each
changed.py ROOT --sources DATABASE    of a compile database, the sources of products among them
changed.py ROOT --any GLOB...         exit code 0 if a file of such a name is among them, else 1
changed.py ROOT --left-out LISTING    tests labelled rare that no change reaches, as ctest -E has it

By day test.sh leaves out what no change reaches since the last run on record that left nothing out
(`night` or `full` in docs/measurements/check-steps.csv, or AXG_CHECKED_COMMIT). Where git does not
know that commit, everything has changed. LISTING is what `ctest --show-only=json-v1` prints.
"""
import argparse
import collections
import fnmatch
import json
import os
import pathlib
import re
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "style"))
from contraction_flags import compiled_by  # noqa: E402
from layers import reachable  # noqa: E402
from sources import includes, is_cpp, read_text, tracked_files  # noqa: E402

PRODUCT = re.compile(r"(core|config|firmware_if|hil_replay)/.*\.cpp$")
RECORD = "docs/measurements/check-steps.csv"
# What decides how everything is compiled: each room has changed with it.
BUILD = re.compile(r"CMake(Lists\.txt|Presets\.json)|toolchains/(flags|rooms|libraries)\.cmake")


def checked_commit(root):
    """Of the last recorded run that left nothing out, or None."""
    named = os.environ.get("AXG_CHECKED_COMMIT")
    if named:
        return named
    path = root / RECORD
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    runs = re.findall(r"(?m)^(?:full|night),([0-9a-f]{7,40}),([0-9-]{10}),", text)
    return sorted(runs, key=lambda run: run[1])[-1][0] if runs else None  # of a day the last


def changed_files(root, commit):
    """Files that differ from the commit, new ones included; None: git does not know it."""
    git = ["git", "-c", "safe.directory=*", "-C", str(root)]
    if commit is None:
        return None
    try:
        differ = subprocess.run([*git, "diff", "--name-only", "-z", commit, "--"],
                                capture_output=True, check=True).stdout
        new = subprocess.run([*git, "ls-files", "-z", "--others", "--exclude-standard"],
                             capture_output=True, check=True).stdout
    except (OSError, subprocess.CalledProcessError):
        return None
    return {name for name in (differ + new).decode().split("\0") if name}


def includers(files, text_of):
    """{file: files that include it} of C++ files, by paths from the root."""
    found = collections.defaultdict(set)
    for name in files:
        for _, path, quoted in includes(text_of(name)):
            if quoted:
                beside = name.rpartition("/")[0] + "/" + path
                found[path if "/" in path else beside].add(name)
    return found


def with_includers(changed, graph):
    """The changed files, and each that includes one of them, through others too."""
    return changed.union(*(reachable(graph, name) for name in changed))


class Change:
    """What has changed in a checkout; `files` None: everything."""

    def __init__(self, root):
        self.root = root
        self.tracked = tracked_files(root)
        self.changed = changed_files(root, checked_commit(root))
        self.files = None
        if self.changed is not None:
            graph = includers([name for name in self.tracked if is_cpp(name)],
                              lambda name: read_text(root, name))
            self.files = with_includers(self.changed, graph)

    def touches(self, name):
        return self.files is None or name in self.files

    def named(self, glob):
        return fnmatch.filter(self.tracked, glob)

    def rooms(self):
        """Rooms, and other folders of products, with a file that has changed or includes one."""
        folders = {name.rpartition("/")[0] for name in self.tracked if is_cpp(name)}
        if self.files is None or any(BUILD.fullmatch(name) for name in self.changed):
            return folders
        return folders & {name.rpartition("/")[0] for name in self.files}


def sources_of(database, root):
    """{entry of a compile database: files of ours that it compiles}."""
    found = {}
    for entry in json.loads(database.read_text(encoding="utf-8")):
        ours = [path.relative_to(root).as_posix() for path in compiled_by(entry)
                if path.is_relative_to(root)]
        if ours:
            found[entry["file"]] = ours
    return found


def left_out(tests, change):
    """Names of the tests labelled rare that nothing which has changed reaches. What a test reaches
    its labels tell: rooms (firmware_if.linuxcnc), and files:GLOB, whose includes count too."""
    rooms = {room.replace("/", ".") for room in change.rooms()}
    for test in tests:
        labels = {label for item in test.get("properties", []) if item["name"] == "LABELS"
                  for label in item["value"]}
        globs = [label.removeprefix("files:") for label in labels if label.startswith("files:")]
        files = [name for glob in globs for name in change.named(glob)]
        if "rare" in labels and not labels & rooms and not any(map(change.touches, files)):
            yield test["name"]


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root", type=pathlib.Path)
    parser.add_argument("--sources", type=pathlib.Path)
    parser.add_argument("--any", nargs="+", metavar="GLOB")
    parser.add_argument("--left-out", type=pathlib.Path)
    options = parser.parse_args()
    root = options.root.resolve()
    change = Change(root)
    if options.sources:
        for source, files in sorted(sources_of(options.sources, root).items()):
            if any(change.touches(name) for name in files if PRODUCT.match(name)):
                print(source)
    elif options.any:
        return not any(change.touches(name) for glob in options.any
                       for name in change.named(glob))
    elif options.left_out:
        tests = json.loads(options.left_out.read_text(encoding="utf-8"))["tests"]
        names = sorted(left_out(tests, change))
        print("^(" + "|".join(map(re.escape, names)) + ")$" if names else "")
    else:
        print("\n".join(sorted(change.tracked if change.files is None else change.files)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
