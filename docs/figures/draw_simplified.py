#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws simplified.svg: deviation and excess of a simplified surface."""
from drawing import DARK, MID, PALE, STOP, Drawing

WHOLE = [(30, 150), (70, 128), (110, 104), (150, 92), (190, 82), (230, 86), (270, 84), (310, 112),
         (350, 112), (390, 88), (430, 100), (470, 112), (520, 136), (560, 150)]
SIMPLE = [(30, 150), (110, 108), (210, 84), (390, 88), (560, 150)]


def main():
    figure = Drawing("A simplified surface: deviation of the whole one, excess of the simple one",
                     216)
    figure.text(8, 18, "Two proven lengths: how far each surface strays from the other", 13,
                bold=True)
    figure.shape(WHOLE + [(560, 170), (30, 170)], PALE, "none")
    figure.line(*WHOLE, width=1.4)
    figure.line(*SIMPLE, stroke=DARK, dash="6 3", width=2.2)
    for x, y in WHOLE:
        figure.circle(x, y, 2.2, "#111111")
    for x, y in SIMPLE:
        figure.circle(x, y, 4, MID, DARK)
    figure.line((430, 100), (428, 104), stroke=STOP)
    figure.line((72, 128), (70, 129), stroke=STOP)
    figure.line((330, 112), (330, 87), stroke=STOP, width=1.6, head=True, tail=True)
    figure.text(338, 58, "excess: simple surface to whole one\n(here it bridges a hollow)", 11,
                fill=STOP)
    figure.line((334, 74), (331, 86), stroke=STOP)
    figure.line((150, 92), (153, 98), stroke=STOP, width=1.6)
    figure.text(30, 50, "deviation: whole surface to simple one\n(here a bulge is cut off)", 11,
                fill=STOP)
    figure.line((146, 68), (150, 90), stroke=STOP)
    figure.text(295, 150, "S: whole surface, 14 vertices", 12, "middle")
    figure.text(295, 190, "dashed: S', 5 vertices. dist(S, B) >= dist(S', B') - d - e", 12,
                "middle",
                fill=DARK)
    figure.text(295, 208, "a stop comes no later, and by a bounded distance earlier", 11, "middle")
    figure.save(__file__)


if __name__ == "__main__":
    main()
