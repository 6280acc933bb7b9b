#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""LinuxCNC's own programs: read with the motions of its interpreter, or refused with the line and
the word. Where a program has a file `expected` beside it (LinuxCNC's sources, tests/interp), that
is the judge, else rs274.

    linuxcnc_programs_test.py PRINT_MOVES [FOLDER]
"""
import collections
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

import rs274_test as rs274

SKIPPED = 77
FOLDERS = ("/usr/share/linuxcnc/ncfiles", "/usr/share/doc/linuxcnc/examples/nc_files")
SUFFIXES = (".ngc", ".nc", ".tap")
REFUSAL = re.compile(r"^.+:(\d+): (\S[^:]*): .")
LIMIT_S = 30


def expected_of(program):
    """What LinuxCNC's suite expects, where the folder is of one program."""
    beside = program.with_name(program.name + ".expected")
    if beside.exists():
        return beside.read_text(encoding="latin-1")
    single = [p for p in program.parent.iterdir() if p.suffix in SUFFIXES] == [program]
    whole = program.with_name("expected")
    return whole.read_text(encoding="latin-1") if single and whole.exists() else None


def said_by_rs274(program, folder):
    options = ["-i", "test.ini"] if program.with_name("test.ini").exists() else []
    tools = pathlib.Path(folder, rs274.TOOLS)  # without lengths, as those of PRINT_MOVES
    tools.write_text("".join(f"T{n} P{n} Z0 D{rs274.DIAMETER_MM / rs274.INCH:.9f}\n"
                             for n in rs274.TOOL_NUMBERS), encoding="ascii")
    options += ["-t", tools]
    try:
        done = subprocess.run(["rs274", *options, "-g", program.name], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, check=False,
                              cwd=program.parent, timeout=LIMIT_S)
    except subprocess.TimeoutExpired:
        return ""
    return done.stdout.decode("latin-1") if done.returncode == 0 else ""


def motions_of(text):
    """None: not a whole program. A probe touches something there, so motions end before it."""
    if "PROGRAM_END" not in text:
        return None, False
    probe = text.find("STRAIGHT_PROBE(")
    canon = rs274.Canon()
    for name, values in rs274.CALL.findall(text[:probe] if probe >= 0 else text):
        canon.take(name, values)
    return canon.motions, probe >= 0


def judge(print_moves, program, folder):
    """The class of this program, and why."""
    expected = expected_of(program)
    theirs, has_probe = motions_of(
        said_by_rs274(program, folder) if expected is None else expected)
    try:
        ours, why = rs274.of_axguard(print_moves, os.fspath(program))
    except subprocess.CalledProcessError as error:
        return "wrong", str(error)
    if ours is None:
        named = [line for line in why.splitlines() if REFUSAL.match(line)]
        first = named[0].split(": ", 1)[1] if named else why
        if not named:
            return "wrong", "refused without line and word: " + why
        return ("refused by both" if theirs is None else "refused here"), first
    if theirs is None:  # it refuses a program without M2, this reader says so in a note
        ended = pathlib.Path(folder, "ended.ngc")
        ended.write_bytes(program.read_bytes() + b"\nM2\n")
        theirs, has_probe = motions_of(said_by_rs274(ended, folder))
        if theirs is None:
            return "read here only", ""
    if has_probe:
        ours = rs274.without_rests(ours)[:len(rs274.without_rests(theirs))]
    found = rs274.difference(ours, theirs)
    return ("wrong", found) if found else ("equal", "")


def main():
    folders = sys.argv[2:] or FOLDERS
    programs = sorted({path.resolve() for folder in folders
                       for path in pathlib.Path(folder).rglob("*") if path.suffix in SUFFIXES})
    if not programs or shutil.which("rs274") is None:
        print("skipped: LinuxCNC's programs are not installed (./setup.sh --all)")
        return SKIPPED
    counts, reasons = collections.Counter(), collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        for program in programs:
            kind, why = judge(sys.argv[1], program, folder)
            counts[kind] += 1
            if kind in ("wrong", "read here only"):
                print(f"{kind}: {program}: {why}")
            elif kind == "refused here":
                reasons[why[:90]] += 1
    for why, count in reasons.most_common():
        print(f"refused here {count}: {why}")
    print(f"{len(programs)} programs: " + ", ".join(f"{n} {kind}" for kind, n in counts.items()))
    return 1 if counts["wrong"] or not counts["equal"] else 0


if __name__ == "__main__":
    sys.exit(main())
