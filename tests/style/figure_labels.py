#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""In the charts of axguard-lab, no two labels overlap and none leaves the picture.

Widths are estimates for Arial; what overlaps by less than SLACK pixels each way is not seen.
"""
import pathlib
import re
import sys

from sources import finish

CHARTS = ("speed-accuracy.svg", "cycle-accuracy.svg", "model-curve.svg")
SLACK = 2.0
NARROW, WIDE = set("iljtfrI.,:;'|()[]! "), set("mwMW%@")
LABEL = re.compile(r'<text style="([^"]*)"([^>]*)>(.*?)</text>', re.S)
SIZE = re.compile(r"(?:bold )?(\d[\d.]*)px")
ANCHOR = re.compile(r"text-anchor: (\w+)")
PLACE = re.compile(r'rotate\((-?[\d.]+) ([\d.-]+) ([\d.-]+)\)')
MOVED = re.compile(r'translate\(([\d.-]+) ([\d.-]+)\)')


def width_of(words, size, is_bold):
    units = sum(0.3 if c in NARROW else 0.85 if c in WIDE else 0.56 for c in words)
    return units * size * (1.07 if is_bold else 1.0)


def boxes_of(svg):
    """(words, left, top, right, bottom) of each label."""
    for style, attributes, words in LABEL.findall(svg):
        words = words.replace("&#39;", "'").replace("&lt;", "<").replace("&amp;", "&").strip()
        turned = PLACE.search(attributes)
        turn, x, y = map(float, turned.groups() if turned else
                         ("0", *MOVED.search(attributes).groups()))
        anchor = ANCHOR.search(style)
        size = float(SIZE.search(style)[1])
        wide = width_of(words, size, "bold" in style)
        before = {"start": 0, "middle": wide / 2, "end": wide}[anchor[1] if anchor else "start"]
        if turn:  # upwards
            yield words, x - 0.8 * size, y - (wide - before), x + 0.2 * size, y + before
        else:
            yield words, x - before, y - 0.8 * size, x - before + wide, y + 0.2 * size


def faults_in(name, svg):
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', svg)
    boxes = list(boxes_of(svg))
    if not size or not boxes:
        yield f"{name}: no labels found"
        return
    for i, (words, left, top, right, bottom) in enumerate(boxes):
        if left < -SLACK or top < -SLACK or right > float(size[1]) + SLACK \
                or bottom > float(size[2]) + SLACK:
            yield f"{name}: \"{words}\" leaves the picture"
        for other, l, t, r, b in boxes[i + 1:]:
            if min(right, r) - max(left, l) > SLACK and min(bottom, b) - max(top, t) > SLACK:
                yield f"{name}: \"{words}\" and \"{other}\" overlap"


def main():
    folder = pathlib.Path(sys.argv[1]) / "docs/figures"
    faults = []
    for name in CHARTS:
        path = folder / name
        if path.exists():
            faults += faults_in(name, path.read_text(encoding="utf-8"))
        else:
            faults.append(f"docs/figures/{name}: missing; axguard-lab chart draws it")
    finish(faults)


if __name__ == "__main__":
    main()
