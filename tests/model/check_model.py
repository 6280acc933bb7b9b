#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The guard's state machine: the table that the model and docs/reference/states.md show is that of
the program; the model makes of every state and event what the program makes of it; the eight
properties hold in every state of the model, and a mistake is found by each of them."""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

SKIPPED = 77
MODEL = pathlib.Path(__file__).resolve().parent
PROPERTIES = range(1, 9)
# What is broken, and the property that must find it: the defines of guard.pml.
MISTAKES = [
    ("LATE_COUNTS", 1), ("OLD_COUNTS", 1), ("TIMER_PERMITS", 1), ("OWN_STOP_STAYS", 1),
    ("FAULT_STAYS", 2), ("TX_FAIL_STAYS", 2),
    ("FAULTY_RESET", 3), ("RESET_ARMS", 3), ("ARM_RESETS", 3),
    ("RESTART_UNLATCHES", 4), ("KILL_STAYS", 4),
    ("TX_FAIL_UNLATCHES", 5), ("STOP_ONCE", 5), ("CONFIRMED_FOR_EVER", 5),
    ("ONE_SNAPSHOT", 6), ("NO_SELFTEST", 6),
    ("NEVER_READY", 7),
    ("DISTURBED_IS_GOOD", 8), ("MISSED_IS_NOTHING", 8),
]


def run(command, folder=None):
    done = subprocess.run([str(part) for part in command], cwd=folder, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}: ended with {done.returncode}\n{done.stdout}")
    return done.stdout


def verify(defines, compiler_options=()):
    """What the verifier of the model prints, and the seconds that it took."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for path in MODEL.glob("*.pml"):
            shutil.copy(path, folder)
        run(["spin", *(f"-D{define}" for define in defines), "-a", "guard.pml"], folder)
        run(["gcc", "-O1", "-w", "-DSAFETY", "-DNOREDUCE", *compiler_options, "-o", "pan", "pan.c"],
            folder)
        start = time.monotonic()
        return run(["./pan", "-m2000000", "-w22"], folder), time.monotonic() - start


def count(output, what):
    match = re.search(rf"(\d+) {what}", output)
    return int(match.group(1)) if match else 0


def is_complete(output):
    """Every state was seen. A search that ran out of depth or memory says nothing."""
    return ("errors: 0" in output and "Search not completed" not in output
            and "max search depth too small" not in output and count(output, "states, stored") > 0)


def fault_found(output):
    """The property whose assertion was violated, or None."""
    match = re.search(r"assertion violated \(?\(?p(\d)", output)
    return int(match.group(1)) if match else None


def check_table(program, docs):
    faults = []
    if run([program, "promela"]) != (MODEL / "guard_table.pml").read_text(encoding="utf-8"):
        faults.append("tests/model/guard_table.pml is not the table of the program; write it again:"
                      " axg_guard_table promela > tests/model/guard_table.pml")
    if run([program, "markdown"]) not in docs.read_text(encoding="utf-8"):
        faults.append(f"{docs.name} does not show the table of the program; put the output of"
                      " 'axg_guard_table markdown' there")
    return faults


def check_relation(program):
    ours = set(run([program, "relation"]).splitlines())
    output, _ = verify(["RELATION"], ["-DPRINTF"])
    model = {line.strip() for line in output.splitlines() if line.strip().startswith("STEP ")}
    print(f"{count(output, 'states, stored')} states, {len(model)} steps of the model, "
          f"{len(ours)} of the program")
    if not is_complete(output):
        return ["the search was not completed:\n" + output[-2000:]]
    differing = sorted(ours ^ model)
    return [f"{len(differing)} steps differ, the first in the "
            f"{'program' if differing[0] in ours else 'model'} alone: {differing[0]}"] \
        if differing or not ours else []


def check_properties():
    faults = []
    output, seconds = verify([])
    print(f"the guard as it is: {count(output, 'states, stored')} states, "
          f"{count(output, 'transitions')} transitions, {count(output, 'atomic steps')} steps, "
          f"{seconds:.1f} s; {', '.join(re.findall('depth reached [0-9]+', output))}")
    if not is_complete(output):
        faults.append(f"property {fault_found(output)} does not hold, or the search was not "
                      f"completed:\n{output[-2000:]}")
    for mistake, wanted in MISTAKES:
        output, seconds = verify([f"BREAK={mistake}", f"ONLY={wanted}"])
        found = fault_found(output)
        print(f"{mistake}: property {found} found it after "
              f"{count(output, 'states, stored')} states, {seconds:.1f} s")
        if found != wanted:
            faults.append(f"{mistake}: wanted property {wanted} to find it, got {found}:\n"
                          f"{output[-1000:]}")
    if {wanted for _, wanted in MISTAKES} != set(PROPERTIES):
        faults.append("a property has no mistake that it must find")
    return faults


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=["table", "relation", "properties"])
    parser.add_argument("program", type=pathlib.Path, help="axg_guard_table")
    parser.add_argument("docs", type=pathlib.Path, help="docs/reference/states.md")
    options = parser.parse_args()
    needed = [] if options.what == "table" else ["spin", "gcc"]
    missing = [tool for tool in needed if shutil.which(tool) is None]
    if missing:
        print(f"skipped: {' and '.join(missing)} not found (./setup.sh --all installs it)")
        return SKIPPED
    os.environ["LC_ALL"] = "C"
    if options.what == "table":
        faults = check_table(options.program, options.docs)
    elif options.what == "relation":
        faults = check_relation(options.program)
    else:
        faults = check_properties()
    for fault in faults:
        print(fault)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
