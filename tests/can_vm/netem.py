# SPDX-License-Identifier: Apache-2.0
"""A bus that delays, loses and holds back frames: netem between the two ends of a vxcan pair. The
board is on vxcan1, the guard on vxcan0."""
import subprocess
import time

from vm_bus import BUILD, PERMIT, RUNNING, Bus, Guard, attempt, expect


class Link:
    """What netem does to the frames that leave an interface; nothing of it stays."""

    def __init__(self, interface, *words):
        self.interface = interface
        subprocess.run(["tc", "qdisc", "add", "dev", interface, "root", "netem", *words],
                       check=True)
        RUNNING.append(self)

    def statistics(self):
        return subprocess.run(["tc", "-s", "qdisc", "show", "dev", self.interface], check=True,
                              capture_output=True, text=True).stdout

    def kill(self):
        subprocess.run(["tc", "qdisc", "del", "dev", self.interface, "root"], check=False)

    def wait(self):
        pass


def armed():
    with open(BUILD / "can_vm" / "idle.log") as file:
        RUNNING.append(subprocess.Popen(["nice", "-n", "-15", "canplayer", "-g", "1",
                                         "vxcan1=can0"], stdin=file, stderr=subprocess.DEVNULL))
    guard = Guard(bus="vxcan0", is_local=False)
    guard.arm()
    time.sleep(0.1)
    guard.check_busy()
    return guard


def permits(seconds):
    bus = Bus("vxcan1")
    time.sleep(seconds)
    return bus.count(PERMIT)


def some_are_lost():
    """One frame in a hundred: a sample is lost now and then, and the guard goes on."""
    guard = armed()
    link = Link("vxcan1", "loss", "1%")
    count = permits(2)
    guard.check_busy()
    expect(count > 200, "permits go on", count, *guard.lines)
    dropped = int(link.statistics().split("dropped ")[1].split(",")[0])
    _, report = guard.end()
    expect(dropped > 0 and report["samples_lost"] > 0, "nothing was lost", dropped, report)


def many_are_lost():
    """Every third: more than can be borne."""
    guard = armed()
    Link("vxcan1", "loss", "33%")
    guard.wait_for("stopped", "input: loss_limit", "input: stale", "stopped: silence",
                   "stopped: flapping", "input: heartbeat_lost")
    expect(permits(0.2) == 0, "a permit after the stop")
    expect(guard.end()[0] in (11, 12), *guard.lines)


def held_up():
    """Held up for longer than a permit lasts, and then all alike."""
    guard = armed()
    Link("vxcan1", "delay", "100ms")
    guard.wait_for("stopped", "input: stale", "stopped: silence", "input: heartbeat_lost")
    expect(permits(0.2) == 0, "a permit after the stop")
    guard.end()


def nothing_gets_out():
    """The guard's own queue is full: its frame is refused, and two periods later it stops."""
    guard = armed()
    Link("vxcan0", "rate", "8kbit", "limit", "1")
    guard.wait_for("stopped: output")
    expect(guard.said("a guard frame was rejected") or guard.said("was not seen on the bus"),
           *guard.lines)
    expect(guard.end()[0] == 12, *guard.lines)


for scenario in (some_are_lost, many_are_lost, held_up, nothing_gets_out):
    attempt(scenario)
