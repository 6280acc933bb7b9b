# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of `axguard-lab chart`: python3 draw_figures.py FOLDER

Each from the table of its name; the two failure maps from failure-map.csv.
"""
import itertools
import math
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "plan"))
# The first import of what needs matplotlib: it ends where that is missing.
from figure_page import (BLUE, FAINT, GOLD, GREEN, GREY, INK, PALE, PX, RED, SKY, Page, draw,
                         ticks, wide_page)
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, LogNorm

from scatter_panels import MARKS, Scatter

HEAT = ("#fdeec4", "#f5b041", "#d1480b")
ENGINE = "axguard engine"
METHOD_WORDS = {  # any other method's label is its kernel's name
    "certified-shared-f32": "axguard stage 1", "certified-f32": "axguard float",
    "certified-f32+f64": "axguard recheck", "paper-6-11": "seed paper",
    "sat17-normalised-eps": "17 axes, epsilon", "sat17": "17 axes", "sat11": "11 axes",
    "moller": "Möller", "held": "Held", "guigue-devillers": "Guigue-Devillers", "shen": "Shen",
    "tropp": "Tropp", "six-segment": "six segments", "pqp-distance": "PQP", "gjk": "GJK"}
LEAST_UM, NONE_UM = 1e-9, 1e-11  # smallest depth drawn (double rounds smaller ones away); none


def kernel_of(name):
    """The name without the suffixes for arithmetic and contraction."""
    return name.split("-f32")[0].split("-f64")[0]


def speed_accuracy(tables):
    """Time against contacts missed (the danger) and gaps undecided (the cost)."""
    rows = tables.rows("speed-accuracy")
    given = tables.conditions
    # The fastest build of each method on this processor: with FMA if the processor has it.
    fused = max(row["fused"] for row in rows)
    rows = [row for row in rows if row["certified"] == "1" or row["fused"] == fused]
    times = [float(row["ns_a_pair"]) for row in rows]
    pairs = int(rows[0]["intersecting"]) + int(rows[0]["apart"])
    scatter = Scatter(
        880, "Tests of two triangles: time against error",
        "mean time of a pair, touching or apart, whichever is slower",
        (min(times) / 1.5, max(times) * 1.6),
        {"5 ns": 5, "10": 10, "20": 20, "50": 50, "100 ns": 100, "200": 200, "500": 500,
         "1 µs": 1e3, "10 µs": 1e4, "100 µs": 1e5},
        [("ours", "axguard and exact arithmetic: proven, misses no contact"),
         ("paper", "the seed paper's test, float"),
         ("other", "other tests, float; number: contacts missed"),
         ("double", "the same in double")],
        [f"{pairs} pairs within 4 m and longer than 1 µm, of {given['pairs_of_each_kind']} of each "
         f"of {given['kinds']} kinds, seed {given['seed']}",
         f"{given['processor']}, least of {given['passes']} passes",
         "all compiled with FMA; axguard in lanes, others a pair at a time;",
         "dotted: no test is better in both"])

    def mark(row, um, is_any, count):
        name, is_ours = row["method"], row["certified"] == "1"
        is_double = not is_ours and "-f64" in name
        style = "ours" if is_ours else "double" if is_double else \
            "paper" if kernel_of(name) == "paper-6-11" else "other"
        words = METHOD_WORDS.get(name if is_ours else kernel_of(name), kernel_of(name))
        return (float(row["ns_a_pair"]), max(um, LEAST_UM) if is_any else NONE_UM, style,
                "" if is_double else f"{words} {count}" if count else words)

    missed = [mark(row, float(row["deepest_missed_um"]), int(row["missed"]), int(row["missed"]))
              for row in rows]
    # A guard stops both where a gap is undecided and where it is called a contact.
    undecided = [mark(row, max(float(row["widest_undecided_um"]),
                               float(row["farthest_false_hit_um"])),
                      int(row["undecided_apart"]) + int(row["false_hits"]), 0) for row in rows]
    same = [(i, j) for j in range(len(rows)) for i in range(j)
            if "1" not in (rows[i]["certified"], rows[j]["certified"])
            and kernel_of(rows[i]["method"]) == kernel_of(rows[j]["method"])]
    for title, y_label, marks, bottom, top, better_y in (
            ("Danger: contacts missed", "deepest contact missed", missed, 0.515, 0.83, 0.2),
            ("Cost: gaps not told from a contact", "widest gap undecided", undecided, 0.14, 0.455,
             0.04)):
        scatter.panel(bottom, top, title, y_label, (NONE_UM / 10, 1e6),
                      {"none": NONE_UM, "≤ 1 fm": LEAST_UM, "1 pm": 1e-6, "1 nm": 1e-3, "1 µm": 1,
                       "1 mm": 1e3, "1 m": 1e6},
                      marks, [(marks[i], marks[j]) for i, j in same], better_y)
    return scatter.finish()


def deadline(tables):
    us = tables.conditions["deadline_us"]
    return float(us), f"deadline, {us} µs"


def cycle_accuracy(tables):
    """Time of a whole cycle against its loss: contact (yes or no), and a stop in time."""
    scatter = Scatter(
        860, "Whole cycles: time against early stops",
        "time of a cycle of eight pairs; p99 unless stated", (0.1, 3e5),
        {"0.1": 0.1, "1 µs": 1, "10 µs": 10, "100 µs": 100, "1 ms": 1e3, "10 ms": 1e4,
         "100 ms": 1e5},
        [("ours", "axguard, proven"),
         ("paper", "the seed paper's test of every pair of triangles"),
         ("other", "other libraries, volumes, contact mode"),
         ("predicted", "predicted, not measured")],
        ["measured here: contact mode, positions only, longest cycle;",
         f"{tables.conditions['processor']}; the rest: records",
         "dotted: nothing is better in both"])
    panels = {"contact": [], "stop": []}
    for row in tables.rows("cycle-accuracy"):
        words, statistic = row["name"], row["statistic"]
        if statistic not in ("p99", "constructed"):
            words += f" ({statistic})"
        style = row["kind"] if row["kind"] in MARKS else "other"
        panels["contact" if row["panel"] == "contact" else "stop"].append(
            (float(row["us"]), max(float(row["early_mm"]), 0.01), style, words))
    scatter.panel(0.52, 0.83, "Is there a contact? (yes or no)", "clearance called contact",
                  (0.003, 3000),
                  {"none": 0.01, "0.1 mm": 0.1, "1 mm": 1, "10 mm": 10, "100 mm": 100},
                  panels["contact"], better_y=0.3, wall=deadline(tables))
    scatter.panel(0.13, 0.46, "Can it still stop in time?", "stops early by (median)",
                  (0.03, 30000),
                  {"0.1 mm": 0.1, "1 mm": 1, "10 mm": 10, "100 mm": 100, "touches": 1000},
                  panels["stop"], wall=deadline(tables))
    return scatter.finish()


def model_curve(tables):
    """The cost of a shorter cycle: model details of two machines."""
    scatter = Scatter(
        760, "What a shorter cycle costs: coarser models",
        "time of a certificate at rest, p99, one core", (200, 7000),
        {"200 µs": 200, "500 µs": 500, "1 ms": 1e3, "2 ms": 2e3, "5 ms": 5e3},
        [("ours", "a level of detail, by how far it may deviate"),
         ("other", "bends back: takes longer than a finer one")],
        ["lost: clear positions called contact, of 300 (fine) and 1,000 (real);",
         "records of docs/measurements/levels.md", "dotted: nothing is better in both"])
    for machine, bottom, top in (("fine", 0.53, 0.85), ("real", 0.14, 0.46)):
        rows = [row for row in tables.rows("model-curve") if row["machine"] == machine]
        marks = []
        for row in rows:
            words = f"{row['simplify_mm']} mm" if float(row["simplify_mm"]) else "whole"
            words += f", {row['lost']} lost" if float(row["lost"]) else ""
            bends_back = row["bends_back"] == "1"
            marks.append((float(row["rest_p99_us"]), max(float(row["earlier_mm"]), 0.03),
                          "other" if bends_back else "ours",
                          words + (", bends back" if bends_back else "")))
        scatter.panel(bottom, top,
                      f"The {machine} machine, {int(rows[0]['triangles']):,} triangles",
                      "a stop comes earlier by", (0.015, 6),
                      {"none": 0.03, "0.1 mm": 0.1, "0.3 mm": 0.3, "1 mm": 1, "3 mm": 3},
                      marks, list(zip(marks, marks[1:])), wall=deadline(tables))
    return scatter.finish()


# Maps: methods by kinds of pairs, coloured by the share of pairs.

def heat_of(darkest):
    return ScalarMappable(LogNorm(0.1, 100, clip=True),
                          LinearSegmentedColormap.from_list("", (*HEAT, darkest), 128))


def draw_cells(axes, cells, heat, half_width, half_height):
    """Cells are (column, row, percent)."""
    boxes = [[(x - half_width, y - half_height), (x + half_width, y - half_height),
              (x + half_width, y + half_height), (x - half_width, y + half_height)]
             for x, y, _ in cells]
    axes.add_collection(PolyCollection(boxes, facecolors=[heat.to_rgba(cell[2]) for cell in cells],
                                       linewidths=0))


def map_axes(page, left, bottom, right, top, columns, rows):
    axes = page.axes(left, bottom, right, top)
    axes.set(xlim=(-0.5, columns - 0.5), ylim=(len(rows) - 0.5, -0.5), xticks=[])
    axes.grid(False)
    ticks(axes.yaxis, {name: row for row, name in enumerate(rows)})
    axes.tick_params(length=0, labelsize=11 * PX)
    return axes


def kinds_in_order(rows):
    """All methods list the kinds of pairs in one order; some omit those without a fault."""
    kinds = []
    for _, of_method in itertools.groupby(rows, lambda row: row["method"]):
        following = len(kinds)
        for row in reversed(list(of_method)):
            if row["category"] in kinds:
                following = kinds.index(row["category"])
            else:
                kinds.insert(following, row["category"])
    return kinds


def failure_map(tables, title, deep, of_what, rate_of, depth_of):
    """Omits rows without a fault of any method, and the methods compiled with contraction."""
    methods = [row["method"] for row in tables.rows("speed-accuracy") if row["fused"] == "0"]
    rows = [row for row in tables.rows("failure-map") if row["method"] in methods]
    drawn = [(methods.index(row["method"]), row["category"], rate_of(row), depth_of(row))
             for row in rows if rate_of(row) > 0]
    kinds = [kind for kind in kinds_in_order(rows) if kind in {cell[1] for cell in drawn}]
    cells = [(x, kinds.index(kind), share, um) for x, kind, share, um in drawn]
    page = Page(395 + 21 * len(methods), 240 + 13 * len(kinds))
    width, height = page.width, page.height
    axes = map_axes(page, 275, 50, width - 120, height - 190, len(methods), kinds)
    axes.spines[:].set_visible(True)
    axes.spines[:].set_color(PALE)
    axes.hlines([row + 0.5 for row in range(len(kinds) - 1)], -0.5, len(methods) - 0.5,
                color=FAINT, linewidth=PX, zorder=0.5)
    axes.vlines([x + 0.5 for x in range(len(methods) - 1)], -0.5, len(kinds) - 0.5, color=FAINT,
                linewidth=PX, zorder=0.5)
    heat = heat_of("#3a0a05")
    draw_cells(axes, [cell[:3] for cell in cells], heat, 0.46, 0.46)
    for x, y, _, um in cells:
        if um > 1:
            axes.plot([x], [y], "o", markersize=5.5 * PX, color=BLUE, markeredgewidth=1.5 * PX,
                      markerfacecolor=BLUE if um > 1000 else "white")
    for x, name in enumerate(methods):
        page.text(275 + 21 * (x + 0.5), height - 184, name, 11, rotation=60, ha="left",
                  va="baseline")
    page.text(width / 2, height - 20, title, 16)
    page.text(width / 2, height - 45, deep, 11)
    given = tables.conditions
    page.text(width / 2, 18, f"{int(given['pairs_of_each_kind']) * int(given['kinds'])} pairs: "
              f"{given['pairs_of_each_kind']} of each of {given['kinds']} kinds, answers from "
              f"exact arithmetic, seed {given['seed']}", 11)
    scale = page.axes(width - 106, height - 420, width - 94, height - 200)
    bar = page.figure.colorbar(heat, cax=scale)
    bar.minorticks_off()
    ticks(scale.yaxis, {"≤ 0.1 %": 0.1, "1 %": 1, "10 %": 10, "100 %": 100})
    scale.tick_params(labelsize=11 * PX)
    page.text(width - 16, height - 310, of_what, 11, rotation=90)
    return page


def percent(part, whole):
    return 100 * part / whole if whole else 0


def missed_contacts(tables):
    return failure_map(
        tables, "Contacts that a test calls separated",
        "circle: one of them deeper than 1 µm; disc: deeper than 1 mm; blank: none missed",
        "of the contacts in the category",
        lambda row: percent(int(row["missed"]), int(row["intersecting"])),
        lambda row: float(row["deepest_missed_um"]))


def not_told_apart(tables):
    def depth_of(row):
        um = max(float(row["farthest_false_hit_um"]), float(row["widest_undecided_um"]))
        return um if um > 1000 else 0  # every cell here is beyond 1 um
    return failure_map(
        tables, "Pairs more than 1 µm apart that a test does not tell apart",
        "called touching, or left undecided; disc: one of them more than 1 mm apart; blank: none",
        "of the pairs more than 1 µm apart",
        lambda row: percent(int(row["false_hits_beyond_1_um"]) + int(row["undecided_beyond_1_um"]),
                            int(row["beyond_1_um"])), depth_of)


def flips(tables):
    """A row a method: as compiled by the project, and with contraction where there is one."""
    table = tables.rows("flips")
    frames = list(dict.fromkeys(row["frame"] for row in table))
    methods = list(dict.fromkeys(row["method"] for row in table if row["fused"] == "0"))
    half = len(frames) + 1
    page = Page(282 + 144 * half, 200 + 22 * len(methods))
    width, height = page.width, page.height
    axes = map_axes(page, 190, 50, width - 20, height - 150, 2 * half, methods)
    axes.spines[:].set_visible(False)
    counts = []
    for name in {row["method"]: None for row in table}:
        rows = [row for row in table if row["method"] == name]
        plain = name.removesuffix("-fma") if rows[0]["fused"] == "1" else name
        if plain not in methods:
            continue
        shift, y = (half if plain != name else 0), methods.index(plain)
        values = [(int(row["differing_in_72_orders"]), int(row["pairs"])) for row in rows]
        values.append((sum(int(row["separated_though_touching"]) for row in rows),
                       sum(int(row["pairs"]) for row in rows)))
        counts += [(shift + x, y, count, percent(count, of)) for x, (count, of)
                   in enumerate(values)]
    draw_cells(axes, [(x, y, share) for x, y, count, share in counts if count > 0],
               heat_of("#7a1d08"), 0.47, 0.45)
    for x, y, count, share in counts:
        axes.text(x, y, count, ha="center", va="center_baseline", fontsize=11.5 * PX,
                  color=BLUE if count == 0 else "white" if share > 10 else INK)
    cell = (width - 210) / (2 * half)
    for x in range(2 * half):
        words = (*frames, "contacts\ncalled apart")[x % half]
        page.text(190 + cell * (x + 0.5), height - 140, words, 11.5, va="bottom",
                  linespacing=1.1)
    axes.axvline(half - 0.5, color=GREY, linewidth=2 * PX)
    for x, words in ((1.5, "compiled without contraction"), (6.5, "contraction allowed (FMA)")):
        page.text(190 + cell * (x + 0.5), height - 75, words, 11.5)
    page.text(width / 2, height - 22,
              "Pairs whose verdict changes with the order of vertices and triangles", 16)
    page.text(width / 2, 20, f"of {table[0]['pairs']} pairs in 72 orders each, in each frame "
              "rounded to what the method computes in; last columns: all frames", 11.5)
    return page


# One panel each.

def undecided_gap(tables):
    """Share that the certified methods leave undecided: a step whose foot is the band."""
    curves = {}
    for row in tables.rows("undecided-gap"):
        curves.setdefault((row["method"], row["aspect"]), []).append(row)
    aspects = list(dict.fromkeys(aspect for _, aspect in curves))
    methods = list(dict.fromkeys(method for method, _ in curves))
    pairs = sum(int(row["pairs"]) for row in list(curves.values())[-1])
    page, axes = wide_page(600, "How wide a gap must be for the certified test to see it", [
        f"{pairs} pairs a line: vertex, edge and face against one another, turned at random, "
        "rounded to float; true gap from exact arithmetic"])
    for (method, aspect), rows in curves.items():
        at = aspects.index(aspect)
        axes.plot([math.sqrt(float(row["least_gap_um"]) * float(row["most_gap_um"]))
                   for row in rows], [float(row["undecided_percent"]) for row in rows],
                  color=(INK, RED, SKY)[at], marker="os^"[at], markersize=(10, 8, 6)[at] * PX,
                  linewidth=(3.2 - 0.9 * at) * PX, clip_on=False,
                  linestyle=("-", "--", ":")[methods.index(method)],
                  label=f"{method}, slivers 1:{float(aspect):.0f}")
    axes.set(xscale="log", xlim=(1e-3, 1000), ylim=(0, 105),
             xlabel="true gap between two triangles of 100 mm",
             ylabel="left undecided, % of the pairs")
    ticks(axes.xaxis, {"1 nm": 1e-3, "10 nm": 1e-2, "0.1 µm": 0.1, "1 µm": 1, "10 µm": 10,
                       "0.1 mm": 100, "1 mm": 1000})
    axes.legend(loc="upper right", handlelength=3, fontsize=12 * PX, labelspacing=0.3)
    return page


def rechecks(tables):
    """Rechecks of the query that needs most in a cycle, against the capacity of the list."""
    rows, limits = tables.rows("rechecks"), tables.conditions
    families = list(rows[0])[2:]
    cycles = [sum(int(row[family]) for row in rows) for family in families]
    capacity = int(limits["recheck_capacity"])
    page, axes = wide_page(
        540, "Pairs of triangles that float leaves to double, in the neediest question of a cycle",
        ["machine paper-trunnion, eight pairs; "
         f"{', '.join(map(str, cycles[:-1]))} and {cycles[-1]} cycles, contacts among them",
         f"worst: {limits['worst_rechecks']}"], 115)
    for family, total, colour, marker in zip(families, cycles, (GREY, SKY, RED, INK), "o^sx"):
        axes.plot([100 * int(row[family]) / total if int(row[family]) else math.nan
                   for row in rows], color=colour, marker=marker, linewidth=2 * PX,
                  markersize=6 * PX, label=f"{family}: most {limits[f'most_rechecks {family}']}")
    axes.set(yscale="log", xlim=(-0.5, len(rows) - 0.5), ylim=(1e-3, 180),
             xlabel="rechecks of that question (to twice as many, less one)",
             ylabel="share of the cycles")
    ticks(axes.xaxis, {row["least_rechecks"]: i for i, row in enumerate(rows)})
    ticks(axes.yaxis, {"100%": 100, "10%": 10, "1%": 1, "0.1%": 0.1, "0.01%": 0.01, "0.001%": 1e-3})
    at = math.log2(capacity) + 1
    axes.axvline(at, 0, 0.62, color=RED, linestyle="--", linewidth=2 * PX)
    axes.text(at, 0.66, f"the list: {capacity}", color=RED, ha="center", va="center_baseline",
              transform=axes.get_xaxis_transform())
    axes.legend(loc="upper right", handlelength=2.5)
    return page


def clearance_error(tables):
    """Above zero, a method claims more than the distance."""
    errors, bodies, certified = {}, {}, {}
    for row in tables.rows("clearance-error"):
        name = row["method"]
        errors.setdefault(name, []).append((float(row["distance_mm"]), float(row["error_um"])))
        bodies[row["bodies"]] = bodies.get(row["bodies"], 0) + 1
        certified[name] = name == ENGINE or name.startswith("certified")
    beneath = f"{bodies['paper-trunnion']} pairs of the machine paper-trunnion near contact"
    if "tritri" in bodies:
        beneath += "; 240 poses of the meshes of the folder tritri"
    page, axes = wide_page(620, "Reported clearance less the true distance",
                           [beneath + "; distances from exact arithmetic"])
    axes.axhspan(0, 15, color="#fbe9e0", zorder=0)
    axes.axhline(0, color=INK, linewidth=1.5 * PX)
    colours = {True: iter((BLUE, SKY, GREEN)), False: iter((RED, GOLD, INK, GREY))}
    # Draws the engine and the float methods only: errors of double are too close to zero to see.
    drawn = [name for name in errors if name == ENGINE or name.endswith("-f32")]
    for name, (marker, is_filled) in zip(drawn, (("o", True), ("s", True), ("o", False),
                                                 ("x", True), ("+", True), ("s", False),
                                                 ("^", False))):
        colour = next(colours[certified[name]])
        above = sum(um > 0 for _, um in errors[name])
        axes.plot([mm for mm, _ in errors[name]], [folded(um) for _, um in errors[name]],
                  linestyle="none", marker=marker, markersize=5 * PX, color=colour,
                  markerfacecolor=colour if is_filled else "none", markeredgewidth=PX,
                  label=f"{name}: {above} of {len(errors[name])} above")
    axes.set(xscale="log", xlim=(1e-6, 1000), ylim=(-15, 15),
             xlabel="true distance of the two bodies", ylabel="error")
    ticks(axes.xaxis, {"1 nm": 1e-6, "10 nm": 1e-5, "0.1 µm": 1e-4, "1 µm": 1e-3, "10 µm": 1e-2,
                       "0.1 mm": 0.1, "1 mm": 1, "10 mm": 10, "0.1 m": 100, "1 m": 1000})
    ticks(axes.yaxis, {"+1 mm": 13, "+1 µm": 10, "+1 nm": 7, "+1 pm": 4, "0": 0, "-1 pm": -4,
                       "-1 nm": -7, "-1 µm": -10, "-1 mm": -13})
    for y, words, colour in ((0.965, "claims more than there is", RED),
                             (0.035, "claims less: safe", BLUE)):
        axes.text(0.01, y, words, color=colour, va="center_baseline", transform=axes.transAxes)
    axes.legend(loc="upper right", handlelength=1)
    return page


def folded(um):
    """Both signs on a logarithmic scale: decades above and below 1e-10 um, drawn as zero."""
    return 0 if abs(um) <= 1e-10 else math.copysign(math.log10(abs(um)) + 10, um)


FIGURES = {  # figure: the table without which it is not drawn, and its function
    "speed-accuracy": ("speed-accuracy", speed_accuracy),
    "missed-contacts": ("failure-map", missed_contacts),
    "not-told-apart": ("failure-map", not_told_apart),
    "cycle-accuracy": ("cycle-accuracy", cycle_accuracy),
    "model-curve": ("model-curve", model_curve), "undecided-gap": ("undecided-gap", undecided_gap),
    "rechecks": ("rechecks", rechecks), "clearance-error": ("clearance-error", clearance_error),
    "flips": ("flips", flips)}

if __name__ == "__main__":
    draw(FIGURES)
