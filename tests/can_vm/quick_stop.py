# SPDX-License-Identifier: Apache-2.0
"""Two simulated CiA 402 drives on the other end of the bus: they stop when the guard stops, and
never before. Then five drives, of which one moves: nothing that the others send confirms the
stop."""
import pathlib
import struct
import subprocess
import time

from vm_bus import (BUILD, SOURCE, STOP, Board, Bus, Guard, attempt, expect, machine_file,
                    reset_only_at_rest)

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


def drive_keys():
    """Five drives that report position and speed, and two that are told to stop."""
    lines = ["  sync_counter: 240", "  drives:"]
    for node, (axis, unit) in enumerate(zip("XYZAC", ("mm", "mm", "mm", "deg", "deg")), 3):
        turn = ", range_counts: 3600000" if axis == "C" else ""
        lines.append(f"    {axis}: {{pdos: [{{cob_id: 0x18{node}, map: [0x60410010, 0x60640020]}}, "
                     f"{{cob_id: 0x28{node}, map: [0x606C0020]}}], counts: 10000, per_{unit}: 1, "
                     f"absolute: true, velocity: {{counts: 1000, per_{unit}_s: 1}}{turn}}}")
    lines.append(f"  quick_stop: [{', '.join(map(hex, DRIVES))}]")
    return "\n".join(lines) + "\n"


def simulated(keys):
    """Four seconds at rest, X at 10 mm/s for two, and rest."""
    program, trace = pathlib.Path("/run/one-axis.ngc"), pathlib.Path("/run/one-axis.log")
    program.write_text("T1 M6\nG4 P4\nG1 X20 F600\nG4 P20\nM2\n")
    subprocess.run([BUILD / "axguard", "simulate", machine_file("cia402", can_keys=keys), program,
                    "--mesh-root", SOURCE / "config/machines", "-o", trace], check=True,
                   stdout=subprocess.DEVNULL)
    return trace


def one_of_five_moves():
    keys = drive_keys()
    trace = simulated(keys)
    guard = Guard(format_="cia402", can_keys=keys)
    guard.wait_for("selftest")
    bus = Bus(only=(STOP,))
    board = Board(trace)
    started = time.monotonic()
    guard.arm()
    time.sleep(max(0.0, started + 4.6 - time.monotonic()))
    guard.check_busy()
    Bus().send(DRIVES[1], struct.pack("<H", 0x000F))  # a reason to stop that passes
    guard.wait_for("stopped: second_guard")
    stops = reset_only_at_rest(guard, bus, lambda: time.monotonic() < started + 5.8, started + 7.5)
    board.end()
    guard.end()
    print(f"{stops} stop frames while X moved", flush=True)


attempt(quick_stop)
attempt(foreign_quick_stop)
attempt(one_of_five_moves)
