#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The exact judge judges rightly: two cubes a known gap apart, answers right and wrong.

usage: judge_test.py PROGRAM (axg_exact_scene); exit code 77 where it was not built.
"""
import itertools
import pathlib
import struct
import subprocess
import sys
import tempfile

CORNERS = list(itertools.product((-1.0, 1.0), repeat=3))
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
EXACT_TWO = 2.0


def cube_stl():
    facets = []
    for a, b, c, d in QUADS:
        facets += [(a, b, c), (a, c, d)]
    data = b" " * 80 + struct.pack("<I", len(facets))
    for facet in facets:
        data += struct.pack("<3f", 0, 0, 0)
        for corner in facet:
            data += struct.pack("<3f", *CORNERS[corner])
        data += b"\0\0"
    return data, len(facets)


def write_scene(folder, x_mm):
    stl, count = cube_stl()
    (folder / "cube.stl").write_bytes(stl)
    rows = "".join(f"{name},cube.stl,{count}\n" for name in "ab")
    (folder / "bodies.csv").write_text("name,stl,triangles\n" + rows)
    (folder / "pairs.csv").write_text("pair,a,b\na-b,a,b\n")
    head = "pose,body," + ",".join(f"m{r}{c}" for r in range(4) for c in range(4))
    rows = "".join(f"0,{name},1,0,0,{x!r},0,1,0,0,0,0,1,0,0,0,0,1\n"
                   for name, x in (("a", x_mm), ("b", 0.0)))
    (folder / "poses.csv").write_text(head + "\n" + rows)


def verdict(program, x_mm, answer):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        write_scene(folder, x_mm)
        (folder / "answers.csv").write_text("pose,pair,hit,count,clearance_mm\n" + answer)
        return subprocess.run([program, folder, folder / "answers.csv"], check=False,
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode


def main():
    program = pathlib.Path(sys.argv[1])
    if not program.exists():
        print(f"skipped: no {program} (it needs g++ and libcgal-dev)")
        sys.exit(77)
    # x of cube a, answer, what the judge must say: 0 holds, 1 does not, 2 no answers to this scene.
    # Faces in contact: 2 triangles against 2 triangles, more at their shared edges and corners.
    cases = [
        (EXACT_TWO, "0,a-b,1,,\n", 0),
        (EXACT_TWO, "0,a-b,0,,\n", 1),                   # an exact touch missed
        (EXACT_TWO * (1 + 2.0**-52), "0,a-b,0,,\n", 0),   # one representable value apart
        (EXACT_TWO * (1 - 2.0**-53), "0,a-b,0,,\n", 1),   # and one inside
        (EXACT_TWO + 0.0009, "0,a-b,1,,\n", 0),           # within 1 um
        (EXACT_TWO + 0.0011, "0,a-b,1,,\n", 1),           # a false hit
        (EXACT_TWO, "0,a-b,1,1,\n", 1),                   # fewer touching pairs than there are
        (EXACT_TWO, "0,a-b,1,1000,\n", 0),
        (EXACT_TWO + 3, "0,a-b,0,,3\n", 0),
        (EXACT_TWO + 3, "0,a-b,0,,3.000001\n", 1),        # a clearance above the distance
        (EXACT_TWO, "0,a-b,1,,0.5\n", 1),
        (EXACT_TWO + 3, "", 2),
        (EXACT_TWO + 3, "0,a-b,0,,\n0,a-b,0,,\n", 2),
        (EXACT_TWO + 3, "0,c-d,0,,\n", 2),
    ]
    faults = 0
    for x_mm, answer, wanted in cases:
        got = verdict(program, x_mm, answer)
        if got != wanted:
            faults += 1
            print(f"gap {x_mm - EXACT_TWO!r} mm, answer {answer!r}: got {got}, wanted {wanted}")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
