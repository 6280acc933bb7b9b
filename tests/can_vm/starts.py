# SPDX-License-Identifier: Apache-2.0
"""One call fails while the guard starts: memory, a descriptor, a thread. It says so and ends, or it
can do without; it never hangs, and nothing is permitted that no person armed."""
import os
import pathlib
import random
import signal
import subprocess

from vm_bus import PERMIT, RUNNING, TWIN, Board, Bus, Busy, Guard, attempt, expect, fail

COUNTS = pathlib.Path("/run/counts")
STARTS_A_BOARD = 50  # half of what the trace lasts for
BUSY_STARTS = 3


def read_counts():
    return {name: int(count) for name, count in map(str.split, COUNTS.read_text().splitlines())}


def start(what):
    """Exit code and last words of a guard of which one call failed; "ready" where it could do
    without. Once more where the guest stood still."""
    for _ in range(BUSY_STARTS):
        try:
            return start_once(what)
        except Busy as busy:
            print(f"{what}: the guest stood still: {busy}", flush=True)
    raise Busy(what)


def start_once(what):
    subprocess.run("rm -f /run/*.latch /run/counts", shell=True, check=True)
    os.environ.update(LD_PRELOAD=os.environ["AXG_VM_FAIL_CALL"], AXG_FAIL_CALL=what,
                      AXG_FAIL_COUNTS=str(COUNTS))
    guard = Guard()
    del os.environ["LD_PRELOAD"]  # of the guard alone
    with guard.changed:
        guard.changed.wait_for(lambda: guard.said("ready") or guard.lines[-1:] == ["(ended)"], 20)
    is_ready = guard.said("ready")
    if not is_ready and not guard.said("(ended)"):
        guard.check_busy()
        fail(f"{what}: neither ready nor ended", *guard.lines)
    if is_ready:
        guard.process.terminate()
    code = guard.ended()
    RUNNING.remove(guard.process)
    return code, "ready" if is_ready else " / ".join(guard.lines[-3:])


def starts(most):
    seed = int(os.environ.get("AXG_SEED", "1"))
    print(f"seed {seed} (AXG_SEED overrides it)", flush=True)
    draw = random.Random(seed)
    bus, board = Bus(), Board("idle.log")
    expect(start("none 0")[1] == "ready", "without a failure it starts")
    counts = read_counts()
    print("calls until it was ready and ended:", counts, flush=True)
    expect(min(counts["memory"], counts["descriptor"], counts["thread"]) > 0, counts)
    cases = [(kind, at) for kind in ("descriptor", "thread", "memory") for at in
             sorted(draw.sample(range(1, counts[kind] + 1), min(most, counts[kind])))]
    refused = {}
    for case, (kind, at) in enumerate(cases):
        if case % STARTS_A_BOARD == STARTS_A_BOARD - 1:
            board.end()  # before its trace does
            board = Board("idle.log")
        bus.drain()
        code, words = start(f"{kind} {at}")
        if os.environ.get("AXG_VM_VERBOSE"):
            print(kind, at, code, words, flush=True)
        ids = [identifier for identifier, _ in bus.drain()]
        expect(PERMIT not in ids and TWIN not in ids, f"a permit: {kind} {at}", words)
        if words == "ready":
            continue  # a call that it can do without, or one after that
        # A program in C++ may but abort, within a library or in a thread that begins.
        expect(code > 0 or code == -signal.SIGABRT, f"{kind} {at}: ended as if well", code, words)
        expect(words.removesuffix("(ended)").strip(" /"), f"{kind} {at}: no word", code)
        refused[kind] = refused.get(kind, 0) + 1
    board.end()
    expect(all(refused.get(kind, 0) > 0 for kind in ("descriptor", "thread", "memory")), refused)
    print(f"ok: {len(cases)} failed calls, refused to start: {refused}", flush=True)


attempt(starts, int(os.environ.get("AXG_VM_STARTS", "12")))
