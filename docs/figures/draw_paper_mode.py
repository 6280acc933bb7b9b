#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws paper-mode.svg: a pose of eight pairs by every way, from the records of bench --paper."""
import json
import math
import pathlib

from drawing import DARK, GREY, MID, RULE, Drawing

RECORDS = pathlib.Path(__file__).resolve().parents[1] / "measurements"
LEFT, RIGHT, FIRST_US, LAST_US = 186, 560, 1, 10_000
# Name in the records, name in the figure, is it certified.
WAYS = [("CPU naive", "CPU naive", False), ("GPU naive", "GPU naive", False),
        ("GPU techniques", "GPU, the paper's techniques", False),
        ("CPU certified", "CPU certified, every pair", True),
        ("GPU certified, 8 a launch", "GPU certified, every pair", True),
        ("CUDA engine, 8 a batch", "CUDA engine", True), ("CPU engine", "CPU engine", True)]


def pose_us(name):
    record = json.loads((RECORDS / name).read_text())
    return {method["name"]: method["pose"]["avg_us"] for method in record["methods"]}


def place(us):
    share = math.log(us / FIRST_US) / math.log(LAST_US / FIRST_US)
    return LEFT + share * (RIGHT - LEFT)


def main():
    whole, eight = pose_us("paper-whole.json"), pose_us("paper-eight.json")
    figure = Drawing("Time of eight pairs of bodies by the paper's ways and ours", 318)
    figure.text(8, 18, "Eight pairs of bodies, yes or no: us a pose, average", 13, bold=True)
    for us in (1, 10, 100, 1000, 10_000):
        figure.line((place(us), 30), (place(us), 268), stroke=RULE)
        figure.text(place(us), 283, f"{us:,}", 11, "middle")
    y = 36
    for name, words, is_certified in WAYS:
        figure.text(8, y + 15, words, 11)
        figure.box(LEFT, y, place(whole[name]) - LEFT, 13, DARK if is_certified else MID, "none")
        figure.text(place(whole[name]) + 4, y + 11, f"{whole[name]:,.4g}" if whole[name] < 1000
                    else f"{whole[name]:,.0f}", 11)
        if not name.startswith("CPU"):
            figure.box(LEFT, y + 14, place(eight[name]) - LEFT, 9, "none",
                       DARK if is_certified else GREY)
        y += 33
    figure.text(8, 300, "Dark: certified. Pale: not certified. Full bar: whole H200 or one core;"
                " outline: 8 multiprocessors.", 11, fill=GREY)
    figure.text(8, 313, "The scale is logarithmic. The paper's K20c, its own shapes: 6,045 us.",
                11, fill=GREY)
    figure.save(__file__)


if __name__ == "__main__":
    main()
