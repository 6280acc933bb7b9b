#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws motion.svg: a rounded corner, and a speed profile before and after averaging."""
from drawing import DARK, GREY, MID, STOP, Drawing

SIZE, CORNER = 120, (180, 62)


def rise(x):
    """R(x d)/d: the second integral of 15/16 (1 - x^2)^2 from -1."""
    first = x - 2 * x ** 3 / 3 + x ** 5 / 5
    second = x * x / 2 - x ** 4 / 6 + x ** 6 / 30
    return 15 / 16 * (second + 8 / 15 * x + 8 / 15 - (1 / 2 - 1 / 6 + 1 / 30)) if first else 0.15625


def blend(figure):
    d = SIZE
    figure.line((30, CORNER[1] + 150), CORNER, (CORNER[0] + 150, CORNER[1] + 90), stroke=GREY,
                dash="4 3")
    into, out = (0.707, -0.707), (0.857, 0.514)
    points = []
    for at in range(-20, 21):
        u = at / 20
        points.append(tuple(CORNER[k] + into[k] * u * d + (out[k] - into[k]) * rise(u) * d
                            for k in range(2)))
    figure.line(*points, stroke=DARK, width=2.2)
    for point in (points[0], points[-1]):
        figure.circle(*point, 4, MID, DARK)
    figure.line(CORNER, points[20], stroke=STOP, width=1.6)
    figure.text(CORNER[0], CORNER[1] - 10, "programmed corner p", 11, "middle")
    figure.text(CORNER[0], points[20][1] + 30, "missed by\n5/32 d |t_out - t_in|", 11, "middle",
                fill=STOP)
    figure.text(points[0][0] + 14, points[0][1] + 8, "d before", 11)
    figure.text(points[-1][0] - 20, points[-1][1] + 20, "d behind", 11)


def speed(figure):
    left, bottom, top, smooth = 360, 200, 64, 34
    plan = [min(1, t / 50, max(0, (200 - t) / 50)) for t in range(0, 235)]
    real = [sum(plan[max(0, t - smooth + 1):t + 1]) / smooth for t in range(0, 235)]
    figure.line((left, bottom), (594, bottom), head=True)
    figure.line((left, bottom), (left, top - 14), head=True)

    def points(values):
        return [(left + t * 0.98, bottom - v * (bottom - top)) for t, v in enumerate(values)][::3]
    figure.line(*points(plan), stroke=GREY, dash="4 3")
    figure.line(*points(real), stroke=DARK, width=2.2)
    figure.text(left - 4, top - 20, "path speed", 11, "middle", fill=GREY)
    figure.text(592, bottom + 16, "time", 11, "end", fill=GREY)
    figure.text(left + 100, top - 8, "V", 12, "middle", True)
    figure.text(left + 102, bottom - 40, "dashed: s0', |s0''| <= A\nsolid: its average over T\n"
                "jerk <= 2 A / T", 11, "middle")


def main():
    figure = Drawing("Motion: a corner rounded by a kernel, a speed averaged over T", 232)
    figure.text(8, 18, "Two averages keep every axis within speed, acceleration and jerk", 13,
                bold=True)
    blend(figure)
    speed(figure)
    figure.save(__file__)


if __name__ == "__main__":
    main()
