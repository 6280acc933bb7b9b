#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws guard.svg: what axguard receives and sends, and why it stops: the README's first figure."""
from drawing import DARK, MID, PALE, PAPER, RULE, STOP, WARM, Drawing

LEFTS, WIDE, TOP, TALL = (8, 208, 408), 184, 106, 228
MIDDLE = 56  # of the tool, from the left of its panel
PLATE = 262
# Where the tip is in the three panels, and the lowest place where a stop from there may end.
PROVEN, PROVEN_END = 186, 244
OPEN, OPEN_END = 208, 268
RESTS = 238


def circuit(figure):
    figure.label(8, 34, 150, 58, "motion board\nmoves the axes only\nwhile it has a permit", PALE)
    figure.label(442, 34, 150, 58, "axguard\nproves each sample\nof the positions", MID)
    figure.line((158, 52), (442, 52), head=True)
    figure.text(300, 46, "CAN: positions of all axes, every 1 ms", 11, "middle")
    figure.line((442, 76), (158, 76), head=True)
    figure.text(300, 90, "CAN: a permit, which ends after 3 to 12 ms", 11, "middle")


def panel(figure, at, title, words):
    left = LEFTS[at]
    figure.box(left, TOP, WIDE, TALL, PAPER, RULE)
    figure.step(left + 16, PLATE + 34, at + 1)
    figure.text(left + 30, PLATE + 38, title, 12, bold=True)
    figure.text(left + 8, PLATE + 54, words, 11)
    figure.box(left + 6, PLATE, WIDE - 12, 16, MID)
    figure.text(left + WIDE - 12, PLATE + 12, "plate", 11, "end")
    return left + MIDDLE


def headstock(figure, middle, tip):
    figure.label(middle - 42, tip - 70, 84, 24, "headstock", PALE, 11)
    figure.box(middle - 12, tip - 46, 24, 14, PALE)
    figure.box(middle - 7, tip - 32, 14, 32, DARK, DARK)


def reach(figure, middle, tip, lowest, fill, stroke):
    figure.shape([(middle - 9, tip - 12), (middle + 9, tip - 12), (middle + 16, lowest),
                  (middle - 16, lowest)], fill, stroke, "4 3")


def proven(figure):
    middle = panel(figure, 0, "proven", "Every stop ends clear:\naxguard renews the permit.")
    reach(figure, middle, PROVEN, PROVEN_END, PALE, DARK)
    headstock(figure, middle, PROVEN)
    figure.text(middle + 24, PROVEN + 26, "where a stop\nmay end", 11, fill=DARK)
    figure.line((middle, PROVEN_END), (middle, PLATE), stroke=DARK)
    figure.text(middle + 24, PLATE - 5, "clear", 11, fill=DARK)


def not_proven(figure):
    middle = panel(figure, 1, "not proven",
                   "A stop may end in the plate:\na stop frame, no new permit.")
    reach(figure, middle, OPEN, OPEN_END, WARM, STOP)
    headstock(figure, middle, OPEN)
    figure.text(middle + 24, OPEN + 24, "where a stop\nmay end", 11, fill=STOP)


def stopped(figure):
    middle = panel(figure, 2, "stopped",
                   "The board brakes at the latest\nwhen the last permit ends.")
    headstock(figure, middle, RESTS)
    figure.line((middle, RESTS), (middle, PLATE), stroke=DARK)
    figure.text(middle + 24, PLATE - 9, "clear", 11, fill=DARK)


def main():
    figure = Drawing("For each sample axguard proves that every stop ends clear and sends a permit;"
                     " without a proof it sends none, and the board stops the machine", 360)
    figure.text(8, 20, "Can the machine still stop before two of its bodies touch?", 14, bold=True)
    circuit(figure)
    proven(figure)
    not_proven(figure)
    stopped(figure)
    figure.text(8, 351, "Also not proven: a frame is missing, or the proof is not complete within"
                " the time of a cycle.", 11)
    figure.save(__file__)


if __name__ == "__main__":
    main()
