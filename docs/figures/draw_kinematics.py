#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws kinematics.svg: bodies and joints of three types of five-axis machine."""
from drawing import DARK, GREY, MID, PALE, PAPER, WARM, Drawing

MACHINES = [  # name, example, joints from the frame to the workpiece, and to the tool
    ("table-table", "paper-trunnion.yaml", "YXAC", "Z"),
    ("table-head", "table-spindle-tilting.yaml", "XC", "YZB"),
    ("head-head", "spindle-tilting.yaml", "X", "YZCB"),
]
PANEL, ROTARY = 196, "ABC"


def turn(figure, x, y, axis):
    """A rotary axis seen from the side: an arc with a head."""
    figure.add("path", d=f"M{x - 13},{y} a13,5 0 1 1 20,4", fill="none", stroke=DARK,
               stroke_width="1.6", marker_end="url(#head)")
    figure.text(x + 24, y + 4, axis, 11, bold=True, fill=DARK)


def tilt(figure, x, y, axis):
    figure.add("path", d=f"M{x - 10},{y + 8} a13,13 0 1 1 20,0", fill="none", stroke=DARK,
               stroke_width="1.6", marker_end="url(#head)")
    figure.text(x + 18, y - 4, axis, 11, bold=True, fill=DARK)


def tool(figure, x, y, lean=0):
    """A spindle with its cutter, its top at (x, y)."""
    figure.shape([(x - 13, y), (x + 13, y), (x + 13 + lean, y + 34), (x - 13 + lean, y + 34)], MID)
    figure.shape([(x - 4 + lean, y + 34), (x + 4 + lean, y + 34), (x + 3 + lean * 1.6, y + 56),
                  (x - 3 + lean * 1.6, y + 56)], PAPER)


def pictures(figure):
    x = 8  # table-table: cradle and plate below a plain head
    tool(figure, x + 90, 46)
    figure.shape([(x + 30, 146), (x + 44, 112), (x + 54, 112), (x + 54, 132), (x + 126, 132),
                  (x + 126, 112), (x + 136, 112), (x + 150, 146)], WARM)
    figure.box(x + 62, 122, 56, 10, MID)
    turn(figure, x + 92, 117, "C")
    tilt(figure, x + 146, 108, "A")
    x += PANEL  # table-head
    tool(figure, x + 90, 48, -12)
    tilt(figure, x + 90, 52, "B")
    figure.box(x + 52, 128, 76, 10, MID)
    figure.box(x + 34, 138, 112, 10, WARM)
    turn(figure, x + 92, 122, "C")
    x += PANEL  # head-head
    figure.box(x + 76, 40, 28, 12, WARM)
    tool(figure, x + 90, 58, -14)
    tilt(figure, x + 90, 66, "B")
    turn(figure, x + 132, 46, "C")
    figure.box(x + 34, 132, 112, 14, WARM)


def joint(figure, x, y, axis):
    if axis in ROTARY:
        figure.circle(x, y, 13, MID)
    else:
        figure.box(x - 15, y - 11, 30, 22, PALE)
    figure.text(x, y + 4, axis, 12, "middle", True)


def chain(figure, x, joints, name):
    """Joints above the frame; the body at the end has the name."""
    y = 358
    for axis in joints:
        figure.line((x, y), (x, y - 18), width=2.4)
        y -= 29
        joint(figure, x, y, axis)
        y -= 12
    figure.line((x, y), (x, y - 8), width=2.4)
    figure.label(x - 42, y - 30, 84, 22, name, PAPER, 11)


def main():
    figure = Drawing("Bodies and joints of three types of five-axis machine", 438)
    figure.text(8, 18, "The joints between two bodies decide how they move against each other", 13,
                bold=True)
    pictures(figure)
    for at, (name, example, work, spindle) in enumerate(MACHINES):
        x = 8 + at * PANEL
        chain(figure, x + 46, work, "workpiece")
        chain(figure, x + 138, spindle, "cutter")
        figure.label(x + 6, 358, 172, 22, "frame", WARM, 11)
        figure.text(x + 92, 396, name, 12, "middle", True)
        figure.text(x + 92, 411, example, 11, "middle", fill=GREY)
    figure.text(8, 429, "Box: linear joint (mm). Circle: rotary joint (rad). Thick: the joint path"
                " from workpiece to cutter.", 11)
    figure.save(__file__)


if __name__ == "__main__":
    main()
