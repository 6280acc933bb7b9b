# SPDX-License-Identifier: Apache-2.0
"""Boards whose X moves while their frames say that the machine stands: nothing arms the guard,
confirms its stop or resets it until X rests. For drives see quick_stop.py; a board behind a DBC
file has no SYNC counter, and axguardd run refuses it."""
import pathlib
import signal
import subprocess
import sys
import time

from vm_bus import (BUILD, PERMIT, SOURCE, STOP, Board, Bus, Guard, attempt, expect, machine_file,
                    reset_only_at_rest)

RUN = 0xA5  # word of a permit


def lying_trace(format_, motion, rest_s):
    trace = pathlib.Path("/run/lying.log")
    with open(trace, "w") as file:
        subprocess.run([BUILD / "tests/axg_lying_board", machine_file(format_),
                        SOURCE / "config/machines", motion, str(rest_s)], check=True, stdout=file)
    return trace


def begin(format_, motion, rest_s):
    """A guard, the bus, and a board that begins now."""
    trace = lying_trace(format_, motion, rest_s)
    guard = Guard(format_=format_)
    guard.wait_for("selftest")
    return guard, Bus(only=(PERMIT, STOP)), Board(trace), time.monotonic()


def never_armed_while_it_moves(format_, motion):
    guard, bus, board, started = begin(format_, motion, 0)
    while time.monotonic() < started + 2.5:
        guard.process.send_signal(signal.SIGUSR1)
        time.sleep(0.05)
    guard.check_busy()
    permits = [data for identifier, data in bus.drain() if identifier == PERMIT and data[0] == RUN]
    expect(not permits and not guard.said(" armed"), "armed while X moves", *guard.lines)
    guard.arm()
    guard.check_busy()
    expect(time.monotonic() > started + 3, "armed while X moves")
    board.end()
    guard.end()


def never_confirmed_while_it_moves(format_, motion):
    guard, bus, board, started = begin(format_, motion, 1.5)
    guard.arm()
    time.sleep(max(0.0, started + 1.7 - time.monotonic()))
    Bus().send(PERMIT, bytes(8))  # a reason to stop that passes
    guard.wait_for("stopped: ")
    stops = reset_only_at_rest(guard, bus, lambda: time.monotonic() < started + 4.5, started + 5.5)
    board.end()
    guard.end()
    print(f"{format_}, {motion}: {stops} stop frames in 0.5 s while X moved", flush=True)


for format_ in sys.argv[1:]:
    for motion in ("creep", "swing"):
        attempt(never_armed_while_it_moves, format_, motion)
        attempt(never_confirmed_while_it_moves, format_, motion)
