#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws descent.svg: how one query descends over two trees to pairs of triangles."""
from drawing import DARK, GREY, MID, PALE, PAPER, STOP, WARM, Drawing

STEPS = [  # what is tested, in words; what one entry of its list is
    ("Pair of nodes", "children of B against A's own box,\nchildren of A against B's own box,\n"
     "then every child left against every other", "node pairs"),
    ("Pair of leaves, at most 32 x 32", "move A's triangles once, round once; drop\n"
     "triangles whose tight boxes are apart", "leaf pairs"),
    ("Pairs of triangles, all lanes",
     "17 axes from shared products,\none bound for each kind of axis",
     "triangle pairs"),
    ("Pairs of triangles that are left", "each axis by itself; the direction between\n"
     "closest points, where r > 0 or thin", "triangle pairs"),
    ("Recheck", "the same in double,\non vertices that were not rounded", "rechecks"),
]
PICTURE, TEXT, WIDTH, FAR, HEIGHT, FIRST = 8, 150, 292, 486, 82, 36


def nodes(figure, y):
    figure.shape([(PICTURE + 8, y + 30), (PICTURE + 52, y + 12), (PICTURE + 68, y + 48),
                  (PICTURE + 24, y + 66)], PALE)
    figure.box(PICTURE + 56, y + 24, 56, 40, MID)
    figure.text(PICTURE + 22, y + 42, "A", 11, bold=True)
    figure.text(PICTURE + 92, y + 48, "B", 11, bold=True)
    for at in range(3):
        figure.box(PICTURE + 60 + at * 17, y + 28, 13, 12, PAPER if at else WARM)


def leaves(figure, y):
    for at in range(4):
        x = PICTURE + 14 + at * 14
        figure.shape([(x, y + 62), (x + 12, y + 62), (x + 7, y + 40 - at * 5)],
                     WARM if at > 1 else PAPER)
    for at in range(4):
        x = PICTURE + 58 + at * 14
        figure.shape([(x, y + 10), (x + 12, y + 10), (x + 5, y + 30 + (3 - at) * 5)],
                     WARM if at < 2 else PAPER)


def triangles(figure, y, gap, bound):
    figure.shape([(PICTURE + 10, y + 62), (PICTURE + 52 - gap, y + 44), (PICTURE + 24, y + 16)],
                 PALE)
    figure.shape([(PICTURE + 112, y + 20), (PICTURE + 64 + gap, y + 36), (PICTURE + 104, y + 64)],
                 MID)
    middle = PICTURE + 58
    figure.box(middle - bound, y + 10, 2 * bound, 58, "none", STOP, "3 2")
    figure.line((middle, y + 10), (middle, y + 68), stroke=DARK)


def main():
    figure = Drawing("One query: from a pair of trees to certified pairs of triangles", 478)
    figure.text(8, 18, "One query: what is not proven far goes one step down", 13, bold=True)
    for at, (name, words, unit) in enumerate(STEPS):
        y = FIRST + at * HEIGHT
        figure.box(TEXT, y, WIDTH, 66, PAPER)
        figure.text(TEXT + 8, y + 16, name, 12, bold=True)
        figure.text(TEXT + 8, y + 32, words, 11)
        figure.line((TEXT + WIDTH, y + 24), (FAR + 32, y + 24), head=True)
        figure.text(TEXT + WIDTH + 4, y + 42,
                    "list of\n" + unit.replace("triangle ", "triangle\n"), 11, fill=GREY)
        if at < len(STEPS) - 1:
            figure.line((TEXT + 60, y + 66), (TEXT + 60, y + HEIGHT), head=True)
    nodes(figure, FIRST)
    leaves(figure, FIRST + HEIGHT)
    for at, (gap, bound) in enumerate(((0, 3), (0, 2), (4, 1)), 2):
        triangles(figure, FIRST + at * HEIGHT, gap, bound)
    end = FIRST + len(STEPS) * HEIGHT
    figure.label(FAR + 32, FIRST, 66, end - FIRST - 16, "dropped:\nproven\nmore\nthan r\napart",
                 MID,
                 12)
    figure.label(TEXT, end, WIDTH, 24, "a pair left here, or a full list: not proven", WARM, 12,
                 stroke=STOP)
    figure.line((TEXT + 60, end - 16), (TEXT + 60, end), head=True)
    figure.label(FAR, end, 98, 24, "none left: far", MID, 12, bold=True)
    figure.save(__file__)


if __name__ == "__main__":
    main()
