# SPDX-License-Identifier: Apache-2.0
"""Boards whose X moves while their frames say that the machine stands: nothing arms the guard,
confirms its stop or resets it until X rests. For drives see quick_stop.py; a board behind a DBC
file has no SYNC counter, and axguardd run refuses it."""
import pathlib
import signal
import subprocess
import sys
import time

from vm_bus import BUILD, PERMIT, SOURCE, STOP, Board, Bus, Guard, attempt, expect, machine_file

RUN = 0xA5  # word of a permit


def lying_trace(format_, motion, rest_s):
    trace = pathlib.Path("/run/lying.log")
    with open(trace, "w") as file:
        subprocess.run([BUILD / "tests/axg_lying_board", machine_file(format_),
                        SOURCE / "config/machines", motion, str(rest_s)], check=True, stdout=file)
    return trace


def never_armed_while_it_moves(format_, motion):
    trace = lying_trace(format_, motion, 0)
    guard = Guard(format_=format_)
    guard.wait_for("selftest")
    bus = Bus()
    board = Board(trace)
    started = time.monotonic()
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
    trace = lying_trace(format_, motion, 1.5)
    guard = Guard(format_=format_)
    guard.wait_for("selftest")
    bus = Bus()
    board = Board(trace)
    started = time.monotonic()
    guard.arm()
    time.sleep(max(0.0, started + 1.7 - time.monotonic()))
    Bus().send(PERMIT, bytes(8))  # a reason to stop that passes
    guard.wait_for("stopped: ")
    time.sleep(0.3)
    bus.drain()
    time.sleep(0.5)
    guard.process.send_signal(signal.SIGUSR2)
    guard.wait_for("refused: reset: the axes do not stand yet")
    stops = bus.count(STOP)
    guard.check_busy()
    expect(time.monotonic() < started + 4.5 and stops > 50, "one a period while X moves", stops)
    time.sleep(max(0.0, started + 5.5 - time.monotonic()))
    bus.drain()
    time.sleep(0.3)
    guard.check_busy()
    expect(bus.count(STOP) == 0, "X stands: the stop is confirmed", *guard.lines)
    del guard.lines[:]
    guard.process.send_signal(signal.SIGUSR2)
    guard.wait_for(" ready")
    guard.arm()
    board.end()
    guard.end()
    print(f"{format_}, {motion}: {stops} stop frames in 0.5 s while X moved", flush=True)


for format_ in sys.argv[1:]:
    for motion in ("creep", "swing"):
        attempt(never_armed_while_it_moves, format_, motion)
        attempt(never_confirmed_while_it_moves, format_, motion)
