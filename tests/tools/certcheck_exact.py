#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A second judge of certificates: whole numbers and fractions, sine and cosine enclosed in
rationals. It shares nothing with axguard-certcheck. Without --boxes it judges every box.

Example: certcheck_exact.py M.model P.cert --boxes 1000 --seed 1"""
import argparse
import fractions
import hashlib
import math
import pathlib
import random
import struct
import sys

from exact_ranges import (IDENTITY, ONE, S, UNIT, ZERO, R, add, cross, dot, inverse, product,
                          scaled, sine_cosine, sine_of_half, take, transposed, turned)

PARTS = 256
EVERY = -2


class Untrue(Exception):
    """The certificate does not prove what it claims."""


class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        if self.at + count > len(self.data):
            raise Untrue("a section ends too early")
        self.at += count
        return self.data[self.at - count:self.at]

    def get(self, kinds):
        values = struct.unpack("<" + kinds, self.take(struct.calcsize("<" + kinds)))
        return values[0] if len(values) == 1 else list(values)

    def text(self):
        return self.take(self.get("H")).decode("utf-8", "replace")

    def varint(self):
        value = shift = 0
        while shift < 63:
            byte = self.get("B")
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value
        raise Untrue("a number of more than nine bytes")

    def zigzag(self):
        value = self.varint()
        return value >> 1 if value % 2 == 0 else -(value >> 1) - 1

    def end(self):
        if self.at != len(self.data):
            raise Untrue("bytes left over")


def sections(data, names):
    """The sections, whose letters and sums have to fit."""
    found, at, chain = [], 0, bytes(32)
    while True:
        letters, length = data[at:at + 4], int.from_bytes(data[at + 4:at + 12], "little")
        body = data[at + 12:at + 12 + length]
        if letters == b"DONE":
            break
        if len(body) != length or len(letters) != 4:
            raise Untrue("no DONE")
        chain = hashlib.sha256(chain + data[at:at + 12] + body).digest()
        found.append((letters.decode("latin-1"), Reader(body)))
        at += 12 + length
    if body != chain or at + 44 != len(data):
        raise Untrue("the sums do not fit")
    if [letters for letters, _ in found] != names(len(found)):
        raise Untrue("other sections")
    return [reader for _, reader in found]


class Model:
    def __init__(self, data):
        self.sum = hashlib.sha256(data).digest()
        head, axes, body, surf, task, excl = sections(
            data, lambda _: ["MODL", "AXES", "BODY", "SURF", "TASK", "EXCL"])
        version, self.promise, self.free_jerk, self.turns = head.get("IBBB")
        self.axes = []
        for _ in range(axes.get("I")):
            name, kind = axes.text(), axes.get("B")
            speed, acceleration, jerk, stopping, following, within = axes.get("4dqd")
            self.axes.append({"name": name, "rotary": kind == 1, "v": speed, "a": acceleration,
                              "j": jerk, "d": stopping, "f": following, "within": within,
                              "unit": fractions.Fraction(1, 1 << (24 if kind else 16))})
        self.bodies = []
        for _ in range(body.get("I")):
            name, parent, axis = body.text(), *body.get("2i")
            along, pivot = body.get("3d"), body.get("3d")
            self.bodies.append((name, parent, axis, [R.of(x) for x in along],
                                [R.of(x) for x in pivot], body.get("B")))
        self.surfaces = []
        for _ in range(surf.get("I")):
            surf.text()
            count = surf.get("I")
            values = struct.unpack(f"<{9 * count}f", surf.take(36 * count))
            exact = [int(fractions.Fraction(x) * ONE) for x in values]  # no float is finer
            self.surfaces.append([[exact[9 * t + 3 * c:9 * t + 3 * c + 3] for c in range(3)]
                                  for t in range(count)])
        self.tools = [(task.get("H"), task.text()) for _ in range(task.get("I"))]
        self.tasks = []
        for _ in range(task.get("I")):
            a, b, tool = task.get("3i")
            at = []
            for _ in range(2):
                pose = [R.of(x) for x in task.get("12d")]
                at.append(([pose[0:3], pose[3:6], pose[6:9]], pose[9:12]))
            self.tasks.append({"bodies": (a, b), "tool": tool, "at": at,
                               "surfaces": task.get("2I"), "wholes": task.get("2I"),
                               "margin": task.get("d"), "error": task.get("d")})
        self.excluded = {}
        for _ in range(excl.get("I")):
            pair = tuple(sorted(excl.get("2i")))
            self.excluded[pair] = excl.text()
        for reader in (head, axes, body, surf, task, excl):
            reader.end()
        self.require_pairs()
        if version != 1:
            raise Untrue("another format")

    def require_pairs(self):
        done = {(*sorted(task["bodies"]), task["tool"]) for task in self.tasks}
        carriers = {i for i, body in enumerate(self.bodies) if body[5] == 2}
        surfaced = [i for i, body in enumerate(self.bodies) if body[5]]
        for a in surfaced:
            for b in surfaced:
                tools = range(len(self.tools)) if carriers & {a, b} else [-1]
                if a < b and (a, b) not in self.excluded:
                    if any((a, b, tool) not in done for tool in tools):
                        raise Untrue(f"no task of bodies {a} and {b}")

    def chain(self, body):
        """From the machine's frame to the body."""
        bodies = []
        while body >= 0:
            bodies.insert(0, body)
            body = self.bodies[body][1]
        return bodies

    def joint(self, body, place):
        """The pose of a joint at a place in units (a fraction)."""
        _, _, axis, along, pivot, _ = self.bodies[body]
        if axis < 0:
            return IDENTITY
        unit = scaled(UNIT / dot(along, along).root(), along)
        moved = place[axis] * self.axes[axis]["unit"]
        if not self.axes[axis]["rotary"]:
            return IDENTITY[0], scaled(R.of(moved), unit)
        sine, cosine = sine_cosine(moved)
        x, y, z = scaled(sine, unit)
        skew = [[ZERO, -z, y], [z, ZERO, -x], [-y, x, ZERO]]
        rows = [[(UNIT - cosine) * unit[i] * unit[j] + skew[i][j] +
                 (cosine if i == j else ZERO) for j in range(3)] for i in range(3)]
        return rows, take(pivot, turned(rows, pivot))


def braking(x, b, d, j):
    two = R.of(2)
    g = ((b + d) / j).least((b + (b * b + two * j * x).root()) / j)
    rest = (x + g * (b - j * g / two)).most(ZERO)
    return g * (x + g * (b / two - g * j / R.of(6))) + rest * rest / (two * d)


def reach(model, axis, following, byte):
    """Rho in units."""
    v, a, j, d = (R.of(axis[key]) for key in "vajd")
    f = R.of(following * axis["unit"])
    two = R.of(2)
    u = v.least(v * R.of(fractions.Fraction(byte, 255)) + two * (two * a * f).root())
    if not model.free_jerk and not model.turns and byte == 0 and following == 0:
        return 0
    most = u if model.free_jerk else v
    b = a.least((two * j * most).root())
    later = most * b / j + braking(most, ZERO, d, j)
    if model.free_jerk:
        later = later - b * b * b / (R.of(6) * j * j)
    best = braking(u, a, d, j).least(later).high
    return math.ceil(fractions.Fraction(best, ONE) / axis["unit"])


class Certificate:
    def __init__(self, model, data):
        readers = sections(data, lambda n: ["HEAD", "REFS", "LINE", "PATH"] +
                           ["PAIR"] * len(model.tasks))
        head, refs, line, path, *self.pairs = readers
        version, _, promise, self.partial = head.get("I"), head.text(), *head.get("BB")
        count = head.get("I")
        bounds = [head.get("2q") for _ in range(count)]
        self.delta, self.following = [b[0] for b in bounds], [b[1] for b in bounds]
        if version != 1 or promise != model.promise or count != len(model.axes) or any(
                f < axis["f"] for f, axis in zip(self.following, model.axes)) or any(
                    x < 0 for x in self.delta):
            raise Untrue("the head does not fit the model")
        names = [(refs.text(), refs.take(32)) for _ in range(refs.get("I"))]
        if [n for n, _ in names] != ["model", "machine", "program", "arguments"] or \
                names[0][1] != model.sum:
            raise Untrue("another model")
        self.tools = []
        for _ in range(path.get("I")):
            tool = path.get("i")
            segments, first, last = path.varint(), path.varint(), path.varint()
            self.tools += [EVERY if i < first or i >= segments - last else tool
                           for i in range(segments)]
        lined = 0
        while line.at < len(line.data):
            lined += line.varint()
            line.zigzag()
        if lined != len(self.tools) or lined == 0:
            raise Untrue("LINE and PATH differ")
        self.nodes = [[0] * count]
        for i in range(len(self.tools) + 1):
            self.nodes.append([path.zigzag() + x for x in self.nodes[-1]])
        del self.nodes[0]
        self.speeds = []
        if model.promise == 0:
            self.speeds = [path.take(2 * count) for _ in self.tools]
        for reader in (head, refs, line, path):
            reader.end()
        self.reach = [[reach(model, axis, f, byte) for byte in range(256)]
                      for axis, f in zip(model.axes, self.following)] if self.speeds else []

    def tube(self, first, last):
        lows, highs = [], []
        for axis in range(len(self.delta)):
            low, high = [], []
            for i in range(first // PARTS, -(-last // PARTS)):
                wide = self.delta[axis] + self.following[axis]
                up, down = wide, wide
                if self.speeds:
                    up += self.reach[axis][self.speeds[i][2 * axis]]
                    down += self.reach[axis][self.speeds[i][2 * axis + 1]]
                start, end = self.nodes[i][axis], self.nodes[i + 1][axis]
                for part in (max(first - i * PARTS, 0), min(last - i * PARTS, PARTS)):
                    place = start * PARTS + (end - start) * part
                    low.append(place // PARTS - down)
                    high.append(-(-place // PARTS) + up)
            lows.append(min(low))
            highs.append(max(high))
        return tuple(lows), tuple(highs)


class Judge:
    """Judges boxes of one model. What it judged once it does not judge again."""

    def __init__(self, model):
        self.model, self.judged, self.sizes, self.parts = model, {}, {}, {}

    def places_of(self, task, place):
        """Machine poses of the joints' parents and of both surfaces."""
        parents, poses = {}, []
        for side, body in enumerate(task["bodies"]):
            pose = IDENTITY
            for each in self.model.chain(body):
                parents[each] = pose
                pose = product(pose, self.model.joint(each, place))
            poses.append(product(pose, task["at"][side]))
        return parents, poses

    def levers(self, row, side, task, half, parents, poses):
        """Of each rotary joint of a row that begins at a surface."""
        model, found, moved, group = self.model, {}, ZERO, []
        low, high, middle, radius = self.bounds(task["surfaces"][side])
        for body in row:
            axis = model.bodies[body][2]
            if not model.axes[axis]["rotary"]:
                group.append(body)
                continue
            moved, group = moved + self.shift(group, half), []
            pose = parents[body]
            along = turned(pose[0], self.direction(body))
            pivot = add(turned(pose[0], model.bodies[body][4]), pose[1])

            def distance(p, along=along, pivot=pivot):
                off = cross(take(add(turned(poses[side][0], p), poses[side][1]), pivot), along)
                return dot(off, off).root()
            corners = [[R((high if k >> i & 1 else low)[i]) for i in range(3)] for k in range(8)]
            by_box = max(distance(corner).high for corner in corners)
            by_ball = (distance(middle) + radius * R.of(1 + fractions.Fraction(1, 10 ** 12))).high
            found[body] = moved + R(min(by_box, by_ball))
            moved = moved + self.chord(body, found[body], half)
        return found

    def bounds(self, index):
        """Box, its middle, and the largest distance of a corner from it."""
        if index not in self.sizes:
            corners = [corner for triangle in self.model.surfaces[index] for corner in triangle]
            low = [min(corner[i] for corner in corners) for i in range(3)]
            high = [max(corner[i] for corner in corners) for i in range(3)]
            middle = [(a + b) // 2 for a, b in zip(low, high)]
            radius = max(math.isqrt(sum((x - m) ** 2 for x, m in zip(corner, middle))) + 1
                         for corner in corners)
            self.sizes[index] = low, high, [R(x) for x in middle], R(radius)
        return self.sizes[index]

    def direction(self, body):
        along = self.model.bodies[body][3]
        return scaled(UNIT / dot(along, along).root(), along)

    def chord(self, body, lever, half):
        axis = self.model.bodies[body][2]
        return R.of(2) * lever * sine_of_half(half[axis] * self.model.axes[axis]["unit"])

    def shift(self, group, half):
        total = ZERO
        for one in group:
            for other in group:
                ways = [R.of(half[axis] * self.model.axes[axis]["unit"])
                        for axis in (self.model.bodies[one][2], self.model.bodies[other][2])]
                total = total + ways[0] * ways[1] * dot(self.direction(one),
                                                        self.direction(other)).absolute()
        return total.root()

    def motion(self, task, half, parents, poses):
        chains = [self.model.chain(body) for body in task["bodies"]]
        row = [body for body in reversed(chains[0]) if body not in chains[1]] + \
              [body for body in chains[1] if body not in chains[0]]
        row = [body for body in row if self.model.bodies[body][2] >= 0]
        of_a = self.levers(row, 0, task, half, parents, poses)
        of_b = self.levers(row[::-1], 1, task, half, parents, poses)
        total, group = ZERO, []
        for body in row:
            if not self.model.axes[self.model.bodies[body][2]]["rotary"]:
                group.append(body)
                continue
            total = total + self.shift(group, half) + \
                self.chord(body, of_a[body].least(of_b[body]), half)
            group = []
        return total + self.shift(group, half)

    def judge_box(self, index, box, directions):
        key = index, box, directions
        if key not in self.judged:
            self.judged[key] = self.is_apart(self.model.tasks[index], box, directions)
        return self.judged[key]

    def is_apart(self, task, box, directions):
        half_ = fractions.Fraction(1, 2)
        place = [(a + b) * half_ for a, b in zip(*box)]
        half = [(b - a) * half_ for a, b in zip(*box)]
        surfaces = [self.model.surfaces[i] for i in task["surfaces"]]
        if not all(surfaces):
            return True
        parents, poses = self.places_of(task, place)
        rows, shift = product(inverse(poses[1]), poses[0])  # surface a in the frame of b
        r = R.of(task["margin"]) + R.of(task["error"]) + self.motion(task, half, parents, poses)
        tops, bottoms, least = [], [], []
        for direction in directions:
            e = [R.of(x) for x in direction]
            if not any(direction):
                continue
            of_a = turned(transposed(rows), e)
            tops.append([max(highest(of_a, corner) for corner in t) for t in surfaces[0]])
            bottoms.append([min(-highest([-x for x in e], corner) for corner in t)
                            for t in surfaces[1]])
            needed = dot(e, e).root() * r + dot(e, shift)
            least.append((needed.high + 1) << S)
        return covers(tops, bottoms, least)

    def judge_node(self, index, node):
        key = index, tuple(node)
        if key not in self.judged:
            task = self.model.tasks[index]
            _, poses = self.places_of(task, [fractions.Fraction(x) for x in node])
            self.judged[key] = all(
                self.is_outside(task["wholes"][s], poses[s], task["wholes"][1 - s], poses[1 - s])
                for s in range(2))
        return self.judged[key]

    def parts_of(self, index):
        if index not in self.parts:
            self.parts[index] = parts_of(self.model.surfaces[index])
        return self.parts[index]

    def is_outside(self, one, one_pose, other, other_pose):
        rows, shift = product(inverse(other_pose), one_pose)
        closed = self.parts_of(other)[1]
        for corner in self.parts_of(one)[0]:
            point = add(turned(rows, [R(x) for x in corner]), shift)
            draw = random.Random(7)
            for _ in range(16):
                ray = [R.of(draw.randint(-999, 999) or 1) for _ in range(3)]
                number = winding(closed, point, ray)
                if number is not None:
                    break
            if number != 0:
                return False
        return True


def highest(e, corner):
    """An upper bound of e . corner, in multiples of 2^(-2 S)."""
    return sum((x.high if v > 0 else x.low) * v for x, v in zip(e, corner))


def covers(tops, bottoms, least):
    """For every pair of triangles some direction has bottom - top above its least."""
    if any(min(b) - max(a) > t for a, b, t in zip(tops, bottoms, least)):
        return True
    if not tops:
        return False
    for i in range(len(tops[0])):
        for j in range(len(bottoms[0])):
            if not any(b[j] - a[i] > t for a, b, t in zip(tops, bottoms, least)):
                return False
    return True


def parts_of(triangles):
    """A corner of each connected part, and the triangles of the closed ones."""
    part = {}

    def root(x):
        while part.setdefault(x, x) != x:
            x = part[x]
        return x
    edges = {}
    named = [[tuple(corner) for corner in t] for t in triangles]
    for t in named:
        for i in range(3):
            edge = t[i], t[(i + 1) % 3]
            part[root(edge[0])] = root(edge[1])
            edges[edge] = edges.get(edge, 0) + 1
    open_ = {root(a) for (a, b), runs in edges.items() if edges.get((b, a), 0) != runs}
    corners = {}
    for t in named:
        corners.setdefault(root(t[0]), t[0])
    return list(corners.values()), [t for t in named if root(t[0]) not in open_]


def sign(value):
    return 1 if value.low > 0 else -1 if value.high < 0 else 0


def winding(triangles, point, ray):
    total = 0
    for triangle in triangles:
        a, b, c = (take([R(x) for x in corner], point) for corner in triangle)
        signs = [sign(dot(ray, cross(p, q))) for p, q in ((a, b), (b, c), (c, a))]
        if 1 in signs and -1 in signs:
            continue
        side = sign(dot(a, cross(b, c)))
        if 0 in signs or side == 0:
            return None
        total += side if side == signs[0] else 0
    return total


def claims_of(model, certificate):
    """All boxes and nodes that a certificate claims: (index, box, directions), (index, node)."""
    boxes, nodes, holes = [], [], 0
    for index, (task, reader) in enumerate(zip(model.tasks, certificate.pairs)):
        if reader.get("I") != index:
            raise Untrue("another task")
        counts = [task["tool"] < 0 or tool in (task["tool"], EVERY) for tool in certificate.tools]
        directions, at, is_proven = None, 0, False
        while at < len(counts) * PARTS:
            if not counts[at // PARTS]:
                at, is_proven = (at // PARTS + 1) * PARTS, False
                continue
            end = at + reader.varint()
            if end == at or end > len(counts) * PARTS or not all(
                    counts[at // PARTS:-(-end // PARTS)]):
                raise Untrue("a stretch leaves its piece")
            head = reader.get("B")
            if head == 255:
                if not certificate.partial or at % PARTS or end % PARTS:
                    raise Untrue("a hole")
                at, is_proven, holes = end, False, holes + 1
                continue
            whole = certificate.tube(at, end)
            if any(max(abs(a), abs(b)) * axis["unit"] > axis["within"]
                   for a, b, axis in zip(*whole, model.axes)):
                raise Untrue("beyond what the errors are stated for")
            if not is_proven:
                nodes.append((index, tuple(certificate.nodes[at // PARTS])))
            open_ = [(whole, 0)]
            while open_:
                (low, high), depth = open_.pop()
                if head >= 128:
                    axis = head - 128
                    if depth == 24 or axis >= len(low):
                        raise Untrue("no such cut")
                    middle = low[axis] + (high[axis] - low[axis]) // 2
                    cut = [low[:axis] + (middle,) + low[axis + 1:],
                           high[:axis] + (middle,) + high[axis + 1:]]
                    open_ += [((cut[0], high), depth + 1), ((low, cut[1]), depth + 1)]
                elif head <= 64:
                    if head:
                        directions = tuple(tuple(reader.get("3f")) for _ in range(head))
                    if not directions or not all(math.isfinite(x) for d in directions for x in d):
                        raise Untrue("no directions")
                    boxes.append((index, (low, high), directions))
                else:
                    raise Untrue("no such tree")
                if open_:
                    head = reader.get("B")
            at, is_proven = end, True
        reader.end()
    return boxes, nodes, holes


def judge(model, data, known, boxes_max=None, nodes_max=None, draw=random):
    """Raises Untrue unless what is drawn of the certificate's claims is true."""
    boxes, nodes, holes = claims_of(model, Certificate(model, data))
    drawn = boxes if boxes_max is None or boxes_max >= len(boxes) else draw.sample(boxes, boxes_max)
    places = nodes if nodes_max is None or nodes_max >= len(nodes) else draw.sample(
        nodes, nodes_max)
    for box in drawn:
        if not known.judge_box(*box):
            raise Untrue(f"pair {box[0]}: box {box[1]} is not proven by {len(box[2])} directions")
    for node in places:
        if not known.judge_node(*node):
            raise Untrue(f"pair {node[0]}: inside at {node[1]}")
    return len(drawn), len(boxes), len(places), holes


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("model", type=pathlib.Path)
    parser.add_argument("certificate", type=pathlib.Path)
    parser.add_argument("--boxes", type=int)
    parser.add_argument("--places", type=int)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    try:
        model = Model(options.model.read_bytes())
        drawn, boxes, places, holes = judge(
            model, options.certificate.read_bytes(), Judge(model), options.boxes, options.places,
            random.Random(options.seed))
    except Untrue as fault:
        print(f"{options.certificate}: {fault}")
        return 10
    print(f"{options.certificate}: true in {drawn} of {boxes} boxes and at {places} places; "
          f"{holes} holes")
    return 0


if __name__ == "__main__":
    sys.exit(main())
