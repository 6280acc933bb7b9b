#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""No compiler may contract or reorder floating point: every command of this build says so last,
and instruction sets with fused operations are switched on for the lane kernels alone."""
import json
import pathlib
import re
import sys

from sources import finish, skip

# The laboratory's comparison of methods with fused operations: it decides nothing.
MAY_CONTRACT = {"hil_replay/lab/methods/fused.cpp", "tests/parity/contraction_on.cpp"}
MAY_USE_FMA = {"core/collision/traverse_avx512.cpp", "core/collision/traverse_avx2.cpp",
               "tests/parity/contraction_avx512.cpp",
               "tests/parity/contraction_avx2.cpp"} | MAY_CONTRACT
FAST = ("-ffast-math", "-Ofast", "-funsafe-math-optimizations", "-fassociative-math",
        "-freciprocal-math", "-ffinite-math-only", "-fno-signed-zeros", "-mdaz-ftz",
        "--use_fast_math", "-use_fast_math", "-march=native")
WIDE = ("-mfma", "-mavx", "-march=")


def faults_of(name, words):
    """Faults of one compiler command."""
    for word in words:
        if word in FAST:
            yield f"{name}: {word}"
    if any(word.startswith(WIDE) for word in words) and name not in MAY_USE_FMA:
        yield f"{name}: compiled for more than the baseline"
    is_clang = any("clang" in word for word in words[:2])  # behind a cache or not
    if pathlib.PurePath(name).suffix == ".cu" and not is_clang:
        if "--fmad=false" not in words and "-fmad=false" not in words:
            yield f"{name}: wanted --fmad=false"
        return
    last = [word for word in words if word.startswith("-ffp-contract")][-1:]
    wanted = ["-ffp-contract=fast" if name in MAY_CONTRACT else "-ffp-contract=off"]
    if last != wanted:
        yield f"{name}: the last word on contraction is {last}, wanted {wanted}"


def compiled_by(entry):
    """The files of one compiler command: a unit (AXG_UNITY) includes several."""
    path = pathlib.Path(entry["file"])
    if "/Unity/" not in entry["file"]:
        return [path.resolve()]
    inside = re.findall(r'#include "([^"]+)"', path.read_text(encoding="utf-8"))
    return [pathlib.Path(name).resolve() for name in inside]


def main():
    root, build = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    commands = build / "compile_commands.json"
    if not commands.exists():
        skip("no compile_commands.json: the generator writes none")
    faults, seen = [], set()
    for entry in json.loads(commands.read_text()):
        for path in compiled_by(entry):
            if not path.is_relative_to(root) or path.is_relative_to(build.resolve()):
                continue
            name = path.relative_to(root).as_posix()
            seen.add(name)
            faults += faults_of(name, entry["command"].split())
    if not {"core/collision/traverse_avx2.cpp", "core/guard/monitor.cpp",
            "hil_replay/commands/main.cpp"} <= seen:
        faults.append(f"{commands.name} names {len(seen)} files and not those of the guard")
    finish(sorted(set(faults)))


if __name__ == "__main__":
    main()
