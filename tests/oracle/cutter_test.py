#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cutter compensation beside LinuxCNC's interpreter: random contours of lines and arcs, on both
sides, with radii above and below the tool's. What it reads is read here with equal motions, or
refused by name where rounding would decide; what it refuses is refused.

    cutter_test.py PRINT_MOVES
"""
import collections
import math
import os
import pathlib
import random
import re
import shutil
import sys
import tempfile

import rs274_test as rs274

DIGITS = re.compile(r"\d[\d.e-]*")
# The centre of the first arc comes to lie on the other side of its end.
FOUND = """G20 G17 G90 G94 F4 G0 X0 Y0 Z0 G40
T1 M6
G42
G2 X0.0280 Y-0.1665 I-0.0914 J-0.1010
G1 X-0.8802 Y0.3322
G40
M2
"""


def contour_program(rng):
    """One contour, or two: entry, lines and arcs, exit."""
    is_inch, plane = rng.random() < 0.3, rng.choice((17, 17, 17, 18))
    unit = 1 / 25.4 if is_inch else 1.0
    first, second, third, i, j = {17: "XYZIJ", 18: "ZXYKI"}[plane]
    number = lambda low, high: f"{rng.uniform(low, high) * unit:.{rng.choice((3, 4))}f}"
    at = [0.0, 0.0]
    lines = [f"G{20 if is_inch else 21} G{plane} G90 G94 F{number(50, 500)} G0 X0 Y0 Z0 G40",
             "T1 M6"]
    if rng.random() < 0.3:
        lines.append(f"G10 L2 P1 X{number(-9, 9)} Y{number(-9, 9)} R{rng.randint(0, 359)}"
                     if plane == 17 else f"G10 L2 P1 X{number(-9, 9)} Z{number(-9, 9)}")
        lines.append(f"G0 {first}0 {second}0")

    def place(way, turned):
        return [round(at[0] + way * math.cos(turned) * unit, 4),
                round(at[1] + way * math.sin(turned) * unit, 4)]

    def line(word, way, turned):
        to = place(way, turned)
        if rng.random() < 0.2:  # a step
            step = [round(b - a, 4) for a, b in zip(at, to)]
            at[:] = [a + s for a, s in zip(at, step)]
            return f"G91 {word} {first}{step[0]:.4f} {second}{step[1]:.4f}\nG90"
        at[:] = to
        more = rng.choice(("", "", "", f" {third}{number(-5, 5)}", f" A{rng.randint(-9, 9)}"))
        return f"{word} {first}{to[0]:.4f} {second}{to[1]:.4f}{more}"

    def arc(radius, from_rad, sweep):
        """About a centre at this angle; sweep above 0 is counter-clockwise."""
        centre = [round(at[0] + radius * math.cos(from_rad) * unit, 4),
                  round(at[1] + radius * math.sin(from_rad) * unit, 4)]
        off = [a - c for a, c in zip(at, centre)]
        size = math.hypot(*off)
        angle = math.atan2(off[1], off[0]) + sweep
        to = [round(centre[0] + size * math.cos(angle), 4),
              round(centre[1] + size * math.sin(angle), 4)]
        word = "G2" if sweep < 0 else "G3"
        words = f"{i}{centre[0] - at[0]:.4f} {j}{centre[1] - at[1]:.4f}"
        if abs(sweep) > 6.2:
            return f"{word} {words}"
        if rng.random() < 0.3:
            words = f"R{size * (1 if abs(sweep) < math.pi else -1):.5f}"
        at[:] = to
        more = rng.choice(("", "", f" {third}{number(-5, 5)}"))
        return f"{word} {first}{to[0]:.4f} {second}{to[1]:.4f} {words}{more}"

    for _ in range(rng.randint(1, 2)):
        diameter = rng.choice((0.5, 2, 6, -3)) * unit
        stated = (f"G41.1 D{diameter:.5f}", f"G42.1 D{diameter:.5f}")
        # With G18 the table's orientation of a turning tool counts, which is not read.
        lines.append(rng.choice(
            stated if plane == 18 else ("G41", "G42", "G41 D1", "G42 D1", *stated)))
        size, heading = rng.choice((3, 15, 40)), rng.uniform(0, 6.28)
        for step in range(rng.randint(2, 9)):
            kind = rng.random()
            if kind < 0.5 or (step == 0 and kind < 0.8):
                heading += rng.choice((rng.uniform(-3, 3), rng.uniform(-1, 1), math.pi / 2,
                                       -math.pi / 2, 0.02, 0, math.pi))
                lines.append(line(rng.choice(("G1", "G1", "G1", "G0")),
                                  size * rng.uniform(0.3, 2), heading))
            elif kind < 0.9:
                sweep = rng.choice((rng.uniform(-3, 3), rng.uniform(-1, 1), rng.uniform(-5, 5),
                                    math.pi / 2, -math.pi / 2, math.pi, 2 * math.pi))
                heading += rng.choice((0, 0, 0.02, rng.uniform(-2, 2), math.pi))
                lines.append(arc(size * rng.uniform(0.2, 2),
                                 heading + math.copysign(math.pi / 2, sweep), sweep))
                heading += sweep
            else:
                lines.append(rng.choice((f"G1 {third}{number(-5, 5)}", "G4 P1", "M3 S9", "F77",
                                         "M0", f"G0 {third}1", "G1 A3", "(note)")))
        lines.append(rng.choice(("G40", "G40", f"G40 {line('G1', size, heading)}", "M2")))
        lines.append(line("G0", 5, 1))
    return "\n".join(lines + ["M2", ""])


def main():
    print_moves = sys.argv[1]
    if shutil.which("rs274") is None:
        print("skipped: no rs274 (Debian: linuxcnc-uspace; ./setup.sh --all installs it)")
        return rs274.SKIPPED
    seed, count = int(os.environ.get("AXG_SEED", "41")), int(os.environ.get("AXG_COUNT", "400"))
    print(f"seed {seed} (AXG_SEED overrides it), {count} random contours")
    rng = random.Random(seed)
    counts, reasons = collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "program.ngc")
        pathlib.Path(folder, rs274.TOOLS).write_text(
            f"T1 P1 Z0 D{rs274.DIAMETER_MM / rs274.INCH:.9f}\n", encoding="ascii")
        for number in range(count):
            text = contour_program(rng) if number else FOUND
            pathlib.Path(program).write_text(text, encoding="ascii")
            theirs = rs274.of_linuxcnc(program)
            ours, why = rs274.of_axguard(print_moves, program)
            first = DIGITS.sub("N", why.splitlines()[0].split(": ", 2)[-1]) if why else ""
            if theirs is None and ours is None:
                counts["refused by both"] += 1
            elif theirs is None:
                counts["read here only"] += 1
                if counts["read here only"] < 4:
                    print(text)
            elif ours is None:
                counts["refused here"] += 1
                reasons[first] += 1
            else:
                found = rs274.difference(ours, theirs)
                counts["unlike" if found else "equal"] += 1
                if found and counts["unlike"] < 4:
                    print(f"contour {number}: {found}\n{text}")
    for why, number in reasons.most_common():
        print(f"refused here {number}: {why}")
    print(", ".join(f"{number} {kind}" for kind, number in counts.items()))
    return 1 if counts["unlike"] or counts["read here only"] or not counts["equal"] else 0


if __name__ == "__main__":
    sys.exit(main())
