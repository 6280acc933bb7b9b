# SPDX-License-Identifier: Apache-2.0
"""The states of a real controller, through the kernel's own CAN device layer: slcan on a pseudo
terminal, and this script is the bus on its far side. It plays a board, hears the guard, and says
error-passive and bus-off; then it takes no frame any more."""
import fcntl
import os
import struct
import subprocess
import termios
import threading
import time
import tty

from vm_bus import BUILD, HEARTBEAT, PERMIT, RUNNING, STOP, Guard, attempt, expect, name_of

N_SLCAN, SIOCGIFNAME = 17, 0x8910


class Far:
    """The bus behind the controller: frames as slcan writes them, `t1812AABB` and a return."""

    def __init__(self):
        self.master, self.line = os.openpty()
        for end in (self.master, self.line):
            tty.setraw(end)
        fcntl.ioctl(self.line, termios.TIOCSETD, struct.pack("i", N_SLCAN))
        name = fcntl.ioctl(self.line, SIOCGIFNAME, bytes(40))
        self.name = name[:16].split(b"\0")[0].decode()
        subprocess.run(["ip", "link", "set", self.name, "up"], check=True)
        self.heard = []  # identifiers, by name_of
        self.is_open = True
        self.hears = threading.Event()  # cleared: the bus takes nothing
        self.hears.set()
        for work in (self._hear, self._play):
            threading.Thread(target=work, daemon=True).start()

    def kill(self):  # as a process of vm_bus.RUNNING
        self.is_open = False
        subprocess.run(["ip", "link", "set", self.name, "down"], check=False)
        os.close(self.line)

    def wait(self):
        pass

    def say(self, text):
        os.write(self.master, text.encode() + b"\r")

    def _hear(self):
        rest = b""
        while self.is_open:
            self.hears.wait()
            try:
                rest += os.read(self.master, 4096)
            except OSError:
                return
            *lines, rest = rest.split(b"\r")
            self.heard += [name_of(int(line[1:4], 16), bytes.fromhex(line[5:21].decode()))
                           for line in lines if line.startswith(b"t")]

    def _play(self):
        """The idle trace, at its own pace."""
        begin = None
        with open(BUILD / "can_vm" / "idle.log") as file:
            for line in file:
                stamp, _, frame = line.split()[:3]
                identifier, data = frame.split("#")
                at = float(stamp[1:-1])
                begin = time.monotonic() - at if begin is None else begin
                time.sleep(max(0, begin + at - time.monotonic()))
                if not self.is_open:
                    return
                self.say(f"t{identifier}{len(data) // 2}{data}")


def armed():
    far = Far()
    RUNNING.append(far)
    guard = Guard(bus=far.name, is_local=False)
    guard.arm()
    time.sleep(0.1)
    guard.check_busy()
    expect(far.heard.count(PERMIT) > 5, "permits reach the bus", far.heard[-20:])
    return far, guard


def permits_end(far, guard):
    """None after what has been said, and the stop."""
    first = len(far.heard)
    time.sleep(0.3)
    expect(PERMIT not in far.heard[first:], "a permit after the stop", far.heard[first:])
    guard.end()


def receiver_passive():
    """The guard hears badly: other rules find what is lost, the state alone stops nothing."""
    far, guard = armed()
    far.say("sp128000")
    time.sleep(0.3)
    guard.check_busy()
    expect(guard.process.poll() is None and not guard.said("stopped"), *guard.lines)
    code, report = guard.end()
    expect(report["receiver_faults"].get("rx_passive") == 1, "the state was not told", report)


def sender_passive():
    """The guard's stop may not arrive any more: it stops while it still may."""
    far, guard = armed()
    far.say("sp000128")
    guard.wait_for("stopped: input")
    expect(guard.said("input: tx_passive"), *guard.lines)
    time.sleep(0.1)
    expect(STOP in far.heard, "the stop reaches the bus", far.heard[-20:])
    permits_end(far, guard)


def bus_off():
    far, guard = armed()
    far.say("sb000256")
    guard.wait_for("stopped: input")
    expect(guard.said("input: bus_off"), *guard.lines)
    permits_end(far, guard)


def stuck_bus():
    """The bus takes no frame, and says nothing: the line's buffer fills, then the queue, and a
    frame is refused. When the bus goes on, what waited comes out, and no permit after it. (The
    board stands and says so, so the stop need not get out as well.)"""
    far, guard = armed()
    far.hears.clear()
    guard.wait_for("stopped: output", timeout_s=60)
    expect(guard.said("a guard frame was rejected"), *guard.lines)
    far.hears.set()
    time.sleep(0.5)
    expect(HEARTBEAT in far.heard[-3:], "frames get out again", far.heard[-20:])
    permits_end(far, guard)


for scenario in (receiver_passive, sender_passive, bus_off, stuck_bus):
    attempt(scenario)
