# SPDX-License-Identifier: Apache-2.0
"""A figure of panels, one above the other, that share a logarithmic axis of time.

One mark a method, its label in the nearest free place. 600 px wide, so that text appears at its
drawn size; marks differ in shape, not only in colour. Right is slower, up is worse.
"""
import math

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from figure_page import BLUE, FAMILY, GREEN, GREY, INK, PX, RED, Page, ticks

MARKS = {  # style: colour, marker, size, whether it is filled
    "ours": (BLUE, "s", 7, True), "paper": (INK, "D", 8, True), "other": (RED, "o", 7, True),
    "double": (RED, "o", 7, False), "predicted": (BLUE, "^", 8, False)}
BOLD_STYLES = ("ours", "paper")
AWAY_PX, DIRECTIONS = (4, 10, 18, 28, 40, 55, 75, 100, 130), 24
LEADER_PX = 14  # beyond it, a line from mark to text is needed
MARK_PX, LINE_PX = 6, 15
LEFT, RIGHT = 92, 585  # of the panels on a page of 600 px


def plot_mark(axes, x, y, style, **how):
    colour, marker, size, is_filled = MARKS[style]
    axes.plot([x], [y], linestyle="none", marker=marker, markersize=size * PX, color=colour,
              markerfacecolor=colour if is_filled else "none", markeredgewidth=1.5 * PX, **how)


def text_width(words, size, is_bold):
    font = FontProperties(family=FAMILY, size=size, weight="bold" if is_bold else "normal")
    return text_to_path.get_text_width_height_descent(words, font, False)[0]


def overlap(box, others):
    """Area that a box (left, bottom, right, top) shares with each of the others."""
    wide = np.minimum(box[2], others[:, 2]) - np.maximum(box[0], others[:, 0])
    high = np.minimum(box[3], others[:, 3]) - np.maximum(box[1], others[:, 1])
    return np.maximum(wide, 0) * np.maximum(high, 0)


def away_from(box, x, y):
    return math.hypot(max(box[0] - x, x - box[2], 0), max(box[1] - y, y - box[3], 0))


def place_labels(labels, frame, taken):
    """Places labels (x and y of the mark, width) without overlap; returns (box, needs a line).

    Greedy: each gets the free place nearest to its mark, the most crowded mark first.
    """
    taken = list(taken) + [(x - MARK_PX, y - MARK_PX, x + MARK_PX, y + MARK_PX)
                           for x, y, _ in labels]
    frame = np.array([frame])

    def crowd(i):
        return -sum(1 / (20 + math.hypot(x - labels[i][0], y - labels[i][1]))
                    for x, y, _ in labels)

    def places(x, y, width):
        for away in AWAY_PX:
            for turn in np.arange(DIRECTIONS) * math.tau / DIRECTIONS:
                c, s = math.cos(turn), math.sin(turn)
                at_x = x + (MARK_PX + away) * c + width / 2 * max(-1, min(2 * c, 1))
                at_y = y + (MARK_PX + away) * s + LINE_PX / 2 * max(-1, min(2 * s, 1))
                yield away, (at_x - width / 2, at_y - LINE_PX / 2, at_x + width / 2,
                             at_y + LINE_PX / 2)

    placed = {}
    for i in sorted(range(len(labels)), key=crowd):
        x, y, width = labels[i]
        least, occupied = math.inf, np.array(taken)
        for away, box in places(x, y, width):
            fault = 2 * (width * LINE_PX - overlap(box, frame)[0]) + overlap(box, occupied).sum()
            if fault < least - 1e-6:
                least, best, best_away = fault, box, away
            if least < 1e-6:
                break
        near = away_from(best, x, y) + LEADER_PX
        placed[i] = best, best_away > LEADER_PX or any(
            (ox, oy) != (x, y) and away_from(best, ox, oy) < near for ox, oy, _ in labels)
        taken.append(best)
    return [placed[i] for i in range(len(labels))]


def along(a, b):
    """Small boxes along a line, so that no label covers it."""
    for t in np.linspace(0, 1, 61):
        x, y = a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])
        yield x - 2, y - 2, x + 2, y + 2


def pareto_of(marks):
    """Marks that no other measured one beats in both time and height, from left to right."""
    out = []
    for mark in sorted(marks, key=lambda mark: mark[:2]):
        if mark[2] != "predicted" and (not out or mark[1] < out[-1][1]):
            out.append(mark)
    return out


class Scatter:
    """Marks are (x, y, style, words); empty words make no label."""

    def __init__(self, height, title, x_label, x_range, x_ticks, legend, beneath):
        self.page = Page(600, height, png_scale=2)
        self.x_label, self.x_range, self.x_ticks = x_label, x_range, x_ticks
        self.page.text(300, height - 20, title, 16, weight="bold")
        self.axes = None
        for line, (style, words) in enumerate(legend):
            y = height - 44 - 18 * line
            self.page.text(LEFT + 22, y, words, 12, ha="left")
            plot_mark(self.whole_page(), LEFT + 6, y, style)
        for line, words in enumerate(reversed(beneath)):
            self.page.text(300, 10 + 15 * line, words, 12)

    def whole_page(self):
        """Axes over the whole page whose unit is a pixel; legend marks and lines to labels."""
        if self.axes is None:
            self.axes = self.page.axes(0, 0, self.page.width, self.page.height)
            self.axes.set(xlim=(0, self.page.width), ylim=(0, self.page.height))
            self.axes.axis("off")
            self.axes.patch.set_visible(False)
        return self.axes

    def panel(self, bottom, top, title, y_label, y_range, y_ticks, marks, joined=(),
              better_y=0.03, wall=None):
        """bottom, top: shares of the height; joined: pairs of marks; wall: place and words."""
        height = self.page.height
        bottom, top = bottom * height, top * height
        axes = self.page.axes(LEFT, bottom, RIGHT, top)
        axes.patch.set_visible(False)  # the lines to labels are below
        axes.set(xscale="log", yscale="log", xlim=self.x_range, ylim=y_range)
        ticks(axes.xaxis, self.x_ticks)
        ticks(axes.yaxis, y_ticks)
        self.page.text(LEFT, top + 14, title, 14, ha="left", weight="bold")
        self.page.text(14, (bottom + top) / 2, y_label, rotation=90)
        steps = pareto_of(marks)
        axes.step([mark[0] for mark in steps], [mark[1] for mark in steps], where="post",
                  color=BLUE, linestyle=":", linewidth=1.5 * PX, zorder=1.5)
        for a, b in joined:
            axes.plot([a[0], b[0]], [a[1], b[1]], color=GREY, linewidth=0.8 * PX, zorder=1.6)
        for style in MARKS:
            for x, y, _, _ in (mark for mark in marks if mark[2] == style):
                plot_mark(axes, x, y, style)

        def px(x, y):
            share_x, share_y = (min(max(math.log(value / low) / math.log(high / low), 0), 1)
                                for value, (low, high) in ((x, self.x_range), (y, y_range)))
            return LEFT + share_x * (RIGHT - LEFT), bottom + share_y * (top - bottom)

        taken = [box for a, b in joined for box in along(px(*a[:2]), px(*b[:2]))]
        for before, after in zip(steps, steps[1:]):
            corner = px(after[0], before[1])
            taken += [*along(px(*before[:2]), corner), *along(corner, px(*after[:2]))]
        taken += [(x - MARK_PX, y - MARK_PX, x + MARK_PX, y + MARK_PX)
                  for x, y in (px(*mark[:2]) for mark in marks if not mark[3])]
        if wall:
            (x, foot), words = px(wall[0], y_range[0]), wall[1]
            axes.axvline(wall[0], color=INK, linestyle="--", linewidth=2 * PX, zorder=1.4)
            self.page.text(x - 5, top - 11, words, 12, ha="right")
            taken += [*along((x, foot), (x, top)),
                      (x - text_width(words, 12, False) - 8, top - 20, x, top)]
        taken.append(self.better(LEFT + 0.03 * (RIGHT - LEFT), bottom + better_y * (top - bottom)))
        self.labels([(*px(*mark[:2]), *mark[2:]) for mark in marks if mark[3]],
                    (LEFT + 2, bottom + 2, 594, top - 2), taken)

    def better(self, x, y):
        """Points to the corner where a method is fast and loses nothing; returns its box."""
        self.whole_page().annotate("", (x, y), (x + 24, y + 18), arrowprops={
            "arrowstyle": "-|>", "color": GREEN, "linewidth": 2 * PX, "shrinkA": 0, "shrinkB": 0})
        self.page.text(x + 29, y + 11, "better", 12, ha="left", weight="bold", color=GREEN)
        return x - 6, y - 8, x + 84, y + 24

    def labels(self, marks, frame, taken):
        widths = [text_width(words, 12, style in BOLD_STYLES) + 8 for _, _, style, words in marks]
        places = place_labels([(mark[0], mark[1], width) for mark, width in zip(marks, widths)],
                              frame, taken)
        for (x, y, style, words), (box, needs_line) in zip(marks, places):
            middle = (box[1] + box[3]) / 2
            self.page.text(box[0] + 4, middle, words, 12, ha="left", color=MARKS[style][0],
                           weight="bold" if style in BOLD_STYLES else "normal")
            if needs_line:
                self.whole_page().plot(
                    [x, min(max(x, box[0]), box[2])], [y, middle + (7 if y > middle else -7)],
                    color=GREY, linewidth=0.7 * PX, zorder=0.5)

    def finish(self):
        self.page.figure.axes[-1].set_xlabel(self.x_label, labelpad=6)
        return self.page
