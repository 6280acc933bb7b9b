#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws permit.svg: permits that follow one another, and what happens when none follows."""
from drawing import GREY, MID, PALE, PAPER, RULE, STOP, WARM, Drawing

LEFT, SCALE = 118, 46
PERIODS, REACTION_MS, HORIZON_MS = 3, 2, 5.05
REST_MS = 9.6


def at(ms):
    return LEFT + ms * SCALE


def row(figure, y, name, note=""):
    figure.text(8, y + 13, name, 12, bold=True)
    figure.text(8, y + 27, note, 11, fill=GREY)


def permits(figure):
    for sample in range(PERIODS):
        y = 109 + sample * 30
        figure.line((at(sample), 78), (at(sample), y), (at(sample + 0.87), y), stroke=GREY,
                    dash="2 3", head=True)
    figure.line((at(PERIODS), 78), (at(PERIODS), 199), (at(PERIODS + 0.75), 199), stroke=GREY,
                dash="2 3", head=True)
    for sample in range(PERIODS):
        figure.label(at(sample + 0.87), 98 + sample * 30,
                     at(sample + PERIODS) - at(sample + 0.87), 22, f"permit {sample + 1}, twin",
                     MID, 11)
    figure.label(at(PERIODS + 0.78), 188, 126, 22, "stop frame, lost here", PAPER, 11, "4 3",
                 stroke=STOP)
    figure.text(at(PERIODS) - 8, 203, "4: not proven", 11, "end", fill=STOP)


def main():
    figure = Drawing("The life of a permit: renewed, not renewed, ended; then the board brakes",
                     372)
    figure.text(8, 18,
                "Each permit ends by itself; sample 4 is not proven, and the stop frame is lost",
                13, bold=True)
    figure.text(8, 46, "ms", 11, fill=GREY)
    figure.line((LEFT - 6, 54), (592, 54))
    for ms in range(11):
        figure.line((at(ms), 54), (at(ms), 49))
        figure.text(at(ms), 45, str(ms), 11, "middle")
    row(figure, 60, "samples")
    for sample in range(10):
        figure.label(at(sample) - 8, 61, 16, 16, str(sample + 1),
                     PALE if sample < PERIODS else PAPER, 11)
    row(figure, 98, "guard", "proves, permits")
    permits(figure)
    figure.line((8, 218), (592, 218), stroke=RULE)
    end, brake = PERIODS - 1 + PERIODS, PERIODS - 1 + HORIZON_MS
    row(figure, 226, "board", "own timer")
    figure.label(LEFT, 226, at(end) - LEFT, 30, "moves: a permit is in force", PALE, 11)
    figure.label(at(end), 226, at(brake) - at(end), 30, "reacts <= 2 ms", WARM, 11)
    figure.shape([(at(brake), 226), (at(REST_MS), 256), (at(brake), 256)], WARM)
    figure.text(at(brake) + 10, 250, "brakes", 11)
    figure.label(at(REST_MS), 226, 592 - at(REST_MS), 30, "rest", PAPER, 11)
    figure.line((at(end), 160), (at(end), 292), stroke=STOP, dash="5 3", width=1.6)
    figure.text(at(end) - 5, 284, "last permit ends: t + n T", 11, "end", fill=STOP)
    figure.line((8, 296), (592, 296), stroke=RULE)
    row(figure, 304, "certificate", "of sample 3")
    figure.label(at(2), 304, at(brake) - at(2), 30, "any start of braking, H = 5.05 ms", MID, 11)
    figure.label(at(brake), 304, at(REST_MS) - at(brake), 30, "to standstill", PALE, 11)
    figure.text(8, 360, "H = 1.01 n T + latch jitter + board reaction. Every pair keeps its margin"
                " from sample 3 to rest.", 11)
    figure.save(__file__)


if __name__ == "__main__":
    main()
