#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The path of G5, G5.1 and G5.2 to G5.3: a LinuxCNC moves along them in exact path mode, and every
position of its joints is on the moves that this reader makes of the same program, all of which it
passes. Without a display and without real time.

spline_test.py PRINT_MOVES
"""
import fcntl
import json
import math
import os
import pathlib
import pty
import pwd
import shutil
import subprocess
import sys
import tempfile

from place import LOCK, read_all

SKIPPED = 77
LIMIT_S = 150
# LinuxCNC smooths the positions of three periods, 0.02 mm apart at this feed: v^2 t^2 / 6 r. Found:
# 4e-5 of 33,300 positions.
NEAR_MM = 1e-4
STEP_MM = 0.02  # at most between two positions, and so from each end of a move to one
PROGRAM = """G21 G90 G17 G61 F600
G0 X0 Y0
G5 I0 J30 P0 Q-30 X10 Y10
G5 P-4 Q-25 X25 Y0
G91 G5.1 I8 J-20 X15 Y3
G90 G5.2 P1.5 L3
X50 Y10 P2
X60 Y-10 P0.7
X70 Y5 P1
X60 Y30 P3
G5.3
G5.2 X40 Y40 P1 L4
X30 Y-10 P0.5
X20 Y30 P2
X5 Y20 P1
X0 Y40 P1
G5.3
G10 L2 P1 X7 Y-5 R35
G0 X0 Y0
G5 I5 J12 P-20 Q1 X30 Y-10
G20
F24
G92 X0 Y0
G5.1 I0.4 J0.5 X1 Y-0.2
G61 M2
"""
HAL = """loadrt trivkins coordinates=XYZ
loadrt motmod servo_period_nsec=1000000 num_joints=3
loadrt sampler depth=16000 cfg=fff
addf motion-command-handler servo-thread
addf motion-controller servo-thread
net x joint.0.motor-pos-cmd => joint.0.motor-pos-fb sampler.0.pin.0
net y joint.1.motor-pos-cmd => joint.1.motor-pos-fb sampler.0.pin.1
net z joint.2.motor-pos-cmd => joint.2.motor-pos-fb sampler.0.pin.2
addf sampler.0 servo-thread
net estop iocontrol.0.user-enable-out iocontrol.0.emc-enable-in
net prepare iocontrol.0.tool-prepare iocontrol.0.tool-prepared
net change iocontrol.0.tool-change iocontrol.0.tool-changed
loadusr halsampler -t FOLDER/samples.txt
"""
INI = """[EMC]
VERSION = 1.1
MACHINE = splines
[DISPLAY]
DISPLAY = FOLDER/display.py
[RS274NGC]
PARAMETER_FILE = FOLDER/parameters.var
[KINS]
KINEMATICS = trivkins coordinates=XYZ
JOINTS = 3
[HAL]
HALFILE = FOLDER/splines.hal
[TRAJ]
COORDINATES = XYZ
LINEAR_UNITS = mm
ANGULAR_UNITS = deg
DEFAULT_LINEAR_VELOCITY = 25
MAX_LINEAR_VELOCITY = 50
[EMCMOT]
EMCMOT = motmod
SERVO_PERIOD = 1000000
COMM_TIMEOUT = 1
[TASK]
TASK = milltask
CYCLE_TIME = 0.005
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.05
TOOL_TABLE = FOLDER/tools.tbl
"""
AXIS = """[AXIS_LETTER]
MIN_LIMIT = -500
MAX_LIMIT = 500
MAX_VELOCITY = 50
MAX_ACCELERATION = 2000
[JOINT_NUMBER]
TYPE = LINEAR
HOME = 0
MIN_LIMIT = -500
MAX_LIMIT = 500
MAX_VELOCITY = 50
MAX_ACCELERATION = 2000
FERROR = 50
MIN_FERROR = 10
HOME_SEARCH_VEL = 0
HOME_LATCH_VEL = 0
HOME_SEQUENCE = 0
"""
DISPLAY = """#!/usr/bin/python3
import json
import time
import linuxcnc
command, stat, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
said = {"errors": [], "ended": ""}


def until(condition, seconds):
    end = time.time() + seconds
    while time.time() < end:
        stat.poll()
        while error := errors.poll():
            said["errors"].append(error[1])
        if condition():
            return True
        time.sleep(0.05)
    return False


for state in (linuxcnc.STATE_ESTOP_RESET, linuxcnc.STATE_ON):
    command.state(state)
    command.wait_complete()
command.mode(linuxcnc.MODE_MANUAL)
command.wait_complete()
command.teleop_enable(0)
command.wait_complete()
for joint in range(3):
    command.home(joint)
said["homed"] = until(lambda: all(stat.homed[:3]), 10)
command.mode(linuxcnc.MODE_AUTO)
command.wait_complete()
command.program_open("FOLDER/program.ngc")
command.wait_complete()
command.auto(linuxcnc.AUTO_RUN, 0)
time.sleep(0.5)
if until(lambda: stat.interp_state == linuxcnc.INTERP_IDLE and stat.inpos, LIMIT):
    said["ended"] = "done"
time.sleep(0.5)
with open("FOLDER/result.json", "w", encoding="utf-8") as out:
    json.dump(said, out)
"""


def prepare(folder, user):
    def write(name, text):
        path = folder / name
        path.write_text(text.replace("FOLDER", str(folder)).replace("LIMIT", str(LIMIT_S - 50))
                        if name == "display.py" else text.replace("FOLDER", str(folder)),
                        encoding="ascii")
        return path

    write("program.ngc", PROGRAM)
    write("splines.hal", HAL)
    write("splines.ini", INI + "".join(
        AXIS.replace("LETTER", letter).replace("NUMBER", str(number))
        for number, letter in enumerate("XYZ")))
    write("tools.tbl", "T1 P1 Z0\n")
    write("display.py", DISPLAY).chmod(0o755)
    for path in (folder, *folder.iterdir()):
        os.chown(path, user.pw_uid, user.pw_gid)


def run(folder, user):
    """What the display program found, the positions of the joints, and what LinuxCNC printed."""
    def become():
        os.setsid()
        if os.geteuid() == 0:
            os.setgroups([])
            os.setgid(user.pw_gid)
            os.setuid(user.pw_uid)

    master, slave = pty.openpty()
    environment = dict(os.environ, HOME=str(folder), USER=user.pw_name, LOGNAME=user.pw_name,
                       PYTHONDONTWRITEBYTECODE="1")
    environment.pop("DISPLAY", None)
    process = subprocess.Popen(["linuxcnc", str(folder / "splines.ini")], cwd=folder,
                               env=environment, stdin=slave, stdout=slave, stderr=slave,
                               preexec_fn=become)
    os.close(slave)
    output = read_all(process, master, LIMIT_S)
    result = folder / "result.json"
    said = json.loads(result.read_text(encoding="utf-8")) if result.exists() else {}
    positions, lost = [], 0
    for line in (folder / "samples.txt").read_text(encoding="ascii").splitlines():
        words = line.split()
        lost += "overrun" in words
        if len(words) == 4:
            positions.append(tuple(float(word) for word in words[1:3]))
    return said, positions, lost, output


class Piece:
    """A line or an arc of the reader's, in X and Y."""

    def __init__(self, start, words):
        self.is_arc, self.start = words[0] == "arc", start
        values = [float(word) for word in words[1:]]
        self.end = tuple(values[:2])
        if self.is_arc:
            *self.centre, self.sweep = values[8:]
            self.radius = math.dist(start, self.centre)
            self.angle = self.angle_of(start)

    def angle_of(self, at):
        return math.atan2(at[1] - self.centre[1], at[0] - self.centre[0])

    def distance(self, at):
        if not self.is_arc:
            way = [b - a for a, b in zip(self.start, self.end)]
            square = sum(w * w for w in way)
            along = sum((p - a) * w for p, a, w in zip(at, self.start, way))
            share = min(1, max(0, along / square)) if square else 0
            return math.dist(at, [a + share * w for a, w in zip(self.start, way)])
        turned = (self.angle_of(at) - self.angle) % (2 * math.pi)
        turned = turned if self.sweep > 0 else turned - 2 * math.pi
        if abs(turned) <= abs(self.sweep):
            return abs(math.dist(at, self.centre) - self.radius)
        return min(math.dist(at, self.start), math.dist(at, self.end))


def pieces_of(print_moves, program):
    done = subprocess.run([print_moves, program], capture_output=True, text=True, check=True)
    pieces, at = [], (0.0, 0.0)
    for line in done.stdout.splitlines():
        words = line.split()
        if words[0] in ("arc", "feed", "rapid"):
            pieces.append(Piece(at, words))
            at = pieces[-1].end
    return pieces


def compare(positions, pieces):
    """How far the joints are off the pieces at most, and off the chords of arcs; both run along
    their path, so the piece of a position is that of the one before or one of the next."""
    worst, chords, at, left = 0.0, 0.0, 0, []
    chord_of = [Piece(piece.start, ("feed", *piece.end)) for piece in pieces]
    nearest = [math.inf] * len(pieces)
    for position in positions:
        found = min(range(at, min(at + 3, len(pieces))),
                    key=lambda i: (round(pieces[i].distance(position), 9), i))
        at = found
        worst = max(worst, pieces[at].distance(position))
        chords = max(chords, min(chord_of[i].distance(position)
                                 for i in range(max(0, at - 1), min(at + 2, len(pieces)))))
        for i in range(max(0, at - 2), min(at + 3, len(pieces))):
            nearest[i] = min(nearest[i], math.dist(position, pieces[i].end))
    left = [i for i, distance in enumerate(nearest) if distance > STEP_MM]
    return worst, chords, at, left


def main():
    if shutil.which("linuxcnc") is None:
        print("skipped: no linuxcnc (Debian: linuxcnc-uspace; ./setup.sh --all installs it)")
        return SKIPPED
    user = pwd.getpwnam("nobody") if os.geteuid() == 0 else pwd.getpwuid(os.geteuid())
    with open(LOCK, "w", encoding="ascii") as lock:  # one LinuxCNC a host: its keys are fixed
        fcntl.flock(lock, fcntl.LOCK_EX)
        with tempfile.TemporaryDirectory(prefix="axg-spline-", dir="/tmp") as name:
            folder = pathlib.Path(name)
            prepare(folder, user)
            said, positions, lost, output = run(folder, user)
            pieces = pieces_of(sys.argv[1], folder / "program.ngc")
    if said.get("ended") != "done" or said["errors"]:
        print(f"{output}\nFAILED: LinuxCNC did not run the program: {said}")
        return 1
    worst, chords, last, left = compare(positions, pieces)
    print(f"{len(positions)} positions, {lost} overruns, {len(pieces)} moves: {worst:.2e} mm off "
          f"at most; off the chords of the arcs {chords:.2e} mm")
    faults = [f"off the moves by {worst} mm"] if worst > NEAR_MM else []
    faults += [f"move {i} of {len(pieces)} was not passed" for i in left[:3]]
    faults += [f"ended in move {last} of {len(pieces)}"] if last != len(pieces) - 1 else []
    faults += [] if chords > 100 * NEAR_MM else ["lines in place of arcs would not be noticed"]
    faults += [f"{lost} overruns of the record"] if lost else []
    for fault in faults:
        print("FAILED:", fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
