#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the machine paper-trunnion at the moment of a stop, from the document of a replay:

    axguard simulate config/machines/paper-trunnion.yaml \
        hil_replay/programs/paper-trunnion-demo.ngc -o demo.log
    axguard replay config/machines/paper-trunnion.yaml demo.log --mode contact --json=demo.json
    python3 docs/figures/make_stop_picture.py demo.json -o docs/figures/stop.svg

Standard library only. Same document, same bytes: the stop alone is read, no measured time.
Faces are put in order by binary space partition, which is exact where they touch or cross."""
import argparse
import json
import math
import os
import pathlib
import struct
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
MESHES = ROOT / "config" / "machines" / "meshes" / "paper-trunnion"
PIVOT_Z = -380.0  # of A and C, as in config/machines/paper-trunnion.yaml; their meshes sit there
BODIES = {"y": ("saddle", (150, 160, 172)), "x": ("table", (122, 142, 166)),
          "a": ("cradle", (162, 182, 205)), "c": ("rotary plate", (236, 178, 92)),
          "z": ("headstock", (186, 192, 198)), "cutter": ("cutter", (222, 84, 66))}
TOUCHING = (150, 16, 30)
NEAR_MM = 1e-5  # thickness of a plane when polygons are sorted; far below what can be seen
WIDTH, HEIGHT = 1000, 640
SCALE, CENTRE = 0.62, (290, 296)  # px/mm; where the A axis at X0 Y0 is drawn
LENS, LENS_RADIUS, LENS_ZOOM = (742, 192), 164, 3.6
EYE_DEG = (35.0, 22.0)  # around Z from the front to the right, and up


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(dot(a, a))
    return (a[0] / length, a[1] / length, a[2] / length) if length > 0 else None


def view_axes():
    """Right, up and towards the eye."""
    around, above = (math.radians(angle) for angle in EYE_DEG)
    eye = (math.sin(around) * math.cos(above), -math.cos(around) * math.cos(above),
           math.sin(above))
    right = (math.cos(around), math.sin(around), 0.0)
    return right, cross(eye, right), eye


RIGHT, UP, EYE = view_axes()
LIGHT = unit((0.25, -0.55, 0.8))


def on_page(p):
    p = (p[0], p[1], p[2] - PIVOT_Z)
    return (CENTRE[0] + SCALE * dot(p, RIGHT), CENTRE[1] - SCALE * dot(p, UP))


def read_stl(path):
    """Corner triples of a binary STL, mm."""
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data, 80)
    if len(data) != 84 + 50 * count:
        raise ValueError(f"{path}: got {len(data)} bytes, wanted 84 + 50 x {count}: binary STL")
    out = []
    for i in range(count):
        v = struct.unpack_from("<12f", data, 84 + 50 * i)
        out.append((v[3:6], v[6:9], v[9:12]))
    return out


def place(body, p, axes):
    """Machine coordinates of a point of the body's mesh; what the table carries moves against its
    command, as the machine file says."""
    if body in ("z", "cutter"):
        return (p[0], p[1], p[2] + axes["Z_mm"])
    if body == "c":
        c = -math.radians(axes["C_deg"])
        p = (p[0] * math.cos(c) - p[1] * math.sin(c), p[0] * math.sin(c) + p[1] * math.cos(c),
             p[2])
    if body in ("a", "c"):
        a = -math.radians(axes["A_deg"])
        p = (p[0], p[1] * math.cos(a) - p[2] * math.sin(a),
             p[1] * math.sin(a) + p[2] * math.cos(a) + PIVOT_Z)
    return (p[0] - (axes["X_mm"] if body != "y" else 0.0), p[1] - axes["Y_mm"], p[2])


class Polygon:
    """A convex piece of a facet; edges[i], from corner i to the next, is drawn where True."""
    __slots__ = ("corners", "edges", "normal", "offset", "colour")

    def __init__(self, corners, edges, normal, offset, colour):
        self.corners, self.edges, self.normal = corners, edges, normal
        self.offset, self.colour = offset, colour


def shade(colour, normal):
    """Twelve steps of light are enough for the eye, and keep the file small."""
    step = round(12 * max(0.0, dot(normal, LIGHT))) / 12
    return "#%02x%02x%02x" % tuple(min(255, round(k * (0.52 + 0.52 * step))) for k in colour)


def facets_of(body, axes, colour, touched):
    """The facets that face the eye, with creases and outlines marked."""
    corners = read_stl(MESHES / f"{body}.stl")
    placed = [tuple(place(body, p, axes) for p in triangle) for triangle in corners]
    normals = [unit(cross(sub(t[1], t[0]), sub(t[2], t[0]))) for t in placed]
    owner = {}
    for i, triangle in enumerate(corners):
        for k in range(3):
            owner[(triangle[k], triangle[(k + 1) % 3])] = i
    out = []
    for i, triangle in enumerate(corners):
        if normals[i] is None or dot(normals[i], EYE) <= 1e-9:
            continue
        edges = []
        for k in range(3):
            other = owner.get((triangle[(k + 1) % 3], triangle[k]))
            is_crease = (other is None or normals[other] is None or
                         dot(normals[i], normals[other]) < math.cos(math.radians(28)) or
                         dot(normals[other], EYE) <= 1e-9)
            edges.append(is_crease)
        fill = shade(TOUCHING if i in touched else colour, normals[i])
        out.append(Polygon(list(placed[i]), edges, normals[i], dot(normals[i], placed[i][0]),
                           fill))
    return out


def heights(plane, polygon):
    return [dot(plane.normal, p) - plane.offset for p in polygon.corners]


def side_of(height):
    return 0 if abs(height) <= NEAR_MM else (1 if height > 0 else -1)


def cut(polygon, height):
    """Two pieces, in front of the plane and behind it."""
    pieces = {1: ([], []), -1: ([], [])}
    count = len(polygon.corners)
    for i in range(count):
        here, there = polygon.corners[i], polygon.corners[(i + 1) % count]
        a, b = side_of(height[i]), side_of(height[(i + 1) % count])
        for side, (corners, edges) in pieces.items():
            if a == side:
                corners.append(here)
                edges.append(polygon.edges[i])
            elif a == 0:
                corners.append(here)
                edges.append(polygon.edges[i] and b == side)
        if a * b == -1:
            t = height[i] / (height[i] - height[(i + 1) % count])
            at = tuple(here[k] + t * (there[k] - here[k]) for k in range(3))
            for side, (corners, edges) in pieces.items():
                corners.append(at)
                edges.append(polygon.edges[i] and b == side)
    return [Polygon(corners, edges, polygon.normal, polygon.offset, polygon.colour)
            for corners, edges in (pieces[1], pieces[-1])]


def choose(polygons):
    """The plane, of some, that cuts the fewest others and halves them best."""
    best, best_cost = polygons[0], None
    for plane in polygons[::max(1, len(polygons) // 24)]:
        front = back = split = 0
        for other in polygons[::max(1, len(polygons) // 200)]:
            sides = [side_of(h) for h in heights(plane, other)]
            is_front, is_back = 1 in sides, -1 in sides
            split += is_front and is_back
            front += is_front
            back += is_back
        cost = 8 * split + abs(front - back)
        if best_cost is None or cost < best_cost:
            best, best_cost = plane, cost
    return best


def back_to_front(polygons, out):
    if not polygons:
        return
    plane = choose(polygons)
    front, level, back = [], [], []
    for polygon in polygons:
        height = heights(plane, polygon)
        sides = {side_of(h) for h in height}
        if polygon is plane or sides == {0}:
            level.append(polygon)
        elif -1 not in sides:
            front.append(polygon)
        elif 1 not in sides:
            back.append(polygon)
        else:
            ahead, behind = cut(polygon, height)
            front.append(ahead)
            back.append(behind)
    first, last = (back, front) if dot(plane.normal, EYE) > 0 else (front, back)
    back_to_front(first, out)
    out.extend(level)
    back_to_front(last, out)


def point_text(p):
    x, y = on_page(p)
    return f"{x:.2f} {y:.2f}"


def scene_svg(ordered):
    lines, fill, shapes = [], None, ""
    for polygon in ordered:
        shape = "M" + "L".join(point_text(p) for p in polygon.corners) + "Z"
        edges = "".join(f"M{point_text(polygon.corners[i])}L"
                        f"{point_text(polygon.corners[(i + 1) % len(polygon.corners)])}"
                        for i, drawn in enumerate(polygon.edges) if drawn)
        if fill not in (None, polygon.colour):
            lines.append(f'<path fill="{fill}" stroke="{fill}" d="{shapes}"/>')
            shapes = ""
        fill, shapes = polygon.colour, shapes + shape
        if edges:
            lines.append(f'<path fill="{fill}" stroke="{fill}" d="{shapes}"/>')
            lines.append(f'<path class="e" d="{edges}"/>')
            fill, shapes = None, ""
    if shapes:
        lines.append(f'<path fill="{fill}" stroke="{fill}" d="{shapes}"/>')
    return lines


def touching_place(stop, axes):
    """The middle of the first body's touching triangles: where the lens points."""
    first = stop["pair"].split("-")[0]
    mesh = read_stl(MESHES / f"{first}.stl")
    corners = [place(first, p, axes) for ids in stop["pairs"][0]["triangles"]
               for p in mesh[ids[0]]]
    lowest = min(p[2] for p in corners)
    return tuple(sum(p[k] for p in corners) / len(corners) for k in range(2)) + (lowest,)


def triad():
    """The machine's directions, small, in the corner."""
    lines = []
    for name, way in (("X", (1, 0, 0)), ("Y", (0, 1, 0)), ("Z", (0, 0, 1))):
        x, y = 60 + 36 * dot(way, RIGHT), 584 - 36 * dot(way, UP)
        lines.append(f'<path class="t" d="M60 584L{x:.1f} {y:.1f}"/>')
        x, y = 60 + 48 * dot(way, RIGHT), 584 - 48 * dot(way, UP)
        lines.append(f'<text x="{x:.1f}" y="{y + 4:.1f}" text-anchor="middle">{name}</text>')
    return lines


def words(stop):
    """Title, what touches, where the axes stand."""
    first, second = stop["pair"].split("-")
    axes = "   ".join(f"{name.split('_')[0]} {value:.3f}" for name, value in stop["axes"].items())
    left = LENS[0] - LENS_RADIUS
    return [
        f'<text x="{left}" y="412" class="h">STOP at {stop["time_us"] * 1e-6:.3f} s</text>',
        f'<text x="{left}" y="440">{BODIES[first][0]} (<tspan class="m">{first}</tspan>) touches '
        f'{BODIES[second][0]} (<tspan class="m">{second}</tspan>)</text>',
        f'<text x="{left}" y="462">{stop["pairs"][0]["touching"]} pairs of triangles: no permit '
        f'any more</text>',
        f'<text x="{left}" y="494" class="m">{axes[:axes.index("A")].strip()} mm</text>',
        f'<text x="{left}" y="514" class="m">{axes[axes.index("A"):]} deg</text>',
    ]


def legend():
    lines = []
    left = LENS[0] - LENS_RADIUS
    for i, (name, (word, colour)) in enumerate(BODIES.items()):
        x, y = left + 118 * (i % 3), 542 + 22 * (i // 3)
        fill = "#%02x%02x%02x" % colour
        lines.append(f'<rect x="{x}" y="{y}" width="13" height="13" fill="{fill}"/>')
        lines.append(f'<text x="{x + 19}" y="{y + 11}" class="s">{word}</text>')
    return lines


def picture(stop):
    axes = stop["axes"]
    names = stop["pair"].split("-")
    ids = stop["pairs"][0]["triangles"]
    polygons = []
    for body, (_, colour) in BODIES.items():
        touched = {t[names.index(body)] for t in ids} if body in names else set()
        polygons += facets_of(body, axes, colour, touched)
    ordered = []
    back_to_front(polygons, ordered)
    x, y = on_page(touching_place(stop, axes))
    small = LENS_RADIUS / LENS_ZOOM
    shift = (LENS[0] - LENS_ZOOM * x, LENS[1] - LENS_ZOOM * y)
    away = math.dist((x, y), LENS)
    start = (x + (LENS[0] - x) * small / away, y + (LENS[1] - y) * small / away)
    end = (LENS[0] - (LENS[0] - x) * LENS_RADIUS / away,
           LENS[1] - (LENS[1] - y) * LENS_RADIUS / away)
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" '
        f'font-family="Helvetica,Arial,sans-serif" font-size="16" fill="#1d242c">',
        "<title>The cutter meets the rotary plate, and the guard stops the machine</title>",
        "<style>.h{font-size:30px;font-weight:bold;fill:#b01424}.m{font-family:monospace;"
        "font-size:14.5px}.s{font-size:13px}.e{fill:none;stroke:#28323c;stroke-opacity:.75;"
        "stroke-width:.45;stroke-linecap:round}.t{stroke:#1d242c;stroke-width:1.5}"
        ".l{fill:none;stroke:#b01424;stroke-width:2}</style>",
        f'<defs><clipPath id="lens"><circle cx="{LENS[0]}" cy="{LENS[1]}" r="{LENS_RADIUS}"/>'
        "</clipPath></defs>",
        f'<rect width="{WIDTH}" height="{HEIGHT}" rx="10" fill="#fbfbfa"/>',
        '<g id="scene" stroke-width=".6" stroke-linejoin="round">', *scene_svg(ordered), "</g>",
        f'<circle cx="{LENS[0]}" cy="{LENS[1]}" r="{LENS_RADIUS}" fill="#fff"/>',
        f'<g clip-path="url(#lens)"><use href="#scene" transform="translate({shift[0]:.2f} '
        f'{shift[1]:.2f}) scale({LENS_ZOOM})"/></g>',
        f'<circle class="l" cx="{LENS[0]}" cy="{LENS[1]}" r="{LENS_RADIUS}"/>',
        f'<circle class="l" cx="{x:.2f}" cy="{y:.2f}" r="{small:.2f}"/>',
        f'<path class="l" d="M{start[0]:.2f} {start[1]:.2f}L{end[0]:.2f} {end[1]:.2f}"/>',
        *triad(), *words(stop), *legend(), "</svg>", ""])


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("document", help="what axguard replay --json=FILE wrote")
    parser.add_argument("-o", "--output", required=True, help="SVG file to write")
    arguments = parser.parse_args()
    document = json.loads(pathlib.Path(arguments.document).read_text(encoding="utf-8"))
    stops = [stop for stop in document["stops"] if stop["reason"] == "contact" and
             stop["pairs"][0]["triangles"]]
    if document["machine"] != "paper-trunnion" or not stops:
        sys.exit(f"{arguments.document}: got machine {document['machine']}, {len(stops)} stops in "
                 f"contact; wanted a replay of paper-trunnion that ends in one")
    sys.setrecursionlimit(20000)
    part = arguments.output + ".part"
    pathlib.Path(part).write_text(picture(stops[0]), encoding="utf-8")
    os.replace(part, arguments.output)


if __name__ == "__main__":
    main()
