#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws travel.svg: what the travel proof removes from a pair, and where it holds."""
from drawing import MID, PALE, PAPER, STOP, WARM, Drawing


def main():
    figure = Drawing("The travel proof: triangles that never come near, and where that holds", 236)
    figure.text(8, 18, "Once at start: what no position of the travel brings near leaves the pair",
                13, bold=True)
    figure.box(24, 40, 90, 84, PAPER, dash="4 3")
    figure.text(69, 76, "A: pruned,\nfar in all T", 11, "middle")
    figure.box(24, 124, 90, 26, WARM)
    figure.text(69, 141, "A': kept", 11, "middle")
    figure.box(132, 156, 110, 22, WARM)
    figure.text(187, 171, "B': kept", 11, "middle")
    figure.box(132, 178, 110, 30, PAPER, dash="4 3")
    figure.text(187, 197, "B: pruned", 11, "middle")
    figure.line((24, 168), (114, 168), head=True, tail=True)
    figure.text(69, 184, "travel", 11, "middle")
    figure.box(300, 40, 284, 150, PALE, dash="4 3")
    figure.text(308, 56, "overrun", 11)
    figure.box(322, 62, 240, 106, PAPER)
    figure.text(330, 78, "travel", 11)
    figure.label(356, 100, 74, 48, "K inside:\nA', B'", MID, 11)
    figure.label(520, 96, 76, 48, "K beyond:\nwhole", WARM, 11, stroke=STOP)
    figure.text(442, 208, "T: travel and overrun of every axis.\nK: joint box of a query.", 11,
                "middle")
    figure.save(__file__)


if __name__ == "__main__":
    main()
