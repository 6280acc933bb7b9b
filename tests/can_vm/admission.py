# SPDX-License-Identifier: Apache-2.0
"""A guard is admitted, or refused, before it is ready; what is waived is said and counted."""
import json
import pathlib
import re
import signal
import time

from vm_bus import Board, Guard, attempt, expect

VERDICT = pathlib.Path("/run/vcan0.admission.json")
METRICS = pathlib.Path("/run/guard.prom")


def verdict():
    return json.loads(VERDICT.read_text())


def failed():
    return [check["check"] for check in verdict()["checks"] if not check["passed"]]


def refused():
    """A processor that is not there is bad, and nobody has waived that."""
    guard = Guard(admission=("--bus-cpu", "200", "--admit-seconds", "0.05", "--admit-unfit",
                             "latency,engine,cycle"))
    expect(guard.ended(60) == 14, *guard.lines)
    guard.wait_for("not fit for 200 Hz: system")
    expect(guard.said("bus thread: processor 200 is not there"), *guard.lines)
    expect(guard.said("-> a computer with 3 processors or more"), "what to change", *guard.lines)
    expect(not guard.said("selftest"), "it never began", *guard.lines)
    expect(not verdict()["admitted"] and "system" in failed(), verdict())


def waived_by_name():
    """The interface is up, and is no controller: that is to look at, and not bad."""
    board = Board("idle.log")
    guard = Guard("--metrics", str(METRICS))
    time.sleep(1)
    guard.process.send_signal(signal.SIGUSR1)  # too early: it has no effect, and ends nothing
    guard.wait_for("rejected: arm: the guard is not ready")
    guard.wait_for(" ready; arm")
    guard.arm()
    time.sleep(2.5)
    guard.check_busy()
    found = verdict()
    expect(found["admitted"] and "system" not in failed(), found)
    expect("known_answer" not in failed() and "memory" not in failed(), found)
    expect(found["figures"]["cycles"]["count"] == 128, found)
    expect(found["figures"]["wake_ups"]["count"] == 10, found)
    metrics = METRICS.read_text()
    for check in (entry["check"] for entry in found["checks"]):
        value = re.search(rf'^axguard_admission_waived{{bus="vcan0",check="{check}"}} (\d)$',
                          metrics, re.M)
        expect(value and int(value.group(1)) == (check in failed()), check, found, metrics)
    expect(f'axguard_admission_fit{{bus="vcan0"}} {int(found["fit"])}' in metrics, metrics)
    for name in failed():
        expect(guard.said(f"BAD   {name}"), name, *guard.lines)
    board.end()
    guard.end()


attempt(refused)
attempt(waived_by_name)
