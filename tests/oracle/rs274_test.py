#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""This reader of G-code beside LinuxCNC's own interpreter, on random programs and on real ones: the
same programs are accepted, and their canonical motions are equal to the 1e-4 that it prints.

    rs274_test.py PRINT_MOVES GCODE_FOLDER
"""
import ctypes
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
TOLERANCE = 2.6e-3  # mm: it prints 1e-4 of an inch or mm
CYCLES = ("G73", "G81", "G82", "G83", "G84", "G85", "G86", "G89")
TOOLS = "tools.tbl"
TOOL_NUMBERS = (1, 8, 21, 48, 52, 150)
DIAMETER_MM = 6  # of all these (print_moves.cpp)
INCH = 25.4  # mm: the unit of its tool table
TIP_TOOLS = {1: 50, 2: 80}  # mm, of tests/support/motion_machine.hpp
# Words of another machine's configuration: neither side is asked about them.
LEFT_OUT = re.compile(r"(?i)\bM42[89]\b")
# Lines that move along a spline, and how many moves each control point makes there.
SPLINE = re.compile(r"(?i)g0*5(?:\.[013])?(?![\d.])")
SPLINE_MOVES = 8
COMMENT = re.compile(r"\([^)]*\)|;.*|\s")
CALL = re.compile(r"N[\d.]+\s*([A-Z]\w*)\(([^)]*)\)")


class Canon:
    """Its canonical calls as motions in machine coordinates, mm and degrees."""

    def __init__(self):
        self.unit = 1.0
        self.offsets = {"g5x": [0.0] * 6, "g92": [0.0] * 6, "tool": [0.0] * 6}
        self.motions = []
        self.plane, self.rotation = "XY", 0.0

    def machine(self, values):
        """Offsets were given in the unit that was on then, so they are kept in mm. G92's turns."""
        scaled = [v * (self.unit if i < 3 else 1) for i, v in enumerate(values)]
        x, y, *others = [v + g92 for v, g92 in zip(scaled, self.offsets["g92"])]
        cos, sin = math.cos(self.rotation), math.sin(self.rotation)
        turned = [x * cos - y * sin, x * sin + y * cos, *others]
        return [v + self.offsets["g5x"][i] + self.offsets["tool"][i] for i, v in enumerate(turned)]

    def in_mm(self, values):
        return [v * (self.unit if i < 3 else 1) for i, v in enumerate(values)]

    def take(self, name, text):
        if name == "USE_LENGTH_UNITS":
            self.unit = 25.4 if "INCHES" in text else 1.0
        elif name == "SELECT_PLANE":
            self.plane = text[-2:]
        elif name == "SET_G5X_OFFSET":
            self.offsets["g5x"] = self.in_mm([float(v) for v in text.split(",")[1:]])
        elif name == "SET_XY_ROTATION":
            self.rotation = math.radians(float(text))
        elif name == "SET_G92_OFFSET":
            self.offsets["g92"] = self.in_mm([float(v) for v in text.split(",")])
        elif name == "USE_TOOL_LENGTH_OFFSET":
            values = text.replace(",", " ").split()[:6]
            self.offsets["tool"] = self.in_mm([float(v) for v in values])
        elif name in ("STRAIGHT_TRAVERSE", "STRAIGHT_FEED"):
            kind = "rapid" if name == "STRAIGHT_TRAVERSE" else "feed"
            self.motions.append((kind, self.machine([float(v) for v in text.split(",")])))
        elif name == "RIGID_TAP":  # in and out again
            before = self.motions[-1][1][:6] if self.motions else [0.0] * 6
            tap = self.machine([float(v) for v in text.split(",")] + [0.0] * 3)
            self.motions += [("feed", tap[:3] + before[3:]), ("feed", before)]
        elif name == "ARC_FEED":
            self.arc([float(v) for v in text.split(",")])
        elif name == "NURBS_FEED":  # it prints the number of control points, and no end
            self.motions.append(("spline", [float(text.split(",")[0])]))
        elif name == "DWELL":
            self.motions.append(("dwell", [float(text)]))

    def arc(self, values):
        first, second, centre_first, centre_second, turns, along, *rotary = values
        i, j, k = {"XY": (0, 1, 2), "XZ": (2, 0, 1), "YZ": (1, 2, 0)}[self.plane]
        end, centre = [0.0] * 6, [0.0] * 6
        end[i], end[j], end[k], end[3:] = first, second, along, rotary
        centre[i], centre[j] = centre_first, centre_second
        end, centre = self.machine(end), self.machine(centre)
        self.motions.append(("arc", end + [centre[i], centre[j], turns]))


def of_linuxcnc(program, *options):
    """Motions, or None where it refuses the program."""
    done = subprocess.run(["rs274", *options, "-t", TOOLS, "-g", program], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False,
                          cwd=os.path.dirname(program))
    canon = Canon()
    for name, text in CALL.findall(done.stdout):
        canon.take(name, text)
    # It ends with 0 after an error too; only a whole program reaches its end.
    return canon.motions if "PROGRAM_END" in done.stdout and done.returncode == 0 else None


def of_axguard(print_moves, program, *options):
    done = subprocess.run([print_moves, "--lines", *options, program], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        return None, done.stderr
    text = pathlib.Path(program).read_text(encoding="latin-1").splitlines()
    splines = {i + 1 for i, line in enumerate(text) if SPLINE.search(COMMENT.sub("", line))}
    motions, last = [], 0
    for line in done.stdout.splitlines():
        number, kind, *values = line.split()
        values = [float(v) for v in values]
        if int(number) in splines and kind in ("arc", "feed"):
            count = motions.pop()[1][6] if last == number else 0
            motions.append(("spline", values[:6] + [count + 1 / SPLINE_MOVES]))
            last = number
            continue
        last = 0
        if kind == "arc":
            _, _, first, second, sweep = values[6:]
            turns = math.copysign(max(1, math.ceil(abs(sweep) / (2 * math.pi) - 1e-6)), sweep)
            values = values[:6] + [first, second, turns]
        motions.append((kind, values))
    return motions, ""


def without_rests(motions):
    """Without moves to where the machine is, and pauses of nothing: neither moves an axis."""
    out, at = [], [0.0] * 6
    for kind, values in motions:
        if kind == "dwell":
            if values[0] > 0:
                out.append((kind, values))
            continue
        if kind in ("arc", "spline") or max(abs(a - b) for a, b in zip(values, at)) > 1e-9:
            out.append((kind, values))
        at = values[:6]
    return out


def difference(ours, theirs):
    """Of a spline they print no end: it is ours, and the motions after it tell."""
    ends = iter([values[:6] for kind, values in ours if kind == "spline"])
    theirs = [(kind, next(ends, []) + values if kind == "spline" else values)
              for kind, values in theirs]
    ours, theirs = without_rests(ours), without_rests(theirs)
    for i, (one, other) in enumerate(zip(ours, theirs)):
        same = one[0] == other[0] and all(
            abs(a - b) <= TOLERANCE for a, b in zip(one[1], other[1]))
        if not same:
            return f"motion {i}: ours {one}, theirs {other}"
    if len(ours) != len(theirs):
        return f"{len(ours)} motions, theirs {len(theirs)}"
    return ""


def random_program(rng):
    plain = lambda low, high: f"{rng.uniform(low, high):.3f}"

    def number(low, high):
        """A value between these, written as a number, as a parameter or as an expression."""
        value = rng.uniform(low, high)
        return rng.choice((
            lambda: f"{value:.3f}", lambda: f"{value:.3f}", lambda: f"[{value - 2:.3f} + 2]",
            lambda: f"[[{value:.3f} - #1] + #1]", lambda: f"-[0 - {value:.3f}]",
            lambda: f"[{value / 4:.4f} * 2 ** 2]", lambda: f"[{value:.3f} * cos[0] + sin[180]]",
            lambda: f"[#<_name> * 0 + {value:.3f}]",
            lambda: f"[{value:.3f} + [#1 gt 3 and #2 le 3 or 0 eq 0] - 1]",
            lambda: f"[{value:.3f} + fix[2.7] - abs[-2] + [7 mod 4] - round[2.6]]",
            lambda: f"[{value:.3f} + atan[1]/[1] - 45]",
        ))()

    lines = [rng.choice(("", "O0042 (a part)", "n1 o<part> ; named")),
             f"G{rng.choice((20, 21))} G90 G94 F{number(50, 500)} S100 M3", "G0 X0 Y0 Z20",
             "#1 = 3.5 #2 = [#1 * 2]", "#<_Name> = 1.25", "#<own one> = -2"]
    plane, labels = 17, iter(range(100, 1000))

    def some_axes():
        letters = rng.sample("XYZABC", rng.randint(1, 4))
        return " ".join(f"{a}{number(-20, 20)}" for a in letters)

    def arc():
        first, second, i, j = {17: "XYIJ", 18: "ZXKI", 19: "YZJK"}[plane]
        return (f"G91 G{rng.choice((2, 3))} {first}{number(1, 5)} {second}{number(-5, 5)} "
                f"R{number(8, 20)}\nG90")

    def full_circle():
        _, _, i, _ = {17: "XYIJ", 18: "ZXKI", 19: "YZJK"}[plane]
        return f"G{rng.choice((2, 3))} {i}{number(2, 9)} P{rng.randint(1, 3)}"

    def cycle():
        # Outside of G17 its G84 feeds along the wrong axes (2.9.0).
        words = [word for word in CYCLES if plane == 17 or word != "G84"]
        cycle_word, up = rng.choice(words), {17: "Z", 18: "Y", 19: "X"}[plane]
        others = [letter for letter in "XYZ" if letter != up]
        bottom = rng.uniform(-9, 4)
        # In a row of cycles letters are kept; L repeats; G91 steps.
        words = [cycle_word, f"{up}{bottom:.3f}", f"R{number(5, 15)}", f"P{number(0, 2)}"
                 if cycle_word in ("G82", "G86", "G89") else "",
                 f"Q{number(1, 4)}" if cycle_word in ("G73", "G83") else ""]
        out = [" ".join([rng.choice(("G98", "G99", "")), *words,
                         f"{rng.choice(others)}{number(-9, 9)}"])]
        for _ in range(rng.randint(0, 3)):
            extra = rng.choice(("", "", "G98", "G99", f"R{number(5, 15)}", f"L{rng.randint(1, 3)}"))
            out.append(f"{rng.choice(others)}{number(-9, 9)} {extra}")
        if rng.random() < 0.4:
            words[1], words[2] = f"{up}{number(-5, -1)}", f"R{number(-4, 4)}"
            out.append(f"G91 {' '.join(words)} {others[0]}{number(-3, 3)} L{rng.randint(1, 3)}")
        return "\n".join(out + ["G80 G90"])

    def offset():
        return rng.choice((f"G10 L2 P{rng.randint(0, 9)} {some_axes()}",
                           f"G10 L20 P{rng.randint(1, 9)} {some_axes()}", f"G92 {some_axes()}",
                           f"G52 {some_axes()}", "G92.1", "G92.2", "G92.3",
                           f"G43.1 {some_axes()}", "G43 H1", "G49",
                           f"G{rng.choice((54, 55, 58, 59, 59.1, 59.3))}"))

    def feed_mode():
        """F is forgotten by G94 and G95, and a standing spindle moves nothing at feed."""
        word = rng.choice((94, 95, 95))
        return rng.choice((f"G{word} F{number(1, 9)}\nG1 {some_axes()}\nG94 F100",
                           f"S{rng.choice((0, 50, 50))} G95 F{number(1, 9)} G1 X#1\n"
                           f"G94 F{number(9, 99)}",
                           f"G{word}\nG1 X#1" if rng.random() < 0.1 else "G94 F60"))

    def modal():
        nonlocal plane
        word = rng.choice((17, 18, 19, 20, 21, 61, 64))
        plane = word if word in (17, 18, 19) else plane
        # Its G43.1 keeps the number and not the length when the unit changes (2.9.0).
        return ("G49\n" if word in (20, 21) else "") + f"g {word} ( said aside )"

    def flow():
        label = next(labels)
        inner = lambda: rng.choice((lambda: f"G0 {some_axes()}", lambda: f"G91 X#1\nG90",
                                    lambda: f"#2 = [#2 + {plain(-1, 1)}]", lambda: "G0 Z#2 Y#5421",
                                    lambda: "G1 X#<own one> F100"))()
        count = rng.randint(0, 3)
        # After a while loop with a break in it, run or not, its do loops end after one pass.
        has_while = any("WHILE" in line for line in lines)
        do = f"o{label} repeat [{max(1, count)}]", f"o{label} endrepeat"
        if not has_while:
            do = f"o{label} do", f"o{label} while [#3 lt {count}]"
        return rng.choice((
            f"o{label} repeat [{count}]\n{inner()}\no{label} endrepeat",
            f"#3 = 0\nO{label} WHILE [#3 lt {count}]\n#3 = [#3 + 1]\n{inner()}\n"
            f"o{label + 1000} if [#3 eq 2]\no{label} {rng.choice(('break', 'continue'))}\n"
            f"o{label + 1000} endif\n{inner()}\no{label} endwhile",
            f"#3 = 0\n{do[0]}\n#3 = [#3 + 1]\n{inner()}\n{do[1]}",
            f"o{label} if [#1 gt {plain(0, 7)}]\n{inner()}\no{label} elseif [#2 lt {plain(0, 9)}]\n"
            f"{inner()}\no{label} else\n{inner()}\no{label} endif",
            f"o<part {label}> sub\n#<own one> = #1\n#31 = #2\n{inner()}\n"
            f"o{label} if [#2 gt 1]\no<part {label}> return [#1 + 1]\no{label} endif\n{inner()}\n"
            f"o<part {label}> endsub [#2]\no<part{label}> call [{plain(-5, 5)}] [{plain(0, 2)}]\n"
            f"G0 X#<_value> Y#<own one> Z#31"))

    def spline():
        """Its end is told by the move after it, which names neither X nor Y."""
        words = lambda letters: " ".join(f"{letter}{number(1, 9)}" for letter in letters)
        point = lambda: f"X{number(-9, 9)} Y{number(-9, 9)} P{number(0.5, 2)}"
        cubic = f"{words('IJ')} P-{plain(1, 9)} {words('Q')}"
        points = [point() for _ in range(rng.randint(3, 6))]
        return rng.choice((
            f"G91 G5.1 {words('IJ')} X{number(1, 9)} Y-{plain(1, 9)}\nG90",
            f"G91 G5 {cubic} {words('XY')}\nG5 P-{plain(1, 5)} Q{number(-3, 3)} {words('XY')}\nG90",
            f"G5 {words('IJ')} {words('PQ')} {words('X')}",
            f"G5.2 P{number(0.5, 2)} L{rng.randint(3, len(points))}\n" + "\n".join(points) +
            "\nG5.3")) + f"\nG1 Z{number(-9, 9)}"

    for _ in range(rng.randint(3, 25)):
        kind = rng.choice((0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 8, 9) + ((10,) if plane == 17 else ()))
        lines.append((lambda: f"G0 {some_axes()}", lambda: f"G1 {some_axes()} F{number(50, 500)}",
                      arc, full_circle, cycle, offset, modal,
                      lambda: f"G4 P{number(0, 3)}", flow, feed_mode, spline)[kind]())
    return "\n".join(lines + ["M2", ""])


def wrapped_program(rng):
    """Words of wrapped axes, among steps, offsets and G53."""
    word = lambda: f"{rng.choice('ABC')}{rng.choice(('', '-'))}{rng.uniform(0, 359.9):.3f}"
    lines = ["G21 G90"]
    for _ in range(rng.randint(3, 25)):
        lines.append(rng.choice((
            lambda: f"G0 {word()}", lambda: f"G0 {word()}", lambda: f"G53 G0 {word()}",
            lambda: f"G91 G0 {word()}\nG90", lambda: f"G10 L2 P1 {word()}", lambda: f"G92 {word()}",
            lambda: f"G28 {word()}", lambda: "G0 A0 B-0"))())
    return "\n".join(lines + ["M2", ""])


def tip_program(rng):
    """Lines under tool centre point control: its interpreter has the same targets with and without,
    for kinematics are the controller's."""
    number = lambda low, high: f"{rng.uniform(low, high):.3f}"
    some_axes = lambda: " ".join(f"{letter}{number(-20, 20)}"
                                 for letter in rng.sample("XYZAC", rng.randint(1, 3)))
    lines = [f"G{rng.choice((20, 21))} G90 G94 F{number(50, 500)}", "M428", "G0 X0 Y0 Z20 A-9"]
    for _ in range(rng.randint(3, 25)):
        lines.append(rng.choice((
            lambda: f"G0 {some_axes()}", lambda: f"G1 {some_axes()}",
            lambda: f"G43 H{rng.choice((1, 2))}", lambda: "G49",
            lambda: f"G43 H{rng.choice((1, 2))} G0 {some_axes()}",
            lambda: f"G91 G1 {some_axes()}\nG90", lambda: f"G92 {some_axes()}",
            lambda: f"G10 L20 P{rng.randint(1, 9)} {some_axes()}", lambda: "G0 X#5421 Z#5420",
            lambda: "G4 P0.5"))())
    return "\n".join(lines + ["M2", ""])


def rounded_arc(rng):
    """One arc whose centre and end are rounded: whether it closes is the question."""
    is_inch, digits = rng.random() < 0.5, rng.choice((2, 2, 3))
    radius, turned = 10 ** rng.uniform(-1.5, 4), [rng.uniform(0, 6.3) for _ in range(2)]
    off = radius * 10 ** rng.uniform(-5, -2)
    start, end = [[size * math.cos(angle), size * math.sin(angle)]
                  for size, angle in zip((radius, radius + off), turned)]
    words = [round(v, digits) for v in (*start, *end)]
    x, y = words[:2]
    return (f"G{20 if is_inch else 21} G90 F9\nG0 X{x} Y{y}\nG{rng.choice((2, 3))} X{words[2]} "
            f"Y{words[3]} I{-x} J{-y}\nM2\n")


class PmCircle(ctypes.Structure):
    """posemath.h of LinuxCNC: centre, normal, three vectors, then these."""
    _fields_ = [("vectors", ctypes.c_double * 15), ("radius", ctypes.c_double),
                ("angle", ctypes.c_double), ("spiral", ctypes.c_double)]


def sweep_of_linuxcnc(posemath, start, end, centre, is_clockwise):
    """The angle that its motion controller gives an arc of one turn at most."""
    points = [(ctypes.c_double * 3)(*point, 0.0) for point in (start, end, centre)]
    circle, normal = PmCircle(), (ctypes.c_double * 3)(0, 0, 1)
    posemath.pmCircleInit(ctypes.byref(circle), *(ctypes.byref(point) for point in points),
                          ctypes.byref(normal), -1 if is_clockwise else 0)
    return circle.angle


def compare_turns(print_moves, program, rng, count):
    """Arcs with ends from 1e-12 to 1 mm apart: a turn where its motion controller makes one, or a
    refusal where an inch machine would have another answer. Returns the faults."""
    try:
        posemath = ctypes.CDLL("libposemath.so.0")
    except OSError:
        print("skipped: the turns (no libposemath.so.0)")
        return []
    faults, refused = [], 0
    for _ in range(count):
        radius, from_rad = 10 ** rng.uniform(-1, 2), rng.uniform(0, 6.3)
        start = [round(rng.uniform(-100, 100), 3) for _ in range(2)]
        to_centre = [round(-radius * math.cos(from_rad), 4), round(-radius * math.sin(from_rad), 4)]
        centre = [a + b for a, b in zip(start, to_centre)]
        way = 10 ** rng.uniform(-12, 0) * rng.choice((1, -1)) / math.hypot(*to_centre)
        out = [-v for v in to_centre]
        end = [round(centre[0] + out[0] * math.cos(way) - out[1] * math.sin(way), 13),
               round(centre[1] + out[0] * math.sin(way) + out[1] * math.cos(way), 13)]
        is_clockwise = rng.random() < 0.5
        text = (f"G21 G90 G0 X{start[0]:.3f} Y{start[1]:.3f}\nG{2 if is_clockwise else 3} "
                f"X{end[0]:.13f} Y{end[1]:.13f} I{to_centre[0]:.4f} J{to_centre[1]:.4f} F9\nM2\n")
        pathlib.Path(program).write_text(text, encoding="ascii")
        done = subprocess.run([print_moves, program], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, check=False)
        theirs = sweep_of_linuxcnc(posemath, start, end, centre, is_clockwise)
        apart = math.hypot(end[0] - start[0], end[1] - start[1])
        if done.returncode != 0:
            refused += 1
            is_right = 0.9e-8 < apart < 1.1e-6
        else:
            ours = abs(float(done.stdout.split()[-1]))
            is_right = (ours > 6) == (theirs > 6) if apart < 1e-4 else abs(ours - theirs) < 1e-4
        if not is_right:
            faults.append(f"arc with ends {apart:.3g} mm apart: LinuxCNC {theirs}, ours "
                          f"{done.stdout or done.stderr}\n{text}")
    print(f"{count} arcs with near ends, {refused} refused, {len(faults)} unlike LinuxCNC's")
    return faults


def reached_arcs(rng, count, is_tip):
    """Full and nearly full arcs from starts that the program reaches in many ways, and the angle
    that each has by its words. Under tool centre point control LinuxCNC has the same targets."""
    is_inch, lines, sweeps = rng.random() < 0.3, [], []
    lines.append(f"G{20 if is_inch else 21} G90 G94 F100")
    if is_tip:
        lines.append("M428")
    for _ in range(count):
        plane = 17 if is_tip else rng.choice((17, 18, 19))
        first, second, i, j = {17: "XYIJ", 18: "ZXKI", 19: "YZJK"}[plane]
        start = [rng.randint(-200000, 200000) for _ in range(2)]  # in 1e-4 of the unit
        words = lambda at: f"{first}{at[0] / 1e4:.4f} {second}{at[1] / 1e4:.4f}"
        part = [rng.randint(-90000, 90000) for _ in range(2)]
        rest = [a - b for a, b in zip(start, part)]
        way = rng.choice(("absolute", "steps", "machine", "G92", "G10"))
        lines += {
            "absolute": lambda: [f"G0 {words(start)}"],
            "steps": lambda: [f"G0 {first}0 {second}0", f"G91 G0 {words(part)}",
                              f"G0 {words(rest)}", "G90"],
            "machine": lambda: [f"G53 G0 {words(start)}"],
            "G92": lambda: [f"G0 {words(part)}", f"G92 {words(rest)}", f"G0 {words(start)}"],
            "G10": lambda: [f"G0 {words(part)}", f"G10 L20 P1 {words(start)}"],
        }[way]()
        radius, at_rad = rng.uniform(1e4, 3e5), rng.uniform(0, 6.3)
        off = [round(radius * math.cos(at_rad)), round(radius * math.sin(at_rad))]
        centre = [a + b for a, b in zip(start, off)]
        turned = rng.choice((0, 0, 1, -1)) * 10 ** rng.uniform(0, 3.7) / radius
        out = [-v for v in off]
        end = [round(centre[0] + out[0] * math.cos(turned) - out[1] * math.sin(turned)),
               round(centre[1] + out[0] * math.sin(turned) + out[1] * math.cos(turned))]
        to = [a - b for a, b in zip(end, centre)]
        sweep = math.atan2(out[0] * to[1] - out[1] * to[0], out[0] * to[0] + out[1] * to[1])
        is_clockwise = rng.random() < 0.5
        sweep += (-2 * math.pi if sweep >= 0 else 0) if is_clockwise else (
            2 * math.pi if sweep <= 0 else 0)
        sweeps.append(sweep)
        is_bare = end == start and rng.random() < 0.5
        lines.append(f"G{plane} G{2 if is_clockwise else 3} {'' if is_bare else words(end)} "
                     f"{i}{off[0] / 1e4:.4f} {j}{off[1] / 1e4:.4f}")
        lines.append("G92.1 G0 X0" if way != "G10" else "G10 L2 P1 X0 Y0 Z0")
    return "\n".join(lines + ["M2", ""]), sweeps


def compare_reached(print_moves, program, rng, count):
    """The faults of `count` arcs, a hundred a program."""
    faults, size = [], min(count, 100)
    for number in range(-(-count // size)):
        is_tip = number % 6 == 5
        text, sweeps = reached_arcs(rng, size, is_tip)
        pathlib.Path(program).write_text(text, encoding="ascii")
        options = ["--tip"] if is_tip else []
        ours, why = of_axguard(print_moves, program, *options)
        done = subprocess.run([print_moves, *options, program], stdout=subprocess.PIPE,
                              stderr=subprocess.DEVNULL, text=True, check=False)
        angles = [float(line.split()[-1]) for line in done.stdout.splitlines()
                  if line.startswith("arc")]
        pathlib.Path(program).write_text(LEFT_OUT.sub("", text), encoding="ascii")
        theirs = of_linuxcnc(program)
        if ours is None or theirs is None:
            faults.append(f"arcs {number}: {why.splitlines()[:1] or 'they refuse them'}")
        elif difference(ours, theirs):
            faults.append(f"arcs {number}: {difference(ours, theirs)}")
        faults += [f"arcs {number}: {ours_rad} rad, by the words {words_rad}"
                   for ours_rad, words_rad in zip(angles, sweeps)
                   if abs(ours_rad - words_rad) > 1e-6]
    print(f"{count} full and nearly full arcs, {len(faults)} unlike LinuxCNC's")
    return faults


def main():
    print_moves, gcode = sys.argv[1], pathlib.Path(sys.argv[2])
    if shutil.which("rs274") is None:
        print("skipped: no rs274 (Debian: linuxcnc-uspace; ./setup.sh --all installs it)")
        return SKIPPED
    seed, count = int(os.environ.get("AXG_SEED", "274")), int(os.environ.get("AXG_COUNT", "400"))
    print(f"seed {seed} (AXG_SEED overrides it), {count} random programs")
    rng = random.Random(seed)
    faults, accepted, motions, splines = [], 0, 0, 0
    with tempfile.TemporaryDirectory() as folder:
        program = os.path.join(folder, "program.ngc")
        pathlib.Path(folder, TOOLS).write_text(
            "".join(f"T{n} P{n} Z0\n" for n in TOOL_NUMBERS), encoding="ascii")

        def compare(name):
            nonlocal accepted, motions, splines
            theirs = of_linuxcnc(program)
            ours, why = of_axguard(print_moves, program)
            if theirs is None or ours is None:
                return theirs, ours, why
            accepted += 1
            motions += len(theirs)
            splines += sum(kind == "spline" for kind, _ in theirs)
            found = difference(ours, theirs)
            if found:
                faults.append(f"{name}: {found}")
            return theirs, ours, why

        def compare_each(kind, make, *options):
            """The motions of random programs that both have to read, up to the first fault."""
            motions_of_kind = 0
            for i in range(count):
                text = make(rng)
                pathlib.Path(program).write_text(text, encoding="ascii")
                ours, why = of_axguard(print_moves, program, "--" + kind)
                pathlib.Path(program).write_text(LEFT_OUT.sub("", text), encoding="ascii")
                theirs = of_linuxcnc(program, *options)
                if kind == "wrapped" and "rounding would decide" in why and theirs is not None:
                    continue  # its sums differ from these by rounding: a turn or none
                found = why or ("they refuse it" if theirs is None else difference(ours, theirs))
                motions_of_kind += len(ours or ())
                if found:
                    faults.append(f"{kind} program {i}: {found}")
                    print(text)
                    break
            return motions_of_kind

        for i in range(2 * count):
            text = random_program(rng) if i < count else rounded_arc(rng)
            pathlib.Path(program).write_text(text, encoding="ascii")
            theirs, ours, why = compare(f"random program {i}")
            if (theirs is None) != (ours is None):
                faults.append(f"random program {i}: {'they' if theirs is None else 'we'} refuse it "
                              f"{why.splitlines()[:1]}")
            if faults:
                print(text)
                break
        random_accepted = accepted
        faults += compare_turns(print_moves, program, rng, count)
        faults += compare_reached(print_moves, program, rng, count)
        pathlib.Path(folder, "wrapped.ini").write_text(
            "[EMC]\nVERSION=1.1\n[RS274NGC]\nPARAMETER_FILE = none.var\n" +
            "".join(f"[AXIS_{letter}]\nWRAPPED_ROTARY = 1\n" for letter in "ABC"),
            encoding="ascii")
        wrapped_motions = compare_each("wrapped", wrapped_program, "-i", "wrapped.ini")
        pathlib.Path(folder, TOOLS).write_text(
            "".join(f"T{n} P{n} Z{z / INCH:.9f}\n" for n, z in TIP_TOOLS.items()), encoding="ascii")
        tip_motions = compare_each("tip", tip_program)
        pathlib.Path(folder, TOOLS).write_text(
            "".join(f"T{n} P{n} Z0\n" for n in TOOL_NUMBERS), encoding="ascii")
        for path in sorted(gcode.glob("*.ngc")):
            text = LEFT_OUT.sub("", path.read_text(encoding="latin-1"))
            pathlib.Path(program).write_text(text, encoding="latin-1")
            theirs, ours, why = compare(path.name)
            print(f"{path.name}: {'refused by LinuxCNC' if theirs is None else len(theirs)} "
                  f"{why.splitlines()[0].split(': ', 1)[1] if why else ''}")
    for fault in faults[:10]:
        print(fault)
    print(f"{random_accepted} random programs and {accepted - random_accepted} real ones accepted "
          f"by both, {motions} motions, {splines} of them splines; {tip_motions} motions under "
          f"tool centre point control; {wrapped_motions} with wrapped axes; {len(faults)} faults")
    return 1 if faults or random_accepted < count / 4 or splines < count / 4 else 0


if __name__ == "__main__":
    sys.exit(main())
