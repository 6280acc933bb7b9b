#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws timing.svg: predicted GPU times on boards, from tests/tools/timing_table.py."""
import pathlib
import re
import subprocess
import sys

from drawing import DARK, GREY, MID, RULE, STOP, Drawing

ROOT = pathlib.Path(__file__).resolve().parents[2]
LEFT, SCALE, LIMIT_US = 176, 0.078, 900
ROWS = {"one pose, eight pairs": MID, "longest batch, one level": "#7fa6cc",
        "longest cycle, double included": DARK}


def table():
    made = subprocess.run([sys.executable, "-B", ROOT / "tests/tools/timing_table.py",
                           ROOT / "docs/measurements"], text=True, capture_output=True, check=True)
    rows = [[cell.strip() for cell in line.strip("|").split("|")]
            for line in made.stdout.splitlines() if line.startswith("|")]
    return rows[0][1:], {row[0]: row[1:] for row in rows}


def main():
    boards, rows = table()
    added = next(cells for name, cells in rows.items() if name.startswith("default plan"))
    figure = Drawing("Predicted times of GPU cycles on Jetson boards", 372)
    figure.text(8, 18, "Predicted, not measured: longest cycles against 900 us of a 1 kHz deadline",
                13, bold=True)
    for us in range(0, 5001, 1000):
        figure.line((LEFT + us * SCALE, 34), (LEFT + us * SCALE, 322), stroke=RULE)
        figure.text(LEFT + us * SCALE, 338, str(us), 11, "middle")
    y = 40
    for at, board in enumerate(boards):
        lines = re.sub(r" \(", "\n(", board)
        figure.text(8, y + 18, lines, 11)
        for name, fill in ROWS.items():
            low, high = (int(us) for us in re.findall(r"\d+", rows[name][at]))
            figure.box(LEFT, y, max(2, high * SCALE), 12, fill, "none")
            figure.line((LEFT + low * SCALE, y), (LEFT + low * SCALE, y + 12), stroke="#ffffff")
            y += 14
        more = float(added[at]) * SCALE  # of that, at its end
        figure.box(LEFT + high * SCALE - more, y - 14, more, 12, "none", "#ffffff", "3 2")
        y += 14
    figure.line((LEFT + LIMIT_US * SCALE, 30), (LEFT + LIMIT_US * SCALE, 322), stroke=STOP,
                dash="5 3", width=1.6)
    figure.text(LEFT + LIMIT_US * SCALE + 4, 40, "900", 11, fill=STOP)
    figure.text(LEFT - 8, 338, "us", 11, "end")
    figure.text(8, 356,
                "Bars of a board: one pose; longest batch; longest cycle of the default plan. White"
                " mark: without", 11, fill=GREY)
    figure.text(8, 369, "launches. Dashed: what boards take longer for double.", 11, fill=GREY)
    figure.save(__file__)


if __name__ == "__main__":
    main()
