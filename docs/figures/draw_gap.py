#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws gap.svg: when the certified test accepts a vector, and the undecided band."""
from drawing import DARK, GREY, MID, PALE, PAPER, STOP, WARM, Drawing


def interval(figure, y, low, high, name, fill):
    figure.label(low, y, high - low, 20, name, fill, 11)


def bound(figure, x, y, length):
    figure.line((x, y), (x, y - 12), (x + length, y - 12), (x + length, y), stroke=STOP, width=1.6)
    figure.text(x + length / 2, y - 17, "bound", 11, "middle", fill=STOP)


def main():
    figure = Drawing("The certified test: a gap must exceed the bound of its own rounding", 288)
    figure.text(8, 18, "A vector separates only if the computed gap exceeds its rounding bound", 13,
                bold=True)
    for y, gap, words, fill in ((64, 120, "gap > bound:\nproven apart, a theorem", MID),
                                (138, 26, "0 < gap <= bound:\nundecided, try the next", WARM),
                                (212, -40, "gap <= 0:\nno separation", PAPER)):
        interval(figure, y, 20, 150, "triangle A along L", PALE)
        start = 150 + gap
        interval(figure, y + (22 if gap < 0 else 0), start, start + 130, "triangle B along L", PALE)
        bound(figure, 150, y, 64)
        if gap > 0:
            figure.line((150, y + 30), (start, y + 30), stroke=DARK, head=True, tail=True)
            figure.text(150 + gap / 2, y + 44, "gap", 11, "middle", fill=DARK)
        figure.label(422, y - 12, 168, 40, words, fill, 11)
    figure.text(8, 276, "L may be any vector: a badly computed one proves less, never something"
                " false.", 11, fill=GREY)
    figure.save(__file__)


if __name__ == "__main__":
    main()
