#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether motion.feed-inhibit alone would do: LinuxCNC runs a circle without the guard, the pin is
set at some instant, and each joint's way to standstill is compared with what a certificate of that
instant allows it. It follows the path, so joints turn round. Run by hand, recorded in
docs/measurements/linuxcnc.md.
Usage: inhibit.py SOURCE BUILD FOLDER [SECONDS...]"""
import pathlib
import sys

from place import Place, module

PERIOD_S = 1e-3
# Of the example's machine file, X and Y: acceleration, stopping, speed; reaction and jitter.
ACCELERATION, STOPPING, SPEED = 4000, 3500, 500
REACTION_S = 2e-3 + 20e-6
PROGRAM = "T1 M6\nG21 G90 G94\nG0 X0 Y0 Z40\nF6000\n" + "G2 X0 Y0 I3\n" * 60 + "M2\n"


def reach(speed, horizon_s):
    """Farthest in the direction of `speed`: full acceleration for the horizon, then the stop."""
    rise_s = min(horizon_s, max(0, (SPEED - speed) / ACCELERATION))
    top = min(SPEED, speed + ACCELERATION * rise_s)
    free = speed * rise_s + ACCELERATION * rise_s ** 2 / 2 + (horizon_s - rise_s) * SPEED
    return max(0, free + (top * top / (2 * STOPPING) if top > 0 else 0))


def compare(rows, first):
    left = 0
    for joint in (0, 1):
        speed = (rows[first][1 + joint] - rows[first - 1][1 + joint]) / PERIOD_S
        ways = [row[1 + joint] - rows[first][1 + joint] for row in rows[first:first + 400]]
        for samples in (3, 12):
            horizon_s = 1.01 * samples * PERIOD_S + REACTION_S
            low, high = -reach(-speed, horizon_s), reach(speed, horizon_s)
            is_out = min(ways) < low or max(ways) > high
            left += is_out
            print(f"n {samples}, {'XY'[joint]} at {speed:.1f} mm/s: {min(ways):.3f} to "
                  f"{max(ways):.3f} mm, box {low:.3f} to {high:.3f}{', LEFT' if is_out else ''}")
    return left


def main():
    source, build = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    with module(build):
        for seconds in map(float, sys.argv[4:] or ["1.4", "1.5", "1.6"]):
            place = Place(pathlib.Path(sys.argv[3]) / "inhibit", source, build, "paper-trunnion")
            place.prepare(PROGRAM, False, 400000, limit_s=8,
                          events=[{"do": "inhibit", "after_s": seconds}])
            said, _ = place.run(60)
            rows, _ = place.samples()
            if said.get("events"):  # behind the stop, the record has the pin
                compare(rows, next(i for i, row in enumerate(rows) if row[7]))


main()
