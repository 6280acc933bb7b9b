#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The charts under docs/figures are what their scripts draw from the committed tables; labels of
crowded marks do not overlap, and no mark beats one of the dotted line."""
import importlib.util
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile

from sources import finish, skip

SYSTEM = "/usr/bin/python3"
DRAWN_WITH = "3.6."  # Debian 12's matplotlib; another places some text elsewhere


def use_matplotlib():
    """Starts again with Debian's Python where this one has no matplotlib."""
    if importlib.util.find_spec("matplotlib"):
        return
    if os.path.realpath(sys.executable) != os.path.realpath(SYSTEM) and \
            subprocess.run([SYSTEM, "-c", "import matplotlib"], capture_output=True,
                           check=False).returncode == 0:
        os.execv(SYSTEM, [SYSTEM, "-B", *sys.argv])
    skip("no matplotlib (Debian: python3-matplotlib)")


def drawing_faults(root, script, count):
    """What of the committed figures the script does not draw so from the committed tables."""
    figures = root / "docs/figures"
    with tempfile.TemporaryDirectory() as folder:
        for table in figures.glob("*.csv"):
            shutil.copy(table, folder)
        drawn = subprocess.run([sys.executable, "-B", root / script, folder], text=True,
                               capture_output=True, check=False)
        if drawn.returncode != 0:
            yield f"{script}: {drawn.stderr.strip()}"
        charts = sorted(pathlib.Path(folder).glob("*.svg"))
        if len(charts) != count:
            yield f"{script}: drew {len(charts)} figures, wanted {count}"
        for chart in charts:
            committed = figures / chart.name
            if not committed.exists() or committed.read_bytes() != chart.read_bytes():
                yield (f"docs/figures/{chart.name}: not what {script} draws: run "
                       f"python3 -B {script} docs/figures")
        left = [path.name for path in pathlib.Path(folder).glob("*.part")]
        if left:
            yield f"{script}: left {left}"


def do_overlap(a, b):
    return a[0] < b[2] - 1e-6 and b[0] < a[2] - 1e-6 and a[1] < b[3] - 1e-6 and b[1] < a[3] - 1e-6


def label_faults(scatter_panels):
    """Where there is room, no label is on another, on a mark, on a taken box, or outside."""
    draw, frame, taken = random.Random(3), (0, 0, 1000, 600), (700, 450, 1000, 600)
    radius = scatter_panels.MARK_PX
    for number in range(50):
        marks = [(draw.uniform(200, 800), draw.uniform(100, 500), draw.uniform(40, 160))
                 for _ in range(12)]
        boxes = [box for box, _ in scatter_panels.place_labels(marks, frame, [taken])]
        occupied = [taken] + [(x - radius, y - radius, x + radius, y + radius)
                              for x, y, _ in marks]
        for i, box in enumerate(boxes):
            if box[0] < 0 or box[1] < 0 or box[2] > 1000 or box[3] > 600 or any(
                    do_overlap(box, other) for other in occupied + boxes[:i]):
                yield f"place_labels: round {number}, label {i} has no place of its own"
    (box, needs_line), = scatter_panels.place_labels([(500, 300, 100)], frame, [])
    if needs_line or abs(box[0] - 506) > 10 or abs(box[1] + box[3] - 600) > 2:
        yield f"place_labels: the label of a free mark is at {box}"
    crowded = scatter_panels.place_labels([(500, 300, 120)] * 8, frame, [])
    if not any(needs_line for _, needs_line in crowded):
        yield "place_labels: no line to a label that was crowded out"


def pareto_faults(scatter_panels):
    slow, fast = (5, 1, "other", ""), (1, 9, "other", "")
    middle, predicted = (2, 4, "other", ""), (1, 0.5, "predicted", "")
    beaten = [(4, 9, "other", ""), (2, 5, "other", "")]
    if scatter_panels.pareto_of([slow, fast, *beaten, middle, predicted]) != [fast, middle, slow]:
        yield "pareto_of: wanted what no measured mark beats, from left to right"


def main():
    use_matplotlib()
    root = pathlib.Path(sys.argv[1]).resolve()
    sys.path += [str(root / "hil_replay/plan"), str(root / "hil_replay/lab/chart")]
    import matplotlib
    import scatter_panels
    faults = [*label_faults(scatter_panels), *pareto_faults(scatter_panels)]
    if matplotlib.__version__.startswith(DRAWN_WITH):
        faults += drawing_faults(root, "hil_replay/lab/chart/draw_figures.py", 9)
        faults += drawing_faults(root, "docs/figures/records.py", 5)
    finish(faults)


if __name__ == "__main__":
    main()
