# SPDX-License-Identifier: Apache-2.0
"""can-utils' canplayer plays a simulated trace at its own pace onto vcan; the guard answers every
sample of it with a permit of its own, stops at the collision and permits nothing after it.
argv: classical or fd, contact or stoppable."""
import json
import os
import pathlib
import subprocess
import sys
import time

from vm_bus import (BUILD, EMERGENCY, HEARTBEAT, PERMIT, RUNNING, SOURCE, STOP, TWIN, WORD_STOP,
                    WORD_STOP_TWIN, Board, Bus, Guard, attempt, expect)

LAST_AXIS_FRAME = {"classical": "381#", "fd": "181##"}
TRACE = os.environ.get("AXG_VM_TRACE", "collide-{}.log")  # in build/can_vm


# The trace holds 800 samples at rest, 560 in motion before the contact, and 500 of these before a
# stop from there with a permit of 50 ms would end in it. The guard is armed at rest, and for that
# needs 256 samples or more that show the board's period: canplayer sends each late by up to 1 ms.
REASONS = {"contact": ("contact", 450), "stoppable": ("predicted", 350)}


STATUS = "/run/replay.status"
FIGURES = ("needed_mm", "available_mm", "margin_mm")


def why_of_the_guard():
    """What it shows of its stop while it runs."""
    run = subprocess.run([BUILD / "axguardd", "status", "--socket", STATUS, "--json"],
                         capture_output=True, text=True)
    expect(run.returncode == 10, run.stdout, run.stderr)
    line = json.loads(run.stdout)
    expect(line["phase"] == "stopped" and line["why"], line)
    return line["why"]


def judge_black_box(report, reason, why):
    """The dump that the guard left tells the same stop, and the same distances."""
    program = [BUILD / "axguard", "replay", f"/run/machine-{sys.argv[1]}.yaml", "--mesh-root",
               SOURCE / "config/machines", report["black_box"], "--json=/run/box.json"]
    run = subprocess.run(program, capture_output=True, text=True)
    expect(run.returncode == 10, run.stdout, run.stderr)
    with open("/run/box.json") as file:
        box = json.load(file)
    expect(box["is_reproduced"] and box["recorded"]["reason"] == reason, box)
    expect(box["verdicts"]["different"] == 0 and box["snapshots"]["different"] == 0, box)
    # From its start to the stop and after it, byte for byte in the same order.
    expect(box["sent"] and box["sent"]["different"] == 0, box)
    expect(box["sent"]["same"] == box["frames_sent"] + box["frames_refused"] > 500, box)
    expect(all(abs(box["why"][key] - why[key]) < 1e-4 for key in FIGURES), box["why"], why)
    expect(box["why"].get("open") is None or
           abs(box["why"]["open"]["needed_mm"] - why["open"]["needed_mm"]) < 1e-4, box["why"], why)
    print("black box:", box["verdicts"], "frames sent:", box["sent"],
          "from a frame to its permit, us:", box["permit_us"], "to the stop:", box["stop_us"],
          flush=True)


def keep(dump):
    """For the record: the exchange around the stop, and of the whole how long after the last frame
    of a sample its answer was on the bus."""
    frames = []
    for line in dump.read_text().splitlines():
        stamp, _, frame = line.split()
        frames.append((float(stamp[1:-1]), frame, line))
    stop_s = next(time_s for time_s, frame, _ in frames if frame == "001#")
    folder = pathlib.Path(os.environ["AXG_VM_OUT"], "kept")
    folder.mkdir(exist_ok=True)
    (folder / "exchange.log").write_text("".join(
        line + "\n" for time_s, _, line in frames if -0.5 < time_s - stop_s < 0.1))
    rows, sample_s = [], None
    for time_s, frame, _ in frames:
        if frame.startswith(LAST_AXIS_FRAME[sys.argv[1]]):
            sample_s = time_s
        elif sample_s is not None and (frame.startswith("103#") or frame == "001#"):
            kind = "permit" if frame != "001#" else "stop"
            rows.append(f"{kind},{round((time_s - sample_s) * 1e6)}\n")
            sample_s = None
            if kind == "stop":
                break
    (folder / "latency.csv").write_text("answer,us\n" + "".join(rows))


def stop_at_the_collision(format_, mode):
    reason, permits_min = REASONS[mode]
    bus, dump = Bus(), pathlib.Path("/run/exchange.log")
    with open(dump, "wb") as file:
        candump = subprocess.Popen(["candump", "-L", "-r", "16000000", "vcan0"], stdout=file)
    RUNNING.append(candump)
    guard = Guard("--status-socket", STATUS, format_=format_, mode=mode)
    guard.wait_for("selftest")
    board = Board(TRACE.format(format_))
    guard.arm()
    guard.wait_for("stopped", timeout_s=30)
    guard.check_busy()
    time.sleep(0.1)
    why = why_of_the_guard()
    board.end()
    code, report = guard.end()
    expect(code == 10 and report["cause"] == "verdict" and report["reason"] == reason,
           code, report, *guard.lines)
    expect(guard.said(f"stopped: verdict: {reason}: cutter - c"), *guard.lines)
    bodies = "cutter (tool 1) and c" if mode == "stoppable" else "cutter and c"
    expect(guard.said(f"  {bodies} "), "the log lacks the sentences", *guard.lines)
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
    expect(ids.count(WORD_STOP) == ids.count(WORD_STOP_TWIN) == 1 and WORD_STOP in ids[first:],
           "one word stop after the stop", frames[first:first + 20])
    expect(ids[first:].count(EMERGENCY) == 1, ids[first:])
    expect(ids.count(HEARTBEAT) > 100, ids.count(HEARTBEAT))
    judge_black_box(report, reason, why)
    candump.terminate()
    candump.wait()
    dumped = [line.split()[2] for line in dump.read_text().splitlines()]
    permits = sum(frame.startswith(f"{PERMIT:03X}#") and not frame.startswith(f"{PERMIT:03X}#5A")
                  for frame in dumped)
    expect(permits == len(plain), "candump saw other permits")
    keep(dump)
    print(f"{len(plain)} permits of {report['snapshots']} snapshots, {report['late']} late,"
          f" {report['refused']} refused, {ids.count(STOP)} stops", flush=True)


attempt(stop_at_the_collision, sys.argv[1], sys.argv[2])
