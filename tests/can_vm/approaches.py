# SPDX-License-Identifier: Apache-2.0
"""The closed loop's motion board on vcan, live (live_board.cpp): it says the same hashes, is
permitted, makes for a contact, and is stopped before it. CGAL judges where the axes truly were."""
import json
import os
import pathlib
import subprocess
import time

from vm_bus import BUILD, RUNNING, SOURCE, Busy, Guard, attempt, expect, machine_file

COUNT = int(os.environ.get("AXG_VM_APPROACHES", "1"))
SEED = os.environ.get("AXG_SEED", "20261121")
PERMIT_SAMPLES = 5  # as short as the guest allows: who may move for longer is stopped farther off


def one(board):
    """What came of one approach, and of the guard. Busy: the guest stood still."""
    for latch in pathlib.Path("/run").glob("*.latch"):
        latch.unlink()
    guard = Guard(mode="stoppable", has_hashes=True, permit_samples=PERMIT_SAMPLES)
    guard.wait_for("selftest")  # it measures first; the board waits ten seconds
    board.stdin.write("go\n")
    board.stdin.flush()
    busy = None
    try:
        guard.arm()
    except Busy as words:
        busy = words  # the board is not permitted, and ends by itself
    result = json.loads(board.stdout.readline())
    expect("fault" not in result, result)
    expect(not result["touches"], "the machine touched itself", result, *guard.lines)
    if busy:
        return result, None
    time.sleep(0.05)
    _, report = guard.end()
    return result, report


def approaches():
    path = machine_file(has_hashes=True, permit_samples=PERMIT_SAMPLES)
    print(f"seed {SEED} (AXG_SEED overrides it), {COUNT} approaches", flush=True)
    board = subprocess.Popen([BUILD / "tests/axg_live_board", path, SOURCE / "config/machines",
                              "vcan0", SEED], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                             text=True)
    RUNNING.append(board)
    tally = {"moved": 0, "stopped": 0, "verdict": 0, "other": 0, "not_permitted": 0, "busy": 0,
             "too_near": 0}
    permits = samples = judged = 0
    while tally["moved"] < COUNT:
        expect(tally["busy"] + tally["not_permitted"] < 5 * COUNT + 20, "never permitted", tally)
        result, report = one(board)
        if not result["moved"]:  # so near that no certificate is to be had, or a guest held up
            tally["busy" if report is None else "not_permitted"] += 1
            continue
        tally["moved"] += 1
        tally["stopped"] += result["state"] == "stopped"
        is_verdict = report is not None and report["cause"] == "verdict"
        tally["verdict" if is_verdict else "other"] += 1
        tally["too_near"] += result["too_near"]
        permits += report["permits"] if report is not None else 0
        samples += result["samples"]
        judged += result["judged"]
    expect(tally["stopped"] > 0, "nothing was stopped: nothing is shown", tally)
    print(f"{tally}, {samples} samples, {permits} permits, {judged} places judged or passed over",
          flush=True)


attempt(approaches)
