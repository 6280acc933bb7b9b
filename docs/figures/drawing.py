# SPDX-License-Identifier: Apache-2.0
"""Shared pieces of the figures that draw_*.py write: an SVG of 600 px width, read in grey too.
    python3 docs/figures/draw_cycle.py          writes docs/figures/cycle.svg
Text has 11 px or more. Meaning never rests on colour: each fill has a label or its own
lightness."""
import pathlib
import sys
from xml.sax.saxutils import escape

WIDTH = 600
INK, GREY, RULE = "#111111", "#555555", "#bbbbbb"
PAPER, PALE, MID, DARK = "#ffffff", "#eef2f6", "#cddcea", "#0b5394"
WARM, STOP = "#f7e3c4", "#b34700"


def number(value):
    return f"{value:.1f}".removesuffix(".0")


class Drawing:
    def __init__(self, title, height):
        self.title, self.height, self.parts = title, height, []

    def add(self, tag, content=None, **attributes):
        words = "".join(f' {key.rstrip("_").replace("_", "-")}="'
                        f'{number(value) if isinstance(value, (int, float)) else escape(value)}"'
                        for key, value in attributes.items() if value is not None)
        self.parts.append(f"<{tag}{words}/>" if content is None else
                          f"<{tag}{words}>{escape(content)}</{tag}>")

    def box(self, x, y, w, h, fill=PALE, stroke=INK, dash=None, radius=None, width=None):
        self.add("rect", x=x, y=y, width=w, height=h, fill=fill, stroke=stroke,
                 stroke_dasharray=dash, rx=radius, stroke_width=width)

    def text(self, x, y, words, size=12, anchor=None, bold=False, fill=None):
        for at, line in enumerate(words.split("\n")):
            self.add("text", line, x=x, y=y + at * (size + 3), font_size=size,
                     text_anchor=anchor, font_weight="bold" if bold else None, fill=fill)

    def label(self, x, y, w, h, words, fill=PALE, size=12, dash=None, ink=None, bold=False,
              stroke=INK, radius=None):
        """A box with centred lines."""
        self.box(x, y, w, h, fill, stroke, dash, radius)
        lines = words.split("\n")
        top = y + h / 2 - (len(lines) - 1) * (size + 3) / 2 + size * 0.36
        self.text(x + w / 2, top, words, size, "middle", bold, ink)

    def line(self, *points, stroke=INK, dash=None, width=None, head=False, tail=False, fill="none"):
        self.add("polyline", points=" ".join(f"{number(x)},{number(y)}" for x, y in points),
                 fill=fill, stroke=stroke, stroke_dasharray=dash, stroke_width=width,
                 marker_end="url(#head)" if head else None,
                 marker_start="url(#tail)" if tail else None)

    def shape(self, points, fill=PALE, stroke=INK, dash=None):
        self.add("polygon", points=" ".join(f"{number(x)},{number(y)}" for x, y in points),
                 fill=fill, stroke=stroke, stroke_dasharray=dash)

    def circle(self, x, y, r, fill=PAPER, stroke=INK, width=None):
        self.add("circle", cx=x, cy=y, r=r, fill=fill, stroke=stroke, stroke_width=width)

    def step(self, x, y, name):
        """A numbered mark."""
        self.circle(x, y, 9)
        self.text(x, y + 4, str(name), 11, "middle", True)

    def svg(self):
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{self.height}"'
                f' viewBox="0 0 {WIDTH} {self.height}"\n'
                f' font-family="DejaVu Sans, Arial, sans-serif" font-size="12" fill="{INK}"'
                f' role="img">\n<title>{escape(self.title)}</title>\n<defs>\n')
        for name, path, at in (("head", "M0,0.5 L8,4 L0,7.5 z", 7.5),
                               ("tail", "M8,0.5 L0,4 L8,7.5 z", 0.5)):
            head += (f'<marker id="{name}" viewBox="0 0 8 8" refX="{at}" refY="4" markerWidth="8"'
                     f' markerHeight="8" orient="auto"><path d="{path}" fill="{INK}"/></marker>\n')
        head += f'</defs>\n<rect width="{WIDTH}" height="{self.height}" fill="{PAPER}"/>\n'
        return head + "\n".join(self.parts) + "\n</svg>\n"

    def save(self, script):
        """Writes the figure named as the script, or to stdout with --print."""
        if "--print" in sys.argv[1:]:
            sys.stdout.write(self.svg())
            return
        name = pathlib.Path(script).stem.removeprefix("draw_").replace("_", "-")
        pathlib.Path(script).with_name(name + ".svg").write_text(self.svg(), encoding="utf-8")
