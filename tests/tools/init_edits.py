#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How many values of the bodies a person has to correct in what `axguard init` writes, against the
finished machine file of the same bodies: parent, axis, direction, pivot_mm, at_mm. Run it with
builds of two commits for before and after.
    tests/tools/init_edits.py BUILD FINISHED.yaml INIT_ARGUMENT...
Example: tests/tools/init_edits.py build/host-release mill.yaml meshes --unit inch
Bodies are the same where their meshes are: files may be renamed, `old=new` in AXG_RENAMED."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

KEYS = ("parent", "axis", "direction", "pivot_mm", "at_mm")


def bodies_of(text, renamed):
    """Per mesh file (of a tool, its name): the values, parents by their files too."""
    found, names = {}, {}
    section = text[text.index("\nbodies:"):]
    section = section[:section.index("\npairs:")]
    for part in re.split(r"\n  - name: ", section)[1:]:
        values = {key: match.group(1).split("#")[0].strip() for key in KEYS
                  if (match := re.search(rf"^    {key}: (.*)$", part, re.M))}
        file = re.search(r"file: \"?([^\",}]+)", part)
        name = part.split("\n")[0].split()[0]
        key = pathlib.Path(file.group(1)).stem if file else name
        key = renamed.get(key, key)
        names[name] = key
        found[key] = values
    fixed = {body for body, values in found.items() if not {"parent", "axis"} & set(values)}
    for values in found.values():
        parent = names.get(values.pop("parent", None))
        values["parent"] = None if parent in fixed else parent  # both stand on the floor
        for key in ("pivot_mm", "at_mm"):  # absent: at the origin
            numbers = [float(one) for one in re.findall(r"[-0-9.e]+", values.get(key, "0, 0, 0"))]
            values[key] = [round(one, 3) for one in numbers]
    return found


def main():
    build, finished = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    renamed = dict(pair.split("=") for pair in os.environ.get("AXG_RENAMED", "").split())
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "init.yaml"
        subprocess.run([build / "axguard", "init", *sys.argv[3:], "-o", out], check=True,
                       capture_output=True)
        text = out.read_text(encoding="utf-8")
        written = bodies_of(text, renamed)
    wanted = bodies_of(finished.read_text(encoding="utf-8"), {})
    wrong = [f"{body}.{key}" for body, values in wanted.items() if body in written
             for key in KEYS if written[body].get(key) != values.get(key)]
    wrong += [body for body in wanted if body not in written]
    print(f"{len(wrong)} of {len(wanted)} x {len(KEYS)} values to correct, "
          f"{text.count('# GUESS')} guesses: {' '.join(wrong) or 'none'}")


main()
