#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Takes one rule after the other out of axguard-certcheck. Each time it has to accept a certificate
that is false, which the whole program and exact arithmetic refuse. The text that is replaced has to
occur exactly once.

Example: certcheck_ablations.py . c++"""
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tools")]
import certcheck_exact as exact  # noqa: E402
import certcheck_toy as toys  # noqa: E402

ROOM = "hil_replay/certcheck"
AT_Z, FREE = (0.0, 0.0, 1.0), (0.0, 0.0, 0.0)
TURN = (2.0, 20.0, 400.0, 30.0)
FAST = (200.0, 1000.0, 20000.0, 2000.0)


def direct(toy, nodes, directions):
    """One run, and one stretch that these directions are said to prove."""
    toy.nodes = nodes
    toy.runs = [(-1, len(nodes) - 1, 0, 0)]
    toy.speeds = toy.speeds or [[0] * 2 * len(toy.axes) for _ in nodes[1:]]
    toy.pairs = [(i, [((len(nodes) - 1) * toys.PARTS, list(directions))])
                 for i in range(len(toy.tasks))]
    return toy


def crossed_axes():
    """V turns about the arm and carries U, which turns about the post: each joint has a short lever
    with the axes in the middle, and they bring the arm 24 mm nearer."""
    bodies = [("post", -1, -1, FREE, FREE, 1), ("link", -1, 0, AT_Z, FREE, 0),
              ("arm", 1, 1, AT_Z, (100.0, 0.0, 0.0), 1)]
    small = (-1, 1)
    pieces = [[((99, 101), small, small)], [(small, small, small)]]
    toy = toys.Toy([("V", 1, TURN), ("U", 1, TURN)], bodies, pieces, [], [(2, 0, -1, 1, 0)], [],
                   margin=90.0)
    return direct(toy, [[round(-0.5 * toys.RAD)] * 2, [round(0.5 * toys.RAD)] * 2],
                  [(1.0, 0.0, 0.0)])


def wall(gap, **flags):
    """A slide whose path ends so far in front of a wall."""
    bodies = [("wall", -1, -1, FREE, FREE, 1), ("slide", -1, 0, (1.0, 0.0, 0.0), FREE, 1)]
    side = (-5, 5)
    pieces = [[((60, 80), side, side)], [((-10, 10), side, side)]]
    toy = toys.Toy([("X", 0, FAST), ("A", 1, TURN)], bodies, pieces, [], [(1, 0, -1, 1, 0)], [],
                   **flags)
    toy.speeds = [[255, 255, 0, 0]]
    return direct(toy, [[0, 0], [round((50 - gap) * toys.MM), 0]], [(1.0, 0.0, 0.0)])


def in_a_shell():
    """A block inside a closed box, far from each of its sides."""
    bodies = [("shell", -1, -1, FREE, FREE, 1), ("block", -1, 0, (1.0, 0.0, 0.0), FREE, 1)]
    large, small = (-50, 50), (-5, 5)
    toy = toys.Toy([("X", 0, FAST)], bodies, [[(large,) * 3], [(small,) * 3]], [],
                   [(1, 0, -1, 1, 0)], [])
    sides = [tuple(float(s) if i == k else 0.0 for i in range(3))
             for k in range(3) for s in (1, -1)]
    return direct(toy, [[0], [toys.MM]], sides)


def two_shells():
    """A surface of two parts: the first is outside of the shell, the second inside."""
    toy = in_a_shell()
    toy.surfaces[1] = toys.box((-210, -200), (-5, 5), (-5, 5)) + toy.surfaces[1]
    return toy


def without_task():
    toy = wall(20)
    toy.tasks, toy.pairs = [], []
    return toy


def swapped_model():
    """The certificate names another model than the one that is judged."""
    return wall(20), wall(20, error=0.02).model()


def low_following():
    """f of the head below the model's."""
    toy = wall(20)
    model = toy.model()
    toy.f = [x // 4 for x in toy.f]
    return toy, model


def with_hole():
    toy = wall(20)
    toy.pairs = [(0, [(toys.PARTS, "hole")])]
    return toy


def short_stretch():
    """The last quarter of the segment, which ends in the wall, has no proof."""
    toy = wall(-5)
    toy.pairs = [(0, [(toys.PARTS * 3 // 4, [(1.0, 0.0, 0.0)])])]
    return toy


def two_triangles():
    """The direction separates the slide from the upper half of the wall's triangles."""
    toy = wall(20)
    toy.surfaces[0] = toy.surfaces[0] + toys.box((30, 50), (-5, 5), (-5, 5))
    return toy


UP = "std::int64_t up = delta[axis] + following[axis], down = up;"
ABLATIONS = [  # what is left out, file, text, what stands there instead, the false certificate
    ("levers between joints", "linkage.cpp",
     "levers[i] = (moved + distance_max(*row[i], side)).high;",
     "levers[i] = distance_max(*row[i], side);", crossed_axes),
    ("delta", "certificate.cpp", UP, "std::int64_t up = following[axis], down = up;",
     lambda: wall(2, delta=[toys.MM * 5, 0])),
    ("f", "certificate.cpp", UP, "std::int64_t up = delta[axis], down = up;",
     lambda: wall(2, f=[toys.MM * 5, 0])),
    ("rho", "certificate.cpp", "if (!speeds_.empty()) {", "if (false) {",
     lambda: wall(5, promise=0)),
    ("motion", "check_task.cpp", "+ linkage_.motion(half)", "", lambda: wall(-15)),
    ("margin", "check_task.cpp", "Interval(task_.margin) + task_.error", "Interval(task_.error)",
     lambda: wall(2, margin=5.0)),
    ("error", "check_task.cpp", "Interval(task_.margin) + task_.error", "Interval(task_.margin)",
     lambda: wall(2, error=5.0)),
    ("what errors are stated for", "check_task.cpp", "if (most > axis.within) {", "if (false) {",
     lambda: wall(20, within=5.0)),
    ("containment", "check_task.cpp", "if (!is_outside(", "if (false && !is_outside(", in_a_shell),
    ("parts beyond the first", "enclosure.cpp", "for (const Vector& corner : one.corners) {",
     "for (const Vector& corner : {one.corners[0]}) {", two_shells),
    ("triangles but two", "separation.cpp", "open.push_back({of_a, of_b.lower()});", "",
     two_triangles),
    ("a direction that separates", "separation.cpp", "if (apart) {", "if (true) {",
     lambda: wall(-5)),
    ("all pairs", "read_model.cpp", "if (!covered.contains({a, b, tool})) {", "if (false) {",
     without_task),
    ("the model's name", "certificate.cpp", "if (references[0].second != model_sum) {",
     "if (false) {", swapped_model),
    ("the model's f", "certificate.cpp", "if (following.back() < axis.following) {",
     "if (false) {", low_following),
    ("holes", "check_task.cpp", "if (!certificate_.is_partial) {", "if (false) {", with_hole),
    ("the end of a piece", "check_task.cpp", "while (at < last * kParts) {",
     "while (at == first * kParts) {", short_stretch),
]


def objects_of(compiler, source, folder, only=None):
    """Object files of the room's sources, or of one of them."""
    found = {}
    for each in sorted((source / ROOM).glob("*.cpp")):
        if only in (None, each.name):
            found[each.name] = folder / f"{each.name}.o"
            subprocess.run([compiler, "-std=c++20", "-O1", "-ffp-contract=off", f"-I{source}", "-c",
                            '-DAXG_VERSION="0"', each, "-o", found[each.name]], check=True)
    return found


def linked(compiler, objects, program):
    subprocess.run([compiler, *objects.values(), "-o", program], check=True)
    return program


def is_false(model, certificate):
    try:
        exact_model = exact.Model(model)
        exact.judge(exact_model, certificate, exact.Judge(exact_model))
    except exact.Untrue:
        return True
    return False


def main():
    root, compiler = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    faults = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copytree(root / ROOM, folder / ROOM)
        whole = objects_of(compiler, folder, folder)
        program = linked(compiler, whole, folder / "whole")
        for what, file, text, instead, make in ABLATIONS:
            made = make()
            toy, model = made if isinstance(made, tuple) else (made, made.model())
            files = [folder / "t.model", folder / "t.cert"]
            files[0].write_bytes(model)
            files[1].write_bytes(toy.certificate(None if make is swapped_model else model))
            source = (root / ROOM / file).read_text()
            if source.count(text) != 1:
                faults.append(f"{what}: '{text}' occurs {source.count(text)} times in {file}")
                continue
            (folder / ROOM / file).write_text(source.replace(text, instead))
            ablated = linked(compiler, whole | objects_of(compiler, folder, folder / ROOM, file),
                             folder / "ablated")
            (folder / ROOM / file).write_text(source)
            codes = [subprocess.run([each, *files], capture_output=True, check=False).returncode
                     for each in (program, ablated)]
            false = is_false(model, files[1].read_bytes())
            print(f"without {what}: {codes[1]}, whole: {codes[0]}, exact: "
                  f"{'false' if false else 'true'}")
            if codes[0] not in (10, 12) or codes[1] != 0 or not false:
                faults.append(f"{what}: wanted false, and accepted without this rule alone")
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
