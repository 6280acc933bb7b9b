# SPDX-License-Identifier: Apache-2.0
"""Two simulated CiA 402 drives on the other end of the bus: they stop when the guard stops, and
never before."""
import struct
import time

from vm_bus import STOP, Board, Bus, Guard, attempt, expect

DRIVES = (0x303, 0x304)
OPERATION_ENABLED, QUICK_STOP_ACTIVE = 0x27, 0x07  # status word, its bits of the state
QUICK_STOP = 0x0002


class Drive:
    """What of a CiA 402 drive matters here: the control word leads from one state to the other."""

    def __init__(self):
        self.state = OPERATION_ENABLED
        self.commands = 0

    def on_control_word(self, data):
        expect(len(data) == 2, "the PDO maps the control word alone", data)
        (word,) = struct.unpack("<H", data)
        self.commands += 1
        if word & 0x86 == QUICK_STOP:  # 0xxx x01x
            self.state = QUICK_STOP_ACTIVE


def take(bus, drives):
    """What arrived, in order; the drives have seen it."""
    frames = bus.drain()
    for identifier, data in frames:
        if identifier in drives:
            drives[identifier].on_control_word(data)
    return [identifier for identifier, _ in frames]


def guard_with_drives():
    return Guard(can_keys=f"  quick_stop: [{', '.join(map(hex, DRIVES))}]\n")


def quick_stop():
    drives = {identifier: Drive() for identifier in DRIVES}
    bus = Bus()
    guard = guard_with_drives()
    guard.wait_for("selftest")
    board = Board("collide-classical.log")
    guard.arm()
    take(bus, drives)
    expect(all(drive.state == OPERATION_ENABLED for drive in drives.values()), "too early")
    guard.wait_for("stopped: verdict")
    guard.check_busy()
    time.sleep(0.2)
    board.end()
    expect(guard.end()[0] == 10, *guard.lines)
    ids = take(bus, drives)
    expect(all(drive.state == QUICK_STOP_ACTIVE for drive in drives.values()), "a drive moves on")
    ours = [identifier for identifier in ids if identifier == STOP or identifier in DRIVES]
    expect(ours[:3] == [STOP, *DRIVES], "the stop first, then each drive", ours[:6])
    expect(all(drive.commands > 5 for drive in drives.values()), "sent again each period", ours)


def foreign_quick_stop():
    """A master that uses the same PDO would undo a stop: found before there is one."""
    board = Board("idle.log")
    guard = guard_with_drives()
    guard.arm()
    Bus().send(DRIVES[1], struct.pack("<H", 0x000F))
    guard.wait_for("stopped: second_guard")
    board.end()
    guard.end()


attempt(quick_stop)
attempt(foreign_quick_stop)
