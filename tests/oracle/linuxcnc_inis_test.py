#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`axguard init` on every sample configuration of LinuxCNC: a machine file that loads, or a message
with place and remedy. Speeds are compared with what LinuxCNC's own reader, inivar, says: the same,
or with kinematics for the tip twice that.

    linuxcnc_inis_test.py AXGUARD
"""
import collections
import math
import pathlib
import re
import shutil
import struct
import subprocess
import sys
import tempfile

SKIPPED = 77
SAMPLES = pathlib.Path("/usr/share/doc/linuxcnc/examples/sample-configs")
PLACE = re.compile(r"^\S.*?(:\d+: |: \[TRAJ\] \w+: missing required key)")
SPEED = re.compile(r"^  #? ?([A-Z]): \{.*speed_(?:mm_min|deg_s): ([-0-9.e+]+).*GUESS: (.*)$", re.M)


def write_cube(path, low, high):
    corner = [[x, y, z] for x in (low, high) for y in (low, high) for z in (low, high)]
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
             (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    with open(path, "wb") as out:
        out.write(bytes(80) + struct.pack("<I", len(faces)))
        for face in faces:
            out.write(struct.pack("<3f", 0, 0, 0))
            for i in face:
                out.write(struct.pack("<3f", *corner[i]))
            out.write(bytes(2))


def said(ini, section, key):
    done = subprocess.run(["inivar", "-ini", ini, "-sec", section, "-var", key],
                          capture_output=True, text=True, check=False)
    word = done.stdout.split()
    return word[0] if done.returncode == 0 and word else None


def compare_x(ini, text):
    """X is joint 0 with every kinematics that is read here; 1: compared, 0: not stated."""
    found = {letter: (float(speed), guesses) for letter, speed, guesses in SPEED.findall(text)}
    follows_tip = said(ini, "KINS", "KINEMATICS") not in (None, "trivkins")
    stated = [float(word) * (2 if follows_tip else 1)
              for word in (said(ini, s, "MAX_VELOCITY") for s in ("AXIS_X", "JOINT_0")) if word]
    if "X" not in found or not stated or "speed" in found["X"][1].split(", "):
        return 0
    inches = re.search(r"(?im)^\s*LINEAR_UNITS\s*=\s*in", pathlib.Path(ini).read_text("latin-1"))
    wanted = min(stated) * 60 * (25.4 if inches else 1)
    assert math.isclose(found["X"][0], wanted, rel_tol=1e-8), (ini, found["X"], wanted)
    return 1


def main():
    axguard = sys.argv[1]
    inis = sorted(SAMPLES.rglob("*.ini"))
    if not inis or not shutil.which("inivar"):
        print("skipped: LinuxCNC's sample configurations are not installed (./setup.sh --all)")
        return SKIPPED
    counts = collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        meshes = pathlib.Path(folder) / "meshes"
        meshes.mkdir()
        write_cube(meshes / "x.stl", 0, 10)
        write_cube(meshes / "bed.stl", -30, -20)
        for ini in inis:
            out = pathlib.Path(folder) / "m.yaml"
            out.unlink(missing_ok=True)
            done = subprocess.run([axguard, "init", ini, "--meshes", meshes, "--unit", "mm", "-o",
                                   out], capture_output=True, text=True, check=False)
            if done.returncode == 0:
                counts["read"] += 1
                counts["speeds compared"] += compare_x(ini, out.read_text())
                continue
            counts["refused"] += 1
            assert done.returncode == 3 and not out.exists(), (ini, done)
            for line in done.stderr.splitlines():
                assert PLACE.match(line) and "expected " in line, (ini, line)
            if "KINEMATICS" in done.stderr:
                counts["refused for their kinematics"] += 1
    print(f"{len(inis)} INI files: " + ", ".join(f"{n} {what}" for what, n in counts.items()))
    assert counts["read"] >= 0.9 * len(inis) and counts["speeds compared"] > 100
    return 0


if __name__ == "__main__":
    sys.exit(main())
