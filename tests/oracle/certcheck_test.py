#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""axguard-certcheck accepts right certificates of a toy machine, and refuses spoilt ones: bytes
changed, and contents changed with the sums made anew. What it accepts of these is judged by exact
arithmetic, has to be true, and is counted.

Example: certcheck_test.py build/host-release/axguard-certcheck --count 12000 --seed 1"""
import argparse
import collections
import math
import pathlib
import random
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tools")]
import certcheck_exact as exact  # noqa: E402
import certcheck_toy as toys  # noqa: E402

KINDS = {"path_keeping": {"promise": 1}, "independent": {"promise": 0},
         "jerk in all motion": {"promise": 0, "free_jerk": 1},
         "turns round": {"promise": 0, "turns": 1}}


class Checker:
    def __init__(self, program, folder):
        self.program, self.folder = program, pathlib.Path(folder)

    def __call__(self, model, certificate, *more):
        (self.folder / "t.model").write_bytes(model)
        (self.folder / "t.cert").write_bytes(certificate)
        run = subprocess.run([self.program, self.folder / "t.model", self.folder / "t.cert", *more],
                             capture_output=True, text=True, check=False)
        return run.returncode, run.stdout + run.stderr


def changed_byte(data, draw):
    at = draw.randrange(len(data))
    return data[:at] + bytes([data[at] ^ 1 << draw.randrange(8)]) + data[at + 1:]


def flipped(data, draw, letters=None):
    """One bit of a section, sums made anew."""
    sections = toys.sections_of(data)
    places = [i for i, (name, body) in enumerate(sections)
              if body and (letters is None or name in letters)]
    i = draw.choice(places)
    sections[i] = (sections[i][0], changed_byte(sections[i][1], draw))
    return toys.with_sums(sections)


def path_pushed(toy, draw):
    node, axis = draw.choice(toy.nodes), draw.randrange(2)
    node[axis] += round(draw.choice([-1, 1]) * draw.uniform(0.05, 1) *
                        (toys.RAD * 2 if axis else toys.MM * 80))


def pair_left_out(toy, draw):
    del toy.pairs[draw.randrange(len(toy.pairs))]
    if draw.random() < 0.7:  # of the model too
        del toy.tasks[draw.randrange(len(toy.tasks))]
        toy.pairs = [(i, stretches) for i, (_, stretches) in enumerate(toy.pairs)]


def some_directions(toy, draw):
    stretches = draw.choice(toy.pairs)[1]
    return draw.choice(toys.boxes_in(draw.choice(stretches)[1]))


def directions_turned(toy, draw):
    directions = some_directions(toy, draw)
    i, angle = draw.randrange(len(directions)), draw.uniform(0.1, math.pi)
    x, y, z = directions[i]
    directions[i] = draw.choice([
        (x * math.cos(angle) - y * math.sin(angle), x * math.sin(angle) + y * math.cos(angle), z),
        (-x, -y, -z), (x, y, draw.uniform(-3, 3)), (0.0, 0.0, 0.0)])


def direction_left_out(toy, draw):
    directions = some_directions(toy, draw)
    del directions[draw.randrange(len(directions))]


def triangle_moved(toy, draw):
    surface = draw.choice(toy.surfaces)
    i, axis = draw.randrange(len(surface)), draw.randrange(3)
    move = draw.uniform(-60, 60)
    surface[i] = tuple(tuple(x + move * (k == axis) for k, x in enumerate(corner))
                       for corner in surface[i])


def tube_widened(toy, draw):
    axis = draw.randrange(2)
    which = draw.choice(["delta", "f", "speeds"])
    if which == "speeds":
        for speeds in toy.speeds:
            speeds[2 * axis] = speeds[2 * axis + 1] = draw.randrange(100, 256)
    else:
        getattr(toy, which)[axis] += round(draw.uniform(0.02, 1) * (
            toys.RAD if axis else 40 * toys.MM))


def tube_narrowed(toy, draw):
    """f below the model's: the certificate keeps its own, the model's is twice as large."""
    axis = draw.randrange(2)
    toy.f[axis] = draw.randrange(toy.f[axis] // 2)


def tool_left_out(toy, draw):
    choice = draw.randrange(3)
    run = draw.randrange(2)
    tool, segments, first, last = toy.runs[run]
    toy.runs[run] = [(-1, segments, first, last), (1 - tool, segments, first, last),
                     (tool, segments, 0, 0)][choice]


def stretch_changed(toy, draw):
    stretches = draw.choice(toy.pairs)[1]
    i = draw.randrange(len(stretches))
    length, tree = stretches[i]
    stretches[i] = draw.choice([(length + draw.choice([-128, -1, 1, 256]), tree), (length, "hole"),
                                (length, ("cut", draw.randrange(3), tree, tree))])


def margin_raised(toy, draw):
    toy.margin += draw.uniform(0.2, 60)


CHANGES = [path_pushed, pair_left_out, directions_turned, direction_left_out, triangle_moved,
           tube_widened, tube_narrowed, tool_left_out, stretch_changed, margin_raised]


def spoilt(right, draw):
    """(kind, model, certificate)."""
    model, certificate = right.model(), right.certificate()
    choice = draw.random()
    if choice < 0.35:
        if draw.random() < 0.5:
            return "byte changed", changed_byte(model, draw), certificate
        return "byte changed", model, changed_byte(certificate, draw)
    if choice < 0.5:
        return "bit of the certificate, sums anew", model, flipped(certificate, draw)
    toy = right.copy()
    if choice < 0.6:
        model = flipped(model, draw)
        return "bit of the model, sums anew", model, toy.certificate(model)
    change = draw.choice(CHANGES)
    change(toy, draw)
    model_of = right if change is tube_narrowed else toy
    return change.__name__.replace("_", " "), model_of.model(), toy.certificate(model_of.model())


def campaign(check, count, draw):
    rights = [toys.proven_trunnion(**flags) for flags in KINDS.values()]
    refused, accepted = collections.Counter(), collections.Counter()
    judges, faults = {}, []
    for _ in range(count):
        try:
            kind, model, certificate = spoilt(draw.choice(rights), draw)
        except (ValueError, OverflowError, IndexError):
            continue  # nothing left to change, or no number of the format
        code, output = check(model, certificate)
        if code in (10, 12):
            refused[kind] += 1
            continue
        accepted[kind] += 1
        if code != 0 or kind == "byte changed":
            faults.append(f"{kind}: exit code {code}: {output[:200]}")
            continue
        try:
            if model not in judges:
                judges[model] = exact.Judge(exact.Model(model))
            exact.judge(judges[model].model, certificate, judges[model])
        except exact.Untrue as fault:
            faults.append(f"{kind}: accepted, and false: {fault}")
            (check.folder.parent / "false.model").write_bytes(model)
            (check.folder.parent / "false.cert").write_bytes(certificate)
    for kind in sorted(refused | accepted):
        print(f"{kind}: {refused[kind]} refused, {accepted[kind]} accepted and true")
    print(f"{sum(refused.values())} refused, {sum(accepted.values())} accepted and true")
    return faults


def plain_cases(check):
    """Right ones are accepted; each refusal has its exit code and names its place."""
    faults = []

    def expect(what, toy, code, words, model=None, certificate=None):
        found, output = check(toy.model() if model is None else model,
                              toy.certificate() if certificate is None else certificate)
        if found != code or words not in output:
            faults.append(f"{what}: {found}, wanted {code} and '{words}': {output[:300]}")
    for name, flags in KINDS.items():
        expect(name, toys.proven_trunnion(**flags), 0, ": proven\n")
    right = toys.proven_trunnion()
    model, certificate = right.model(), right.certificate()
    for cut in range(len(certificate)):
        expect(f"cut after {cut}", right, 12, "byte", certificate=certificate[:cut])
    expect("a byte more", right, 12, "bytes follow DONE", certificate=certificate + b"\0")
    expect("a sum", right, 10, "DONE, byte", certificate=certificate[:-1] + b"\0")
    other = right.copy()
    other.margin += 1
    expect("another model", right, 10, "REFS, byte", model=other.model(), certificate=certificate)
    hole = right.copy()
    hole.pairs[2][1][0] = (hole.pairs[2][1][0][0], "hole")
    expect("a hole", hole, 10, "(arm, head, T7 long), run 0, segment 3 (line 4): a hole")
    hole.partial = 1
    expect("a hole in a partial one", hole, 0, "proven, except for its holes")
    bare = right.copy()
    bare.runs = [(-1, 9, 0, 0)]
    bare.pairs = right.pairs[:1] + [(1, []), (2, [])]
    expect("no tool", bare, 0, "no tool, and no pair with one is judged: 9 segments")
    expect("tools", right, 0, "T1 short: 3 segments\n  T7 long: 3 segments\n  every tool: 3")
    near = right.copy()
    near.nodes[3][0] += 70 * toys.MM
    expect("a path in contact", near, 10, "no direction separates")
    far = right.copy()
    far.within = 10.0
    expect("beyond the stated errors", far, 10, "axis X")
    pair = right.copy()
    del pair.tasks[2], pair.pairs[2]
    expect("no task", pair, 10, "no task of arm and head with T7 long")
    pair.excluded.append((2, 3, "not claimed"))
    expect("excluded", pair, 0, "arm, head: not claimed")
    sections = toys.sections_of(certificate)
    expect("a pair left out", right, 12, "expected PAIR",
           certificate=toys.with_sums(sections[:-1]))
    expect("another order", right, 12, "expected LINE", certificate=toys.with_sums(
        [sections[i] for i in (0, 1, 3, 2, 4, 5, 6)]))
    expect("bytes left over", right, 12, "left over", certificate=toys.with_sums(
        sections[:-1] + [(b"PAIR", sections[-1][1] + b"\0")]))
    return faults


def positions(check):
    """Positions in the tube and outside."""
    right = toys.proven_trunnion()
    table = check.folder / "positions.csv"
    faults = []
    cases = [("on the path", "t,X,A\n0,0,0\n1,10,2.8647889757\n", 0, "2 positions, 0 outside"),
             ("beside it", "A,X\n-51.566,-5.0045\n-51.566,-5.0047\n0,26\n", 10,
              "3 positions, 2 outside of the tube, the first in line 3"),
             ("no axis", "X,B\n0,0\n", 12, "no column A"),
             ("no number", "X,A\n0,\n", 12, ":2: no number for axis A")]
    for what, rows, code, words in cases:
        table.write_text(rows)
        found, output = check(right.model(), right.certificate(), "--positions", table)
        if found != code or words not in output:
            faults.append(f"{what}: {found}, wanted {code} and '{words}': {output[-200:]}")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("--count", type=int, default=12000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        check = Checker(options.program, folder)
        faults = plain_cases(check) + positions(check)
        faults += campaign(check, options.count, random.Random(options.seed))
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
