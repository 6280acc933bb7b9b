#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A trace as Vector's BLF, and as MF4 where this python-can writes it, becomes a trace that axguard
reads by the command of docs/guide/every-day.md: the same frames at the same times.

trace_converter_test.py AXGUARD ROOT"""
import os
import pathlib
import subprocess
import sys
import tempfile

SKIPPED = 77
SYSTEM_PYTHON = "/usr/bin/python3"
try:
    import can
except ImportError:
    # Debian's module belongs to Debian's interpreter; another one may come first on the path.
    if sys.executable != SYSTEM_PYTHON and os.path.exists(SYSTEM_PYTHON):
        os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, "-B", *sys.argv])
    can = None
try:
    import asammdf
except ImportError:
    asammdf = None


def run(*words):
    done = subprocess.run(words, text=True, capture_output=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: ended with {done.returncode}\n{done.stderr}")
    return done.stdout


def convert(source, target):
    """can_logconvert by its module: a folder of Python's has no programs."""
    run(sys.executable, "-m", "can.logconvert", source, target)


def frames_of(path):
    """Identifier, data, and time in us since the first, of each line of a candump log."""
    frames, first = [], None
    for line in path.read_text(encoding="ascii").splitlines():
        stamp, _, frame = line.split()[:3]
        time_us = round(float(stamp.strip("()")) * 1e6)
        first = time_us if first is None else first
        frames.append((time_us - first, frame))
    return frames


def check_format(folder, log, suffix, slack_us):
    convert(log, folder / f"trace.{suffix}")
    back = folder / f"back_{suffix}.log"
    convert(folder / f"trace.{suffix}", back)
    wanted, found = frames_of(log), frames_of(back)
    if [frame for _, frame in wanted] != [frame for _, frame in found]:
        sys.exit(f"{suffix}: other frames: {wanted[:3]}, {found[:3]}, {len(wanted)}, {len(found)}")
    worst = max(abs(a - b) for (a, _), (b, _) in zip(wanted, found))
    if worst > slack_us:
        sys.exit(f"{suffix}: a stamp is off by {worst} us")
    print(f"ok: {suffix}: {len(found)} frames, stamps within {worst} us")
    return back


def main():
    if can is None:
        print("skipped: no python-can (Debian: python3-can)")
        sys.exit(SKIPPED)
    axguard, root = sys.argv[1], pathlib.Path(sys.argv[2])
    machine = root / "config/machines/paper-trunnion.yaml"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        program = folder / "jog.ngc"
        program.write_text("G21 G90 G94 F3000\nG1 X10\nG1 X0\nM2\n", encoding="ascii")
        log = folder / "trace.log"
        run(axguard, "simulate", machine, program, "-o", log)
        backs = [check_format(folder, log, "blf", 1)]
        if hasattr(can, "MF4Writer") and asammdf is not None:
            backs.append(check_format(folder, log, "mf4", 1))
        else:
            print("not tried: mf4 (python-can 4.2 with asammdf)")
        for back in backs:
            run(axguard, "replay", machine, back)


if __name__ == "__main__":
    os.environ["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    main()
