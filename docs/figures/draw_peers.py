#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws peers.svg: contacts missed and time of five libraries, from docs/measurements/peers.txt.

The columns of the last table there: median, p99, slowest in us, contacts, missed, false hits."""
import pathlib
import re

from drawing import DARK, GREY, MID, PAPER, RULE, STOP, Drawing

RECORD = pathlib.Path(__file__).parents[1] / "measurements/peers.txt"
TABLE = "which the README has:"
ROW = re.compile(r"(axguard|FCL|Coal|Bullet|ODE) \S+" + r" +([\d.]+)" * 3 + r" +(\d+)" * 3)
MISSED_AT, MISSED_WIDE = 110, 66
TIME_AT, PX_PER_US = 226, 0.92


def libraries():
    """{name: (median, p99, slowest, contacts, missed, false hits)}, the fastest first."""
    table = RECORD.read_text(encoding="utf-8").rpartition(TABLE)[2]
    rows = {row[1]: (*map(float, row.groups()[1:4]), *map(int, row.groups()[4:]))
            for row in ROW.finditer(table)}
    return dict(sorted(rows.items(), key=lambda row: row[1][0]))


def short(value):
    """Three digits, as the README has them."""
    return f"{value:.2f}" if value < 10 else f"{value:.1f}" if value < 100 else f"{value:.0f}"


def main():
    rows = libraries()
    contacts = max(row[3] for row in rows.values())
    figure = Drawing("Contacts missed, and time of a query of eight pairs, of axguard, ODE, Bullet,"
                     " FCL and Coal", 60 + 30 * len(rows))
    figure.text(MISSED_AT, 18, f"missed, of {contacts}", 12, bold=True)
    figure.text(TIME_AT, 18, "time, us: median (dark) and slowest pose", 12, bold=True)
    for at, (name, row) in enumerate(rows.items()):
        y = 30 + at * 30
        median, _, slowest, _, missed, _ = row
        figure.text(8, y + 14, name, 12, bold=name == "axguard")
        figure.box(MISSED_AT, y, MISSED_WIDE, 18, PAPER, RULE)
        if missed:
            figure.box(MISSED_AT, y, MISSED_WIDE * missed / contacts, 18, STOP, STOP)
        figure.text(MISSED_AT + MISSED_WIDE + 8, y + 14, str(missed), 12)
        figure.box(TIME_AT, y, slowest * PX_PER_US, 18, MID, DARK)
        figure.box(TIME_AT, y, median * PX_PER_US, 18, DARK, DARK)
        figure.text(TIME_AT + slowest * PX_PER_US + 8, y + 14,
                    f"{short(median)}, {short(slowest)}", 12)
    figure.text(8, 48 + 30 * len(rows), "Shorter is better. One query: does any of eight pairs of"
                " bodies touch?", 11, fill=GREY)
    figure.save(__file__)


if __name__ == "__main__":
    main()
