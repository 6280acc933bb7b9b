#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws certificate.svg: the reach of one axis to standstill, and the joint box of two."""
from drawing import DARK, GREY, MID, PALE, PAPER, STOP, WARM, Drawing

LEFT, BOTTOM, TOP = 44, 300, 52
HORIZON, PERMIT = 5.0, 3.0
STEP = 0.02


def motion(speed, acceleration, brake_at, deceleration):
    """Positions and times of an axis that accelerates, then brakes to rest."""
    points, position, time = [], 0.0, 0.0
    while speed > 0:
        points.append((time, position))
        position += speed * STEP
        speed += (acceleration if time < brake_at else -deceleration) * STEP
        time += STEP
    return points + [(time, position)]


def plot(figure, points, **style):
    kept = points[::12] + [points[-1]]
    figure.line(*((x_of(time), y_of(place)) for time, place in kept), **style)


def x_of(time):
    return LEFT + time * 23


def y_of(position):
    return BOTTOM - 40 - position * 7.6


def reach(figure):
    highest = motion(1.15, 0.2, HORIZON, 0.33)
    lowest = motion(0.95, -0.2, 0.0, 0.9)
    stops = [motion(1.05, 0.1, 1.2, 0.4), motion(1.1, 0.16, 3.2, 0.38),
             motion(1.1, 0.17, 4.8, 0.4)]
    end, top, low = 12.6, highest[-1][1], lowest[-1][1]
    outline = ([(x_of(t), y_of(p)) for t, p in highest[::12] + [highest[-1]]] +
               [(x_of(end), y_of(top)), (x_of(end), y_of(low))] +
               [(x_of(t), y_of(p)) for t, p in reversed(lowest[::12] + [lowest[-1]])])
    figure.shape(outline, PALE, "none")
    plot(figure, highest, width=1.8)
    plot(figure, lowest, width=1.8)
    figure.line((x_of(highest[-1][0]), y_of(top)), (x_of(end), y_of(top)), width=1.8)
    figure.line((x_of(lowest[-1][0]), y_of(low)), (x_of(end), y_of(low)), width=1.8)
    for stop in stops:
        plot(figure, stop, stroke=DARK, dash="4 3")
    figure.box(LEFT, TOP, x_of(end) - LEFT, 16, MID)
    figure.text(LEFT + 150, TOP + 12, "another body", 11, "middle")
    figure.line((LEFT, TOP + 34), (x_of(end), TOP + 34), stroke=STOP, dash="5 3", width=1.6)
    figure.text(LEFT + 6, TOP + 29, "its margin", 11, fill=STOP)
    figure.circle(x_of(0), y_of(0), 4, DARK)
    figure.line((x_of(end) + 8, y_of(low)), (x_of(end) + 8, y_of(top)), head=True, tail=True)
    figure.text(x_of(end) - 6, y_of(top) - 6, "reach", 12, "end", True)
    figure.text(x_of(7.6), y_of(3.4), "stops that\nmay happen", 11, fill=DARK)


def instants(figure):
    figure.line((LEFT, BOTTOM), (x_of(12.8), BOTTOM), head=True)
    figure.line((LEFT, BOTTOM), (LEFT, TOP), head=True)
    figure.text(8, 40, "position of one axis", 11, fill=GREY)
    for time, name, anchor in ((0, "sample k", "middle"), (PERMIT, "permit\nends", "middle"),
                               (HORIZON, "H: braking\nhas begun", None), (11.4, "rest", "middle")):
        figure.line((x_of(time), BOTTOM + 4), (x_of(time), BOTTOM - 6))
        figure.text(x_of(time) - (0 if anchor else 6), BOTTOM + 18, name, 11, anchor)
    for time in (PERMIT, HORIZON):
        figure.line((x_of(time), BOTTOM), (x_of(time), TOP + 36), stroke=GREY, dash="2 3")


def joint_box(figure):
    x, y, w, h = 400, 98, 176, 150
    figure.text(392, 40, "two axes: the joint box", 11, fill=GREY)
    figure.box(x, y, w, h, MID, width=1.8)
    figure.box(x + w / 2, y, w / 2, h, WARM)
    figure.box(x + w / 2, y + h / 2, w / 2, h / 2, MID)
    figure.box(x + w / 2, y, w / 4, h / 2, MID)
    figure.box(x + w * 3 / 4, y, w / 4, h / 2, MID)
    figure.box(x, y, w, h, "none", width=1.8)
    figure.circle(x + w / 4, y + h / 2, 3, DARK)
    figure.text(x + w / 4, y + h / 2 + 18, "proven by\none query", 11, "middle")
    figure.text(x + w * 3 / 4, y + h * 3 / 4 - 2, "cut into\nhalves", 11, "middle")
    figure.text(x + w / 2, y + h + 18, "reach of X", 11, "middle")
    figure.text(x, y - 8, "reach of Z", 11)
    figure.text(392, 292, "far at the centre by margin + motion\nin the box: far in all of the box",
                11)


def main():
    figure = Drawing("The certificate: reach of an axis from sample to rest, and the joint box",
                     350)
    figure.text(8, 18, "Whenever braking begins before H, the machine rests inside the box", 13,
                bold=True)
    reach(figure)
    instants(figure)
    joint_box(figure)
    figure.save(__file__)


if __name__ == "__main__":
    main()
