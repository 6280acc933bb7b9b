#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Each figure that docs/figures/draw_*.py draws is the committed one, 600 px wide, with text of 11
px or more that stays inside."""
import pathlib
import re
import subprocess
import sys

from sources import finish

WIDTH, TEXT_MIN = 600, 11
TEXT = re.compile(r'<text x="([\d.-]+)" y="([\d.-]+)" font-size="([\d.]+)"')


def faults_in(name, svg):
    size = re.search(r'<svg [^>]*width="(\d+)" height="(\d+)"', svg)
    if not size or int(size[1]) != WIDTH:
        yield f"{name}: not {WIDTH} px wide"
        return
    for x, y, font in TEXT.findall(svg):
        if float(font) < TEXT_MIN:
            yield f"{name}: text of {font} px, wanted {TEXT_MIN} or more"
        if not 0 <= float(x) <= WIDTH or not 0 <= float(y) <= int(size[2]):
            yield f"{name}: text at {x}, {y} is outside of the figure"


def main():
    folder = pathlib.Path(sys.argv[1]) / "docs/figures"
    faults = []
    scripts = sorted(folder.glob("draw_*.py"))
    if not scripts:
        faults.append("docs/figures: no draw_*.py")
    for script in scripts:
        drawn = subprocess.run([sys.executable, "-B", script, "--print"], text=True,
                               capture_output=True, check=False)
        figure = folder / (script.stem.removeprefix("draw_").replace("_", "-") + ".svg")
        if drawn.returncode != 0:
            faults.append(f"{script.name}: {drawn.stderr.strip()}")
        elif not figure.exists() or figure.read_text(encoding="utf-8") != drawn.stdout:
            faults.append(f"{figure.name}: not what {script.name} draws: run "
                          f"python3 docs/figures/{script.name}")
        faults += faults_in(figure.name, drawn.stdout)
    finish(faults)


if __name__ == "__main__":
    main()
