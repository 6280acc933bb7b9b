#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws argument.svg: the chain of proofs from reported positions to a permit."""
from drawing import GREY, MID, PALE, WARM, Drawing

CHAIN = [  # what is known, the page that proves it
    ("reported positions of one SYNC, with their errors", "promise of the board", WARM),
    ("every speed and acceleration that an axis may have now", "certificate", PALE),
    ("every position to standstill: the joint box", "certificate", PALE),
    ("every pair at the centre of the box, margin + motion", "certificate", PALE),
    ("every pair of nodes, leaves and triangles", "accuracy", PALE),
    ("no part of a body inside another", "accuracy, containment", PALE),
    ("permit for this sample, n periods long", "architecture, states", MID),
]


def main():
    figure = Drawing("The chain of proofs from reported positions to a permit", 330)
    figure.text(8, 18, "Each step covers all that the step before leaves possible", 13, bold=True)
    for at, (words, page, fill) in enumerate(CHAIN):
        y = 34 + at * 37
        figure.label(8, y, 400, 25, words, fill)
        figure.text(424, y + 17, page, 12, fill=GREY)
        if at:
            figure.line((208, y - 12), (208, y), head=True)
    figure.text(8, 314, "Fewer pairs and triangles: travel. Coarser surfaces: simplified."
                " Time: architecture, timing.", 11)
    figure.save(__file__)


if __name__ == "__main__":
    main()
