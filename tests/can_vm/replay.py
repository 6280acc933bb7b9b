# SPDX-License-Identifier: Apache-2.0
"""can-utils' canplayer plays a simulated trace at its own pace onto vcan; the guard answers every
sample of it with a permit of its own, stops at the collision and permits nothing after it.
argv: classical or fd, contact or stoppable."""
import json
import subprocess
import sys
import time

from vm_bus import (BUILD, EMERGENCY, HEARTBEAT, PERMIT, SOURCE, STOP, TWIN, Board, Bus, Guard,
                    attempt, expect)


# The trace holds 560 samples before the contact, and 500 before a stop from there with a permit of
# 50 ms would end in it; some 30 of them pass before the guard is armed.
REASONS = {"contact": ("contact", 450), "stoppable": ("predicted", 350)}


def judge_black_box(report, reason):
    """The dump that the guard left tells the same stop."""
    program = [BUILD / "axguard", "replay", f"/run/machine-{sys.argv[1]}.yaml", "--mesh-root",
               SOURCE / "config/machines", report["black_box"], "--json=/run/box.json"]
    run = subprocess.run(program, capture_output=True, text=True)
    expect(run.returncode == 10, run.stdout, run.stderr)
    with open("/run/box.json") as file:
        box = json.load(file)
    expect(box["is_reproduced"] and box["recorded"]["reason"] == reason, box)
    expect(box["verdicts"]["different"] == 0 and box["pictures"]["different"] == 0, box)
    print("black box:", box["verdicts"], "from a frame to its permit, us:", box["permit_us"],
          "to the stop:", box["stop_us"], flush=True)


def stop_at_the_collision(format_, mode):
    reason, permits_min = REASONS[mode]
    bus = Bus()
    guard = Guard(format_=format_, mode=mode)
    guard.wait_for("selftest")
    board = Board(f"collide-{format_}.log")
    guard.arm()
    guard.wait_for("stopped", timeout_s=30)
    guard.check_busy()
    time.sleep(0.1)
    board.end()
    code, report = guard.end()
    expect(code == 10 and report["cause"] == "verdict" and report["reason"] == reason,
           code, report, *guard.lines)
    expect(guard.said(f"stopped: verdict: {reason}: cutter - c"), *guard.lines)
    frames = bus.drain()
    ids = [identifier for identifier, _ in frames]
    plain = [data for identifier, data in frames if identifier == PERMIT]
    twins = [data for identifier, data in frames if identifier == TWIN]
    expect(len(plain) > permits_min, f"{len(plain)} permits", report)
    expect(len(plain) == report["permits"], f"{len(plain)} permits on the bus", report)
    expect(report["samples_lost"] == 0, report)
    for one, other in zip(plain, twins):
        expect(bytes(byte ^ 0xFF for byte in one) == other, one, other)
        expect(one[0] == 0xA5, one)
    steps = [(b[2] - a[2]) % 256 for a, b in zip(plain, plain[1:])]
    expect(set(steps) == {1}, "live counters", steps)
    first = ids.index(STOP)
    after = set(ids[first:]) & {PERMIT, TWIN}
    expect(not after, "a permit after the stop", frames[first:first + 20])
    expect(ids[first:].count(EMERGENCY) == 1, ids[first:])
    expect(ids.count(HEARTBEAT) > 100, ids.count(HEARTBEAT))
    judge_black_box(report, reason)
    print(f"{len(plain)} permits of {report['pictures']} pictures, {report['late']} late,"
          f" {report['refused']} refused, {ids.count(STOP)} stops", flush=True)


attempt(stop_at_the_collision, sys.argv[1], sys.argv[2])
