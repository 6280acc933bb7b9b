# SPDX-License-Identifier: Apache-2.0
"""Draws the figure of `axguard check --plan`: python3 draw_plan.py FOLDER

Time of a cycle, and how much earlier stops come, against the inflation of a model.
"""
from figure_page import BLUE, GREEN, PX, RED, draw, wide_page  # first: ends without matplotlib
from matplotlib.ticker import LogLocator, NullFormatter


def plan_page(rows, scene):
    page, axes = wide_page(620, f"{scene['machine']}: time of a cycle against inflation, "
                           f"{scene['device']}", [scene["scene"]],
                           right=80, top=84)
    stoppable = "trace" if float(rows[0]["trace_max_us"]) > 0 else "rest"

    def curve(on, column, colour, marker, words, line="-", face=None):
        on.plot([float(row["inflation_mm"]) for row in rows], [float(row[column]) for row in rows],
                color=colour, marker=marker, markersize=7 * PX, linewidth=2 * PX, linestyle=line,
                markerfacecolor=face or colour, label=words)

    curve(axes, f"{stoppable}_p99_us", BLUE, "o", "stoppable, p99")
    curve(axes, f"{stoppable}_max_us", BLUE, "o", "stoppable, slowest", "--", "none")
    curve(axes, "contact_p99_us", GREEN, "s", "contact mode, p99")
    right = axes.twinx()
    curve(right, "earlier_mm_p50", RED, "^", "a stop comes earlier (right)")
    axes.set(yscale="log", xlabel="inflation of a pair, mm (both certified deviations)",
             ylabel="us a cycle")
    axes.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    right.set_ylim(0)
    right.set_ylabel("a stop comes so much earlier, mm of way (median)", color=RED)
    right.tick_params(color=RED, labelcolor=RED)
    right.grid(False)
    right.spines["right"].set_visible(True)
    lines = axes.get_lines() + right.get_lines()
    axes.legend(lines, [line.get_label() for line in lines], loc="lower center", ncols=4,
                bbox_to_anchor=(0.5, 1), fontsize=13 * PX)
    return page


if __name__ == "__main__":
    draw({"plan": ("plan", lambda tables: plan_page(tables.rows("plan"), tables.conditions))})
