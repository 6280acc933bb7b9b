# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of records from the tables beside them and in docs/measurements:
    python3 -B docs/figures/records.py [FOLDER]     writes NAME.svg to FOLDER [docs/figures]
"""
import collections
import csv
import math
import pathlib
import sys

FIGURES = pathlib.Path(__file__).resolve().parent
sys.path.append(str(FIGURES.parents[1] / "hil_replay/plan"))
from figure_page import BLUE, GOLD, GREY, INK, PALE, PX, RED, Page, ticks, wide_page
from draw_plan import plan_page

MEASUREMENTS = FIGURES.parent / "measurements"


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def model_levels():
    """The figure of `axguard check --plan` of the fine machine."""
    return plan_page(rows_of(FIGURES / "model-levels.csv"), {
        "machine": "fine", "device": "one core, avx512",
        "scene": "300 positions spread over the travel, 59 approaches to a stop; each time the "
                 "least of 2 passes; one core, avx512"})


def bars(axes, values, width, colour):
    """Counts of the values in bins of a width."""
    bins = collections.Counter(math.floor(value / width) for value in values)
    axes.bar([width * (at + 0.5) for at in bins], bins.values(), 0.9 * width, color=colour)
    axes.grid(False, axis="x")


def live_latency():
    """How long after the last frame of a sample its answer was on the bus, in the guest."""
    rows = rows_of(FIGURES / "live-latency.csv")
    permits = [int(row["us"]) for row in rows if row["answer"] == "permit"]
    stop = max(int(row["us"]) for row in rows if row["answer"] == "stop")
    page, axes = wide_page(
        380, f"axguardd on vcan, user-mode Linux: N = {len(permits)} permits, the latest after "
        f"{max(permits)} us; 3/N = {3 / len(permits):.1g}; the stop after {stop} us", [], 60,
        size=13)
    bars(axes, permits, 10, BLUE)
    axes.set(yscale="log", xlim=(0, 1000), ylim=(0.5, 1000), ylabel="permits",
             xlabel="us from the last frame of a sample to its answer, both stamped by the kernel "
                    "(bins of 10)")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.axvline(stop, 0, 0.9, color=RED, linewidth=2 * PX)
    axes.text(stop + 8, 0.85, "the stop", color=RED, transform=axes.get_xaxis_transform())
    return page


def stop_distance():
    """How early an approach is stopped."""
    rows = rows_of(MEASUREMENTS / "stop-distance.csv")
    page = Page(1200, 360)
    page.text(600, 342, "Stopped earlier than a straight stop from 10 m/min needs, 100 approaches "
              "each")
    for at, (guard, width, x_range, words, colour) in enumerate((
            ("ahead", 0.02, (0, 0.5), "mm, ahead and path kept (bins of 0.02)", BLUE),
            ("ahead-independent", 0.05, (-0.5, 2),
             "mm, ahead, each axis by itself (0.05; one of 14.2)", GOLD),
            ("state", 0.5, (0, 23), "mm, positions alone (bins of 0.5)", RED))):
        axes = page.axes(60 + 400 * at, 56, 380 + 400 * at, 320)
        bars(axes, [float(row["excess_mm"]) for row in rows if row["guard"] == guard], width,
             colour)
        axes.set(xlim=x_range, xlabel=words, ylabel="approaches")
    return page


def gpu_pays():
    """A cycle's median (lines) and p99 (dashes, third panel)."""
    rows = rows_of(MEASUREMENTS / "gpu-pays.csv")
    page = Page(1400, 440)
    page.text(700, 422, "A cycle on one CPU core, and on a GPU")
    for at, (x, others, words) in enumerate((
            ("questions", {"triangles": 248832, "margin_mm": 1},
             "questions a cycle (248,832 triangles, margin 1 mm)"),
            ("triangles", {"questions": 512, "margin_mm": 1},
             "triangles of sixteen bodies (512 questions, margin 1 mm)"),
            ("margin_mm", {"questions": 512, "triangles": 248832},
             "margin, mm (512 questions, 248,832 triangles)"))):
        axes = page.axes(74 + 466 * at, 56, 444 + 466 * at, 406)
        is_margin = x == "margin_mm"
        for engine, title, colour in (("cpu", "CPU, 1 core", INK),
                                      ("gpu8", "GPU, 8 multiprocessors", RED),
                                      ("gpu16", "16", GOLD), ("gpu", "whole (132)", BLUE)):
            drawn = [row for row in rows if row["engine"] == engine and
                     all(float(row[key]) == value for key, value in others.items())]
            places = [float(row[x]) for row in drawn]
            axes.plot(places, [float(row["p50_us"]) for row in drawn], "o-", color=colour,
                      linewidth=2 * PX, markersize=7 * PX, label=title)
            if is_margin:
                axes.plot(places, [float(row["p99_us"]) for row in drawn], "o--", color=colour,
                          linewidth=PX, markersize=7 * PX, markerfacecolor="none")
        axes.set(xlabel=words)
        if is_margin:
            axes.set(xlim=(-0.04, 1.04), ylim=(0, 320),
                     ylabel="us a cycle, median (line) and p99 (dashes)")
        else:
            axes.set(xscale="log", yscale="log", xlim=((1, 1e4), (1e3, 1e6))[at],
                     ylim=(0.2, 2000), ylabel="us a cycle, median")
            axes.xaxis.set_major_formatter("{x:,.0f}")
            axes.yaxis.set_major_formatter("{x:g}")
        if at == 0:
            axes.legend(loc="upper left")
    return page


def simplified_sides():
    """How far a simplified surface is from the whole one, by surface."""
    rows = rows_of(FIGURES / "simplified-sides.csv")
    page = Page(1000, 720)
    page.text(500, 700, "How far a simplified surface is from the whole one: both sides, proven "
              "and sampled", 15)
    page.text(500, 48, "simplify_mm")
    page.text(12, 360, "mm", rotation=90)
    page.text(990, 360, "% of the triangles", rotation=90, color=GREY)
    page.text(500, 16, "1,000,000 points a side, and all corners; what was sampled below 0.01 mm "
              "is not drawn", 12)
    for at, name in enumerate(dict.fromkeys(row["surface"] for row in rows)):
        left, bottom = 65 + 317 * (at % 3), 396 - 296 * (at // 3)
        page.text(left + 121, bottom + 238, name, 13)
        right = page.axes(left, bottom, left + 242, bottom + 223)
        axes = page.axes(left, bottom, left + 242, bottom + 223)
        axes.patch.set_visible(False)
        of_surface = [row for row in rows if row["surface"] == name]
        right.set(xscale="log", xlim=(0.045, 0.45), ylim=(0, 100))
        right.vlines([float(row["simplify_mm"]) for row in of_surface], 0,
                     [100 * int(row["triangles"]) / int(row["whole_triangles"])
                      for row in of_surface], color=PALE, linewidth=6 * PX,
                     label="triangles left")
        right.grid(False)
        right.yaxis.tick_right()
        right.tick_params(axis="y", labelcolor=GREY)
        ticks(right.xaxis, {})
        ticks(right.yaxis, {str(share): share for share in (0, 25, 50, 75, 100)})
        right.spines["right"].set_visible(True)
        drawn = [row for row in of_surface if float(row["deviation_mm"]) > 0]
        for column, how in (
                ("deviation_mm", {"marker": "o", "color": BLUE,
                                  "label": "deviation, proven: how far the whole leaves the "
                                           "simplified"}),
                ("deviation_sampled_mm", {"marker": "x", "color": INK, "linestyle": "none"}),
                ("excess_mm", {"marker": "s", "color": RED, "linestyle": "--",
                               "label": "excess, proven: how far this sticks out"}),
                ("excess_sampled_mm", {"marker": "+", "color": INK, "linestyle": "none",
                                       "label": "× + sampled"})):
            axes.plot([float(row["simplify_mm"]) for row in drawn],
                      [float(row[column]) for row in drawn], linewidth=2 * PX,
                      markersize=8 * PX, **how)
        axes.set(xscale="log", yscale="log", xlim=(0.045, 0.45), ylim=(0.01, 0.5))
        ticks(axes.xaxis, {str(mm): mm for mm in (0.05, 0.1, 0.2, 0.4)})
        ticks(axes.yaxis, {str(mm): mm for mm in (0.01, 0.02, 0.05, 0.1, 0.2, 0.4)})
    handles = [*zip(*(each.get_legend_handles_labels() for each in (axes, right)))]
    page.figure.legend(sum(handles[0], []), sum(handles[1], []), loc="center", ncols=4,
                       bbox_to_anchor=(0.5, 668 / 720), fontsize=12 * PX, handlelength=1.5,
                       columnspacing=1)
    return page


def main():
    folder = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else FIGURES
    for draw in (model_levels, live_latency, stop_distance, gpu_pays, simplified_sides):
        draw().save(folder / draw.__name__.replace("_", "-"), ("svg",))


if __name__ == "__main__":
    main()
