#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the example programs beside this file: `python3 hil_replay/programs/make_programs.py`.

A ball nose finishes a dome in a spiral, or in passes where the turning axis is not endless. Each
machine's own inverse kinematics turns tool tip and tool axis into axis positions (no TCP in the
program), and each block states the time it takes (G93), as posts for such machines do."""
import math
import pathlib

FOLDER = pathlib.Path(__file__).resolve().parent
FEED_MM_S = 4000 / 60.0
DOME_MM, BALL_MM = 60.0, 6.0
DEGREE = math.pi / 180


def axis_of(tilt, azimuth):
    """Direction from the tool's tip to its holder, in the workpiece."""
    return (math.sin(tilt) * math.cos(azimuth), math.sin(tilt) * math.sin(azimuth), math.cos(tilt))


def paper_trunnion(tip, tilt, azimuth):
    """Plate C on cradle A, both turning against their command; pivot 20 mm above the plate."""
    c, a = azimuth - math.pi / 2, -tilt
    x, y, z = tip[0], tip[1], tip[2] - 20.0
    x, y = x * math.cos(c) + y * math.sin(c), y * math.cos(c) - x * math.sin(c)
    y, z = y * math.cos(tilt) - z * math.sin(tilt), y * math.sin(tilt) + z * math.cos(tilt)
    return {"X": x, "Y": y, "Z": z - 380 + 140, "A": a / DEGREE, "C": c / DEGREE}


def spindle_tilting(tip, tilt, azimuth):
    """Head B in fork C; the table top is at -670, nose 200 mm and tool 120 mm from the axes."""
    u = axis_of(tilt, azimuth)
    return {"X": tip[0] + 320 * u[0], "Y": tip[1] + 320 * u[1],
            "Z": tip[2] - 670 + 320 * u[2], "B": tilt / DEGREE,
            "C": azimuth / DEGREE}


def table_spindle_tilting(tip, tilt, azimuth):
    """Head B, plate C turning against its command; plate top at -550, nose 200 mm, tool 130 mm."""
    c = azimuth
    x, y = (tip[0] * math.cos(c) + tip[1] * math.sin(c),
            tip[1] * math.cos(c) - tip[0] * math.sin(c))
    return {"X": 330 * math.sin(tilt) + x, "Y": y, "Z": tip[2] - 550 + 330 * math.cos(tilt),
            "B": tilt / DEGREE, "C": c / DEGREE}


def on_dome(center, polar, around, tilt, azimuth):
    """Tool tip when the ball touches the dome at (polar, around)."""
    reach = DOME_MM + BALL_MM
    axis = axis_of(tilt, azimuth)
    normal = (math.sin(polar) * math.cos(around), math.sin(polar) * math.sin(around),
              math.cos(polar))
    return tuple(center[k] + reach * normal[k] - BALL_MM * axis[k] for k in range(3))


def spiral(center, start_deg=10, end_deg=72, stepover_mm=12, step_deg=3):
    """(tip, tilt, azimuth) along a spiral from the top down; the tool leans outwards and ahead."""
    turns = (end_deg - start_deg) * DEGREE * DOME_MM / stepover_mm
    count = int(turns * 360 / step_deg)
    for i in range(count + 1):
        polar = (start_deg + (end_deg - start_deg) * i / count) * DEGREE
        around = i * step_deg * DEGREE
        tilt = max(5 * DEGREE, polar - 20 * DEGREE)
        azimuth = around + 20 * DEGREE
        yield on_dome(center, polar, around, tilt, azimuth), tilt, azimuth


def passes(center):
    """To and fro over the side of the dome where the fork's angle stays within a half turn."""
    for row in range(8):
        polar = (20 + 7 * row) * DEGREE
        for i in range(61):
            share = i / 60 if row % 2 == 0 else 1 - i / 60
            around = (-80 + 160 * share) * DEGREE
            tilt = 0.6 * polar + 6 * DEGREE * math.sin(2 * around)
            azimuth = 0.8 * around
            yield on_dome(center, polar, around, tilt, azimuth), tilt, azimuth


def block(axes):
    return " ".join(f"{name}{value:.4f}" for name, value in axes.items())


def timed_blocks(points, solve):
    """G1 blocks with the time each takes at the feed of the tool tip."""
    lines, last = [], None
    for tip, tilt, azimuth in points:
        if last is not None:
            seconds = max(math.dist(tip, last) / FEED_MM_S, 1e-3)
            lines.append(f"G1 {block(solve(tip, tilt, azimuth))} F{60 / seconds:.3f}")
        last = tip
    return lines


def write(name, title, tool, safe_z, solve, points, after=()):
    points = list(points)
    first = solve(*points[0])
    over = {k: v for k, v in first.items() if k != "Z"}
    lines = ["%", f"({title})", "(Made by make_programs.py; axis positions, tool length included)",
             "G21 G17 G40 G49 G54 G80 G90 G94", f"T{tool} M6", "S12000 M3",
             f"G0 Z{safe_z:.4f}", f"G0 {block(over)}", "M8",
             f"G1 Z{first['Z'] + 5:.4f} F6000", f"Z{first['Z']:.4f} F1500", "G93"]
    lines += timed_blocks(points, solve)
    lines += ["G94", f"G0 Z{safe_z:.4f}"] + list(after) + ["M9", "M5", "M30", "%"]
    (FOLDER / name).write_text("\n".join(lines) + "\n")


def rim_passes(depth_mm):
    """Five-axis moves along the rim of the plate, the tip at most depth_mm below its top."""
    def points():
        for i in range(61):
            share = i / 60
            azimuth = (100 + 150 * share) * DEGREE
            reach = 95 + 20 * share
            height = 12 - (12 + depth_mm) * share
            yield ((reach * math.cos(azimuth), reach * math.sin(azimuth), height),
                   (25 - 10 * share) * DEGREE, azimuth)
    all_points = list(points())
    first = paper_trunnion(*all_points[0])
    over = {k: v for k, v in first.items() if k != "Z"}
    return ["(Rim)", f"G0 {block(over)}", f"G0 Z{first['Z']:.4f}", "G93",
            *timed_blocks(all_points, paper_trunnion), "G94", "G0 Z50.0000"]


def touches(solve, tips, feed_mm_min):
    """Down to each place at a feed, and up again at rapid; the plate turns from place to place."""
    lines = ["(Probe)"]
    for x, y, z, azimuth in tips:
        above, down = solve((x, y, z + 30), 0, azimuth), solve((x, y, z), 0, azimuth)
        lines += [f"G0 {block(above)}", f"G1 Z{down['Z']:.4f} F{feed_mm_min}", "G4 P0.2",
                  f"G0 Z{above['Z']:.4f}"]
    return lines


def ring(height_mm, count=24):
    for i in range(count):
        angle = 2 * math.pi * i / count
        reach = 40 + 25 * (i % 3)
        yield reach * math.cos(angle), reach * math.sin(angle), height_mm, 0.5 * angle


def main():
    dome = (25.0, -15.0, 0.0)
    write("paper-trunnion-demo.ngc",
          "Dome and rim; the rim's depth is typed with the wrong sign: the cutter meets the plate",
          1, 50, paper_trunnion, spiral(dome), rim_passes(8))
    write("paper-trunnion-clean.ngc", "Dome and rim, 8 mm clear of the plate", 1, 50,
          paper_trunnion, spiral(dome), rim_passes(-8))
    write("spindle-tilting.ngc", "Dome in passes, fork and spindle tilting", 1, 0,
          spindle_tilting, passes((60.0, 20.0, 0.0)))
    write("table-spindle-tilting.ngc", "Dome in a spiral, head tilting, plate turning", 5, 200,
          table_spindle_tilting, spiral((25.0, -15.0, 30.0)))
    write("paper-trunnion-near.ngc", "Rim, down to a third of a millimetre above the plate", 1, 50,
          paper_trunnion, spiral(dome, end_deg=20), rim_passes(-0.53))
    write("table-spindle-tilting-near.ngc", "Probes the plate, and stops 0.8 mm above it", 5, 200,
          table_spindle_tilting, spiral((25.0, -15.0, 30.0), end_deg=20),
          touches(table_spindle_tilting, ring(0.8), 2000))


if __name__ == "__main__":
    main()
