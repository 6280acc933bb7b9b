# SPDX-License-Identifier: Apache-2.0
"""Shared pieces of the figures that draw_*.py draw from the tables of a folder.

The same tables make the same SVG. conditions.csv holds the values that captions state, as rows of
name and value.
"""
import csv
import io
import os
import pathlib
import sys

NO_MATPLOTLIB = 9
try:
    import matplotlib
    from matplotlib.figure import Figure
except ImportError:
    sys.exit(NO_MATPLOTLIB)

# Okabe and Ito's colours, which people who see few colours tell apart; in grey they differ too.
INK, GREY, PALE, FAINT = "#202020", "#8a8a8a", "#dddddd", "#eeeeee"
BLUE, RED, GREEN, GOLD, SKY = "#0b5394", "#d55e00", "#009e73", "#e69f00", "#56b4e9"
FAMILY, QUOTED = "DejaVu Sans", b"'DejaVu Sans'"
NO_METADATA = {"svg": ("Creator", "Date"), "png": ("Software",)}  # would differ between hosts
PX = 0.75  # points: lengths below are pixels of 1/96 inch
matplotlib.rcParams.update({
    "axes.axisbelow": True, "axes.edgecolor": GREY, "axes.grid": True, "axes.labelcolor": INK,
    "axes.labelsize": 14 * PX, "axes.spines.right": False, "axes.spines.top": False,
    "font.family": FAMILY, "font.size": 14 * PX, "grid.color": PALE, "grid.linewidth": 0.5,
    "legend.edgecolor": "none", "legend.framealpha": 0.9, "svg.fonttype": "none",
    "svg.hashsalt": "axguard", "text.color": INK, "text.parse_math": False,
    "xtick.color": GREY, "xtick.direction": "in", "xtick.labelcolor": INK,
    "ytick.color": GREY, "ytick.direction": "in", "ytick.labelcolor": INK})


class Page:
    """A figure; text is placed in pixels from the lower left corner."""

    def __init__(self, width, height, png_scale=1):
        self.width, self.height, self.png_scale = width, height, png_scale
        self.figure = Figure(figsize=(width / 96, height / 96))

    def text(self, x, y, words, size=14, **how):
        how = {"ha": "center", "va": "center_baseline", "rotation_mode": "anchor", **how}
        self.figure.text(x / self.width, y / self.height, words, fontsize=size * PX, **how)

    def axes(self, left, bottom, right, top):
        axes = self.figure.add_axes([left / self.width, bottom / self.height,
                                     (right - left) / self.width, (top - bottom) / self.height])
        axes.tick_params(length=5 * PX, which="major")
        axes.tick_params(length=0, which="minor", labelleft=False, labelbottom=False)
        return axes

    def save(self, path, kinds=("svg", "png")):
        """A file gets its name only when it is complete."""
        for kind in kinds:
            drawn = io.BytesIO()
            self.figure.savefig(drawn, format=kind, dpi=96 * self.png_scale,
                                metadata=dict.fromkeys(NO_METADATA[kind]))
            data = drawn.getvalue()
            if kind == "svg":
                data = data.replace(QUOTED, QUOTED + b", Arial, sans-serif")
            part = pathlib.Path(f"{path}.{kind}.part")
            part.write_bytes(data)
            os.replace(part, f"{path}.{kind}")


def ticks(axis, places):
    """Places the labelled ticks {label: value} that are in the axis' range."""
    low, high = sorted(axis.get_view_interval())
    places = {words: at for words, at in places.items() if low <= at <= high}
    axis.set_ticks(list(places.values()), list(places))


def wide_page(height, title, beneath, bottom=105, right=25, top=58, size=17):
    """A page of 1000 px with one panel, its title and a caption under it; margins of the panel."""
    page = Page(1000, height)
    page.text(500, height - 26, title, size)
    for line, words in enumerate(reversed(beneath)):
        page.text(500, 22 + 15 * line, words, 12)
    return page, page.axes(85, bottom, 1000 - right, height - top)


class Tables:
    def __init__(self, folder):
        self.folder = folder
        self.conditions = {row["name"]: row["value"] for row in self.rows("conditions")}

    def path(self, name):
        return self.folder / f"{name}.csv"

    def rows(self, name):
        with open(self.path(name), encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))


def draw(figures):
    """Draws NAME.svg and NAME.png in the folder that the command line names.

    figures: {NAME: (table without which it is not drawn, function of the tables)}
    """
    tables = Tables(pathlib.Path(sys.argv[1]))
    for name, (table, page_of) in figures.items():
        if tables.path(table).exists():
            page_of(tables).save(tables.folder / name)
