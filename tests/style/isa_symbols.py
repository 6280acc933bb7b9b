#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Code compiled for one instruction set, or with contraction, stays where it was compiled: the
objects of the lane kernels and of the laboratory's fused methods define no weak, unique or other
public symbol that a linker could take in place of the baseline's, and every extension they may use
is asked of the processor before they run."""
import pathlib
import re
import subprocess
import sys

from sources import finish, skip

UNITS = ("traverse_avx512", "traverse_avx2", "traverse_neon", "fused")
OWN = re.compile(r"axg::((avx512|avx2|neon)|lab::fused)_kernels\(\)$")


def symbol_faults(unit, listing):
    """Faults in the output of `nm --defined-only -C` for one object."""
    for line in listing.splitlines():
        match = re.match(r"(?:[0-9a-f]+)?\s*(\S) (.+)$", line)
        if not match:
            yield f"{unit}: cannot read the line '{line}' of nm"
            continue
        kind, name = match.groups()
        if kind in "vVwWu":
            yield f"{unit}: {name} is weak: the linker may give its code to every other unit"
        elif kind.isupper() and not OWN.match(name):
            yield f"{unit}: {name} is public: wanted its kernels' name alone"


def option_faults(cmake_text, engine_text):
    """Extensions in the compile options that has_lane_set does not ask for."""
    for variable, case in (("AXG_AVX512_OPTIONS", "avx512"), ("AXG_AVX2_OPTIONS", "avx2")):
        options = re.search(rf"set\({variable}\s([^)]*)\)", cmake_text)
        body = re.search(rf"case LaneSet::{case}:\s*return {case}_kernels\(\) != nullptr(.*?);",
                         engine_text, re.S)
        if not options or not body:
            yield f"{case}: its options or its check are not where this test looks for them"
            continue
        for option in re.findall(r"-m([a-z0-9]+)(?=\s|$)", options.group(1)):
            if f'"{option}"' not in body.group(1):
                yield (f"core/collision/cpu_engine.cpp: {case} may use -m{option} and never asks "
                       "for it")


def main():
    root = pathlib.Path(sys.argv[1])
    objects = [pathlib.Path(name) for name in " ".join(sys.argv[2:]).replace(";", " ").split()]
    faults = list(option_faults((root / "core/collision/CMakeLists.txt").read_text(),
                                (root / "core/collision/cpu_engine.cpp").read_text()))
    for unit in UNITS:
        found = [o for o in objects if o.name.startswith(unit + ".")]
        if len(found) != 1:
            faults.append(f"{unit}: {len(found)} objects, wanted one")
            continue
        if not found[0].exists():
            skip(f"{found[0].name} is not built")
        run = subprocess.run(["nm", "--defined-only", "-C", str(found[0])], text=True,
                             capture_output=True, check=True)
        if "_kernels" not in run.stdout:
            faults.append(f"{unit}: nm shows no kernels in it")
        faults += symbol_faults(unit, run.stdout)
    finish(faults)


if __name__ == "__main__":
    main()
