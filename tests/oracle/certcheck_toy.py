# SPDX-License-Identifier: Apache-2.0
"""Toy machines of boxes, and certificates of them: what the tests of axguard-certcheck write, spoil
and judge. The prover here is as plain as can be, in floating point."""
import copy
import hashlib
import itertools
import math
import struct

MM, RAD = 1 << 16, 1 << 24
PARTS, EVERY = 256, -2


def varint(value):
    out = b""
    while value >= 128:
        out, value = out + bytes([value % 128 + 128]), value >> 7
    return out + bytes([value])


def zigzag(value):
    return varint(2 * value if value >= 0 else -2 * value - 1)


def text(word):
    return struct.pack("<H", len(word)) + word.encode()


def with_sums(sections):
    """A file of (letters, bytes)."""
    chain, out = bytes(32), b""
    for letters, body in sections:
        part = letters + len(body).to_bytes(8, "little") + body
        chain, out = hashlib.sha256(chain + part).digest(), out + part
    return out + b"DONE" + (32).to_bytes(8, "little") + chain


def sections_of(data):
    """The sections of a file but DONE."""
    found, at = [], 0
    while data[at:at + 4] != b"DONE":
        length = int.from_bytes(data[at + 4:at + 12], "little")
        found.append((data[at:at + 4], data[at + 12:at + 12 + length]))
        at += 12 + length
    return found


def box(x, y, z, inwards=False):
    """The 12 triangles of a box, closed and seen from outside."""
    corners = [(x[i & 1], y[i >> 1 & 1], z[i >> 2]) for i in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    found = []
    for quad in quads:
        a, b, c, d = (corners[i] for i in (quad[::-1] if inwards else quad))
        found += [(a, b, c), (a, c, d)]
    return found


class Toy:
    """A machine, a path and its proofs, as lists that a test may change before bytes are made."""

    def __init__(self, axes, bodies, pieces, tools, tasks, excluded, **flags):
        self.axes, self.bodies, self.tools, self.tasks = axes, bodies, tools, tasks
        self.pieces = pieces  # of each surface: boxes (x, y, z)
        self.surfaces = [[t for piece in each for t in box(*piece)] for each in pieces]
        self.excluded = excluded
        self.promise, self.free_jerk, self.turns = 1, 0, 0
        self.delta, self.f = [200] * len(axes), [100] * len(axes)
        self.margin, self.error, self.partial, self.within = 1.0, 0.01, 0, math.inf
        self.__dict__.update(flags)
        self.nodes, self.runs, self.speeds, self.pairs = [], [], [], []

    def copy(self):
        return copy.deepcopy(self)

    # The files.
    def model(self):
        axes = struct.pack("<I", len(self.axes))
        for i, (name, is_rotary, limits) in enumerate(self.axes):
            axes += text(name) + struct.pack("<B4dqd", is_rotary, *limits, self.f[i] // 2,
                                             self.within)
        bodies = struct.pack("<I", len(self.bodies))
        for name, parent, axis, along, pivot, has_surface in self.bodies:
            bodies += text(name) + struct.pack("<2i6dB", parent, axis, *along, *pivot, has_surface)
        surfaces = struct.pack("<I", len(self.surfaces))
        for i, triangles in enumerate(self.surfaces):
            surfaces += text(f"s{i}") + struct.pack("<I", len(triangles))
            surfaces += b"".join(struct.pack("<9f", *a, *b, *c) for a, b, c in triangles)
        tasks = struct.pack("<I", len(self.tools))
        for number, name in self.tools:
            tasks += struct.pack("<H", number) + text(name)
        tasks += struct.pack("<I", len(self.tasks))
        pose = (1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0)
        for a, b, tool, surface_a, surface_b in self.tasks:
            tasks += struct.pack("<3i24d4I2d", a, b, tool, *pose, *pose, surface_a, surface_b,
                                 surface_a, surface_b, self.margin, self.error)
        excluded = struct.pack("<I", len(self.excluded))
        for a, b, why in self.excluded:
            excluded += struct.pack("<2i", a, b) + text(why)
        head = struct.pack("<I3B", 1, self.promise, self.free_jerk, self.turns)
        return with_sums([(b"MODL", head), (b"AXES", axes), (b"BODY", bodies),
                          (b"SURF", surfaces), (b"TASK", tasks), (b"EXCL", excluded)])

    def certificate(self, model=None):
        head = struct.pack("<I", 1) + text("toy") + struct.pack("<2BI", self.promise, self.partial,
                                                               len(self.axes))
        head += b"".join(struct.pack("<2q", d, f) for d, f in zip(self.delta, self.f))
        sums = [hashlib.sha256(self.model() if model is None else model).digest()] + \
            [hashlib.sha256(word).digest() for word in (b"machine", b"program", b"arguments")]
        refs = struct.pack("<I", 4) + b"".join(
            text(n) + s for n, s in zip(("model", "machine", "program", "arguments"), sums))
        count = len(self.nodes) - 1
        line = b"".join(varint(1) + zigzag(1) for _ in range(count))
        path = struct.pack("<I", len(self.runs))
        for tool, segments, first, last in self.runs:
            path += struct.pack("<i", tool) + varint(segments) + varint(first) + varint(last)
        before = [0] * len(self.axes)
        for node in self.nodes:
            path += b"".join(zigzag(x - y) for x, y in zip(node, before))
            before = node
        if self.promise == 0:
            path += b"".join(bytes(each) for each in self.speeds)
        parts = [(b"HEAD", head), (b"REFS", refs), (b"LINE", line), (b"PATH", path)]
        for index, stretches in self.pairs:
            body = struct.pack("<I", index) + b"".join(varint(n) + bytes_of(t)
                                                       for n, t in stretches)
            parts.append((b"PAIR", body))
        return with_sums(parts)

    # The prover.
    def counts(self, task):
        found = []
        for tool, segments, first, last in self.runs:
            for i in range(segments):
                every = i < first or i >= segments - last
                found.append(task[2] < 0 or every or tool == task[2])
        return found

    def reach(self, axis, byte):
        v, a, j, d = self.axes[axis][2]
        f = self.f[axis] / (RAD if self.axes[axis][1] else MM)
        if not self.free_jerk and not self.turns and byte == 0 and f == 0:
            return 0
        u = min(v, byte * v / 255 + 2 * math.sqrt(2 * a * f))

        def braking(x, b):
            g = min((b + d) / j, (b + math.sqrt(b * b + 2 * j * x)) / j)
            return g * (x + g * (b / 2 - g * j / 6)) + \
                max(0, x + g * (b - j * g / 2)) ** 2 / (2 * d)
        top = u if self.free_jerk else v
        b = min(a, math.sqrt(2 * j * top))
        later = top * b / j + braking(top, 0) - (b ** 3 / (6 * j * j) if self.free_jerk else 0)
        return math.ceil(min(braking(u, a), later) * (RAD if self.axes[axis][1] else MM)) + 1

    def tube(self, first, last, widened=True):
        low, high = [], []
        for axis in range(len(self.axes)):
            lows, highs = [], []
            for i in range(first // PARTS, -(-last // PARTS)):
                up = down = (self.delta[axis] + self.f[axis]) * widened
                if self.promise == 0 and widened:
                    up += self.reach(axis, self.speeds[i][2 * axis])
                    down += self.reach(axis, self.speeds[i][2 * axis + 1])
                start, way = self.nodes[i][axis], self.nodes[i + 1][axis] - self.nodes[i][axis]
                for part in max(first - i * PARTS, 0), min(last - i * PARTS, PARTS):
                    lows.append((start * PARTS + way * part) // PARTS - down)
                    highs.append(-((-start * PARTS - way * part) // PARTS) + up)
            low.append(min(lows))
            high.append(max(highs))
        return low, high

    def prove(self, motion, directions, widened=True):
        """Fills `pairs`: motion(task, box) in mm, directions(task, centre) as (e, gap)."""
        self.pairs = []
        for index, task in enumerate(self.tasks):
            stretches, counts, at = [], self.counts(task), 0
            while at < len(counts):
                end = at
                while end < len(counts) and counts[end]:
                    end += 1
                if end > at:
                    self.cover(task, at * PARTS, end * PARTS, stretches,
                               lambda t, k: self.tree(t, k, motion, directions), widened)
                at = end + 1
            self.pairs.append((index, stretches))
        return self

    def cover(self, task, first, last, stretches, tree_of, widened):
        tree = tree_of(task, self.tube(first, last, widened))
        if tree is not None:
            stretches.append((last - first, tree))
        elif last - first == 1:
            raise ValueError("too near to be certified")
        else:
            middle = (first + last) // 2
            if last - first > PARTS:
                middle = middle // PARTS * PARTS
            self.cover(task, first, middle, stretches, tree_of, widened)
            self.cover(task, middle, last, stretches, tree_of, widened)

    def tree(self, task, tube, motion, directions, depth=2):
        low, high = tube
        units = [RAD if axis[1] else MM for axis in self.axes]
        centre = [(a + b) / 2 / unit for a, b, unit in zip(low, high, units)]
        half = [(b - a) / 2 / unit for a, b, unit in zip(low, high, units)]
        needed = self.margin + self.error + motion(task, centre, half) + 2.0 ** -10
        found = directions(task, centre)
        if all(gap > needed for _, gap in found):
            return [e for e, _ in found]
        if depth == 0:
            return None
        axis = max(range(len(half)), key=lambda i: half[i] * (40 if self.axes[i][1] else 1))
        middle = low[axis] + (high[axis] - low[axis]) // 2
        lower, upper = list(high), list(low)
        lower[axis] = upper[axis] = middle
        trees = [self.tree(task, cut, motion, directions, depth - 1)
                 for cut in ((low, lower), (upper, high))]
        return None if None in trees else ("cut", axis, *trees)


def bytes_of(tree):
    if tree == "hole":
        return b"\xff"
    if isinstance(tree, tuple):
        return bytes([128 + tree[1]]) + bytes_of(tree[2]) + bytes_of(tree[3])
    return bytes([len(tree)]) + b"".join(struct.pack("<3f", *e) for e in tree)


def boxes_in(tree):
    """The lists of directions in a tree."""
    if tree == "hole":
        return []
    return boxes_in(tree[2]) + boxes_in(tree[3]) if isinstance(tree, tuple) else [tree]


# A turning arm that slides: A about Z carries X, X carries the arm.
def trunnion():
    """Two boxes as the bed, an arm with A and X, and a head with two tools."""
    free = (0.0, 0.0, 0.0)
    bodies = [("bed", -1, -1, free, free, 1), ("turn", -1, 1, (0.0, 0.0, 1.0), free, 0),
              ("arm", 1, 0, (1.0, 0.0, 0.0), free, 1), ("head", -1, -1, free, free, 2)]
    flat = (-10, 10)
    pieces = [[((60, 80), (-50, 50), flat), ((-40, 40), (60, 80), flat)],
              [((-15, 15), (-5, 5), (-5, 5))], [((-10, 10), (-80, -55), flat)],
              [((-10, 10), (-80, -45), flat)]]
    axes = [("X", 0, (200.0, 1000.0, 20000.0, 2000.0)), ("A", 1, (2.0, 20.0, 400.0, 30.0))]
    toy = Toy(axes, bodies, pieces, [(1, "short"), (7, "long")],
              [(0, 2, -1, 0, 1), (2, 3, 0, 1, 2), (2, 3, 1, 1, 3)],
              [(0, 3, "both are fixed to the frame")])
    places = [(0, 0), (20, 0.1), (25, 0.3), (10, 0.8), (0, 1.2), (5, 0.9), (15, 0.2), (0, -0.4),
              (-5, -0.9), (0, 0)]
    toy.nodes = [[round(x * MM), round(a * RAD)] for x, a in places]
    toy.runs = [(0, 4, 0, 1), (1, 5, 2, 0)]
    toy.speeds = [[60, 60, 60, 60] for _ in places[1:]]
    return toy


def trunnion_motion(task, centre, half):
    """X by its half width, A by the arm's lever, which X makes longer."""
    lever = math.hypot(abs(centre[0]) + 15, 5) + half[0]
    if task[1] == 2:  # the bed's own lever may be less
        lever = min(lever, math.hypot(80, 50))
    return half[0] + 2 * lever * math.sin(min(half[1], math.pi) / 2)


def trunnion_directions(toy):
    """For each box of the other body a direction that separates the arm from it."""
    def found(task, centre):
        x, a = centre
        turn = ((math.cos(a), -math.sin(a)), (math.sin(a), math.cos(a)))
        arm = [(x + px, py) for px, py in itertools.product((-15, 15), (-5, 5))]
        arm = [tuple(r[0] * p[0] + r[1] * p[1] for r in turn) for p in arm]
        arm_first = task[0] == 2
        best = []
        for px, py, _ in toy.pieces[task[4] if arm_first else task[3]]:
            other = list(itertools.product(px, py))
            ways = [(math.cos(k * math.pi / 90), math.sin(k * math.pi / 90)) for k in range(180)]
            gaps = [(min(n[0] * p[0] + n[1] * p[1] for p in other) -
                     max(n[0] * p[0] + n[1] * p[1] for p in arm), n) for n in ways]
            gap, n = max(gaps)
            # From a to b, in the frame of b: machine frame for the fixed bodies, else the arm's.
            e = (n[0], n[1], 0.0) if arm_first else (
                -(turn[0][0] * n[0] + turn[1][0] * n[1]), -(turn[0][1] * n[0] + turn[1][1] * n[1]),
                0.0)
            best.append((struct.unpack("<3f", struct.pack("<3f", *e)), gap))
        return best
    return found


def proven_trunnion(promise=1, **flags):
    toy = trunnion()
    toy.promise = promise
    toy.__dict__.update(flags)
    return toy.prove(trunnion_motion, trunnion_directions(toy))
