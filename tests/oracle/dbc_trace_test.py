#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A trace whose frames cantools encoded, under identifiers of 29 bits and of 11, is what the
guard's programs read: every sample, and each axis where it was sent.

usage: dbc_trace_test.py AXGUARD SOURCE     skipped without cantools
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile

from dbc_oracle import SKIPPED, cantools_if_there

SAMPLES = 300
# 0x181 of 11 bits, of 29 bits, and a number that only 29 bits have.
DBC = """VERSION ""
BU_: Board Guard
BO_ 385 Status: 2 Board
 SG_ State : 0|8@1+ (1,0) [0|0] "" Guard
 SG_ Tool : 8|8@1+ (1,0) [0|0] "" Guard
BO_ 2147484033 Linear: 8 Board
 SG_ X : 0|24@1- (0.001,0) [0|0] "mm" Guard
 SG_ Y : 31|24@0- (0.001,0) [0|0] "mm" Guard
BO_ 2566848897 Rest: 12 Board
 SG_ Z : 0|32@1- (1,0) [0|0] "um" Guard
 SG_ A : 32|32@1- (0.0001,0) [0|0] "deg" Guard
 SG_ C : 64|32@1+ (0.0001,0) [0|0] "deg" Guard
"""
CAN = """can:
  format: dbc
  file: board.dbc
  axes: {X: Linear.X, Y: Linear.Y, Z: Rest.Z, A: Rest.A, C: Rest.C}
  status: {tool: Status.Tool, moving: Status.State}
"""


def position(number):
    """In mm and degrees, on the counts of the file."""
    turn = 2 * math.pi * number / SAMPLES
    return {"X": round(20 * math.sin(turn), 3), "Y": round(-15 + 5 * math.cos(turn), 3),
            "Z": round(30 + 10 * math.sin(turn), 3), "A": round(-10 + 5 * math.sin(turn), 4),
            "C": round(90 + 45 * math.cos(turn), 4)}


def trace(database, path, all_standard):
    """Each sample's three frames as candump writes them; `all_standard`: 3 digits where the number
    permits it, which is another identifier."""
    with open(path, "w", encoding="ascii") as out:
        for number in range(SAMPLES):
            axes = position(number)
            values = {"Status": {"State": 1, "Tool": 1},
                      "Linear": {axis: axes[axis] for axis in "XY"},
                      "Rest": {"Z": 1000 * axes["Z"], "A": axes["A"], "C": axes["C"]}}
            for index, (name, signals) in enumerate(values.items()):
                message = database.get_message_by_name(name)
                is_wide = message.is_extended_frame and not (all_standard and
                                                             message.frame_id < 0x800)
                data = message.encode(signals)
                out.write(f"({1000 + number * 1e-3 + index * 1e-4:.6f}) can0 "
                          f"{message.frame_id:0{8 if is_wide else 3}X}"
                          f"{'##1' if len(data) > 8 else '#'}{data.hex().upper()}\n")


def seen(axguard, machine, path):
    done = subprocess.run([axguard, "inspect", path, "--machine", machine, "--json"],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise SystemExit(done.stdout + done.stderr)
    return json.loads(done.stdout)["machine"]


def faults_of(sent):
    faults = []
    if sent["snapshots"] != SAMPLES or sent["samples_lost"] or sent["receiver_faults"]:
        faults.append(f"{sent['snapshots']} of {SAMPLES} samples: {sent['receiver_faults']}")
    for axis in sent["axes"]:
        values = [position(number)[axis["name"]] for number in range(SAMPLES)]
        for key, wanted in (("least", min(values)), ("most", max(values)), ("last", values[-1])):
            if abs(axis[key] - wanted) > 1e-6:
                faults.append(f"{axis['name']} {key}: read {axis[key]}, sent {wanted}")
    return faults


def main():
    cantools = cantools_if_there()
    if cantools is None:
        return SKIPPED
    axguard, source = sys.argv[1], pathlib.Path(sys.argv[2])
    machines = source / "config/machines"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        text = (machines / "paper-trunnion.yaml").read_text(encoding="utf-8")
        lines = text[:text.index("\ncan:") + 1].splitlines(keepends=True)
        (folder / "m.yaml").write_text(
            "".join(line for line in lines if "single_jog" not in line) + CAN, encoding="utf-8")
        (folder / "board.dbc").write_text(DBC, encoding="ascii")
        database = cantools.database.load_string(DBC, "dbc")
        trace(database, folder / "sent.log", False)
        trace(database, folder / "other.log", True)
        sent = seen(axguard, folder / "m.yaml", folder / "sent.log")
        other = seen(axguard, folder / "m.yaml", folder / "other.log")
    faults = faults_of(sent)
    if other["snapshots"] != 0:
        faults.append(f"{other['snapshots']} samples of frames under other identifiers")
    print("\n".join(faults) if faults else f"{sent['snapshots']} samples, 5 axes agree")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
