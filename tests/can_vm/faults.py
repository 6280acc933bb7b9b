# SPDX-License-Identifier: Apache-2.0
"""What can happen to a guard on a bus of Linux, one after the other, with a board that plays on:
after each fault there is no permit until a person has reset and armed."""
import os
import random
import signal
import subprocess
import sys
import time

from vm_bus import (HEARTBEAT, PERMIT, RUNNING, STOP, TWIN, Board, Bus, Busy, Guard, attempt,
                    expect)

IDLE = "idle.log"
KILLS_A_BOARD = 100  # half of what the trace lasts for


def quiet_after(bus, seconds):
    """No permit from now on."""
    bus.drain()
    time.sleep(seconds)
    ids = [identifier for identifier, _ in bus.drain()]
    expect(PERMIT not in ids and TWIN not in ids, "a permit after the fault", ids[:40])
    return ids


def armed(*options, **more):
    board = Board(IDLE)
    guard = Guard(*options, **more)
    guard.arm()
    return board, guard


def one_kill(bus, draw):
    """One guard from its start to its end. Busy: the guest stood still before that."""
    subprocess.run("rm -f /run/*.latch", shell=True, check=True)
    bus.drain()
    guard = Guard()
    guard.wait_for("ready")
    ids = [identifier for identifier, _ in bus.drain()]
    expect(PERMIT not in ids, "a permit before a person armed")
    guard.arm()
    time.sleep(draw.uniform(0.03, 0.2))
    guard.check_busy()
    guard.kill()
    expect(PERMIT in [identifier for identifier, _ in bus.drain()], "never permitted")
    ids = quiet_after(bus, 0.06)
    expect(HEARTBEAT not in ids, "a heartbeat after the kill")
    RUNNING.remove(guard.process)
    again = Guard()
    again.wait_for("stopped: latched")  # it was armed, and nobody ended it
    again.kill()
    RUNNING.remove(again.process)


def kills(count):
    """SIGKILL at a random moment: permits end; the next process permits nothing unasked."""
    seed = int(os.environ.get("AXG_SEED", "1"))
    print(f"seed {seed} (AXG_SEED overrides it), {count} kills", flush=True)
    draw = random.Random(seed)
    bus, board = Bus(), Board(IDLE)
    done = busy = 0
    while done < count:
        if done % KILLS_A_BOARD == KILLS_A_BOARD - 1:
            board.end()  # before its trace does
            board = Board(IDLE)
        try:
            one_kill(bus, draw)
            done += 1
        except Busy as words:
            busy += 1
            if busy > count / 10 + 2:
                raise
            print("the guest stood still:", words, flush=True)
    board.end()
    print(f"{done} kills while permits flowed, 0 permits after one; the guest stood still before"
          f" {busy} others", flush=True)


def held():
    """SIGSTOP for a second: no permit while it sleeps, and none when it wakes."""
    board, guard = armed()
    bus = Bus()
    time.sleep(0.05)
    guard.check_busy()
    expect(bus.count(PERMIT) > 0, "never permitted")
    guard.process.send_signal(signal.SIGSTOP)
    time.sleep(0.05)
    quiet_after(bus, 0.5)
    guard.process.send_signal(signal.SIGCONT)
    guard.wait_for("stopped: gap", "input: stale", "input: heartbeat_lost")
    ids = quiet_after(bus, 0.1)
    board.end()
    expect(guard.end()[0] == 11, *guard.lines)
    expect(HEARTBEAT in ids, "it lives")


BUSY_HOST_RETRIES = iter(range(2))


def busy_host():
    """The host stops the whole guest again and again, for longer than a permit lasts (boot.py): the
    guest's clock stops with it, and permits go on. Who stands still by a hypervisor's doing is
    tried again, twice: each try has more than ten stops of ours, and any of them would end it."""
    board, guard = armed()
    bus = Bus()
    time.sleep(3)
    if guard.has_stopped() and next(BUSY_HOST_RETRIES, None) is not None:
        guard.check_busy()
    expect(not guard.has_stopped(), *guard.lines)
    expect(bus.count(PERMIT) > 500, *guard.lines)
    expect(guard.end()[0] == 0, *guard.lines)
    board.end()


def signal_storm():
    """Every signal that a guard may get while it runs, thousands of them, and stops too short for
    the board to notice, each of which ends what a thread was waiting in: permits go on."""
    board, guard = armed()
    bus = Bus()
    kinds = (signal.SIGUSR1, signal.SIGCONT, signal.SIGWINCH, signal.SIGCHLD, signal.SIGURG)
    before = thread_wakes(guard.process.pid)
    for at in range(3000):
        guard.process.send_signal(kinds[at % len(kinds)])
        if at % 100 == 0:
            guard.process.send_signal(signal.SIGSTOP)
            guard.process.send_signal(signal.SIGCONT)
    bus.drain()
    time.sleep(0.2)
    guard.check_busy()
    expect(thread_wakes(guard.process.pid) > before, "no signal came to anything")
    expect(bus.count(PERMIT) > 5, "permits go on", *guard.lines)
    code, report = guard.end()  # before its board: a busy host takes longer than a sample may
    board.end()
    expect(code == 0, code, *guard.lines)


def thread_wakes(pid):
    """How often its threads gave the processor up to wait."""
    wakes = 0
    for thread in os.listdir(f"/proc/{pid}/task"):
        with open(f"/proc/{pid}/task/{thread}/status") as file:
            wakes += sum(int(line.split()[1]) for line in file
                         if line.startswith("voluntary_ctxt_switches"))
    return wakes


def down_and_up():
    """Interface down: stopped; up again: still stopped, until reset and arm."""
    board, guard = armed()
    subprocess.run(["ip", "link", "set", "vcan0", "down"], check=True)
    board.end()
    guard.wait_for("stopped: input", "input: stale", "input: heartbeat_lost")
    expect(guard.said("the interface is down"), *guard.lines)
    subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)
    board, bus = Board(IDLE), Bus()
    ids = quiet_after(bus, 1.5)
    expect(STOP not in ids[-20:], "the axes stand, which confirms the stop")
    del guard.lines[:]
    guard.process.send_signal(signal.SIGUSR2)
    guard.wait_for("ready")
    expect(not quiet_after(bus, 0.05).count(PERMIT), "a reset permits nothing")
    guard.arm()
    time.sleep(0.1)
    guard.check_busy()
    expect(bus.count(PERMIT) > 5, *guard.lines)
    board.end()
    guard.kill()


def removed():
    """The interface is gone: the program ends, and the latch stays."""
    board, guard = armed()
    subprocess.run(["ip", "link", "del", "vcan0"], check=True)
    board.end()
    guard.wait_for("the interface was removed", "input: stale", "input: heartbeat_lost")
    expect(guard.ended() == 12, *guard.lines)
    subprocess.run(["ip", "link", "add", "vcan0", "type", "vcan"], check=True)
    subprocess.run(["ip", "link", "set", "vcan0", "mtu", "72", "up"], check=True)
    again = Guard()
    again.wait_for("stopped: latched")
    expect(again.end()[0] == 10, *again.lines)


def two_instances():
    """The second one ends, the first one goes on; a foreign permit stops it."""
    board, guard = armed()
    second = Guard()
    expect(second.ended() == 14, *second.lines)
    expect(second.said(f"process {guard.process.pid}, guards vcan0"), *second.lines)
    bus = Bus()
    time.sleep(0.1)
    guard.check_busy()
    expect(bus.count(PERMIT) > 5, "the first goes on", *guard.lines)
    subprocess.run(["cansend", "vcan0", "103#A501010000FAFFFF"], check=True)
    guard.wait_for("stopped: second_guard")
    quiet_after(bus, 0.1)
    board.end()
    expect(guard.end()[0] == 12, *guard.lines)


def two_states():
    """No lock separates two guards with different state directories: their frames do, and neither
    permits any more."""
    board, guard = armed()
    os.mkdir("/run/other")
    second = Guard(state_dir="/run/other")
    second.wait_for("stopped: ")
    second.wait_for("bus: a guard frame from another sender")
    guard.wait_for("stopped: ")
    quiet_after(Bus(), 0.1)
    for each in (second, guard):
        expect(each.end()[0] == 12, *each.lines)
    board.end()


def foreign_stop():
    """A stop frame from another sender, with a byte that it should not have, stops the guard too;
    its own are none."""
    board, guard = armed()
    bus = Bus()
    subprocess.run(["cansend", "vcan0", "001#01"], check=True)
    guard.wait_for("stopped: foreign_stop")
    expect(guard.said("bus: a stop frame from another sender (001)"), *guard.lines)
    quiet_after(bus, 1)
    del guard.lines[:]
    guard.process.send_signal(signal.SIGUSR2)
    guard.wait_for("ready")  # though it heard its own stops all the while
    guard.end()
    board.end()


def foreign_frames():
    """Extended and remote frames with our ids, and a flood of others, never reach the guard; a
    flood with our ids stops it."""
    board, guard = armed()
    bus = Bus()
    extended, remote = 1 << 31, 1 << 30
    for _ in range(300):
        bus.send(0x181 | extended, bytes(8))
        bus.send(0x181 | remote)
        bus.send(0x7AA, bytes(8))
    guard.check_busy()
    time.sleep(0.1)
    guard.check_busy()
    expect(bus.count(PERMIT) > 5, "permits go on", *guard.lines)
    for _ in range(20):
        bus.send(0x381, bytes(8))
    guard.wait_for("stopped: input")
    guard.check_busy()
    expect(guard.said("input: flood") or guard.said("input: spoofed"), *guard.lines)
    quiet_after(bus, 0.1)
    board.end()
    code, report = guard.end()
    expect(code == 12, *guard.lines)
    faults = report["receiver_faults"]
    expect("extended_id" not in faults and "remote_frame" not in faults, faults)


def small_buffer():
    """A queue that is too small loses frames, and that is counted as loss."""
    board, guard = armed("--receive-buffer", "1")  # as small as the kernel makes one
    bus = Bus()
    guard.process.send_signal(signal.SIGSTOP)
    time.sleep(0.005)
    for _ in range(500):
        bus.send(0x701)  # a heartbeat without its byte: read, and not used
    guard.process.send_signal(signal.SIGCONT)
    time.sleep(0.1)
    guard.check_busy("input: loss_limit")  # so many that the receiver gives up, as it should
    board.end()
    _, report = guard.end()
    # The kernel tells of drops with the next frame that finds room: how many it told is its affair.
    expect(report["frames_dropped"] > 0, report)
    told = report["receiver_faults"].get("rx_overflow", 0)
    expect(told > 0 and report["samples_lost"] >= told, report)


def small_buffer_at_the_start():
    """What does not fit while the guard starts, with a board that plays already, is no loss to a
    guard that was not there."""
    board, guard = armed("--receive-buffer", "1")
    guard.check_busy()
    board.end()
    _, report = guard.end()
    expect(report["frames_dropped"] > 0, "everything fitted: nothing is shown", report)
    expect("rx_overflow" not in report["receiver_faults"], report)


def frames_of_this_host():
    """Without the switch for vcan, a board on this host is a second sender."""
    board = Board(IDLE)
    guard = Guard(is_local=False)
    guard.wait_for("input: local_sender")
    board.end()
    expect(guard.end()[0] == 12, *guard.lines)


SCENARIOS = {scenario.__name__: scenario for scenario in
             (held, busy_host, signal_storm, down_and_up, removed, two_instances, two_states,
              foreign_stop, foreign_frames, small_buffer, small_buffer_at_the_start,
              frames_of_this_host)}

if sys.argv[1] == "kills":
    attempt(kills, int(os.environ.get("AXG_VM_KILLS", "5")))
else:
    for name in sys.argv[1:]:
        attempt(SCENARIOS[name])
