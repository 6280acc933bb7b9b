# SPDX-License-Identifier: Apache-2.0
"""LinuxCNC as the board, axguardd as a guard of its own on the bus (axguard-hal --bus): a harmless
program runs, a collision is stopped, and kill -9 of the guard in motion brakes the joints."""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import threading
import time

import vm_bus
from vm_bus import BUILD, PERIOD_US, SOURCE, Bus, Busy, Guard, attempt, expect, fail

sys.path.insert(0, str(SOURCE / "tests/linuxcnc"))
from judge import contacts_of  # noqa: E402
from loop_test import COLLIDE, HEAD, STOPPING, SWING, stop_facts  # noqa: E402
from place import Place, module  # noqa: E402

SHORT = HEAD + "G0 X60 Y-40 Z40\nG0 X0 Y0\nM2\n"
MACHINE = pathlib.Path("/run/guard.yaml")
EXAMPLE = "firmware_if/linuxcnc/examples/paper-trunnion/paper-trunnion.yaml"
AXES = 0x181
CAUSE_STOP_FRAME, CAUSE_PERMIT_ENDED = "1", "3"
FOLDER = pathlib.Path("/run/linuxcnc")
# Two servo periods: the one in which the permit ends, and the first of the ramp.
REACTION_MS = 2 * PERIOD_US // 1000
JITTER_US = PERIOD_US // 5  # of SYNC, which a program sends


def in_guest_time(text):
    """The example's machine file with the guest's period."""
    text = text.replace("  board_reaction_ms: 2\n", f"  board_reaction_ms: {REACTION_MS}\n"
                        f"  latch_jitter_us: {JITTER_US}\n")
    return (text + f"  sample_us: {PERIOD_US}\n  permit_samples: 10\n"
            f"  stale_after_us: {10 * PERIOD_US}\ndeadline_us: {PERIOD_US // 2}\n")


class BusPlace(Place):
    """LinuxCNC with the guest's period, and the guard on the bus."""

    def write_ini(self):
        super().write_ini()
        ini = self.folder / "paper-trunnion.ini"
        text = ini.read_text(encoding="utf-8")
        ini.write_text(text.replace("SERVO_PERIOD = 1000000", f"SERVO_PERIOD = {PERIOD_US}000"),
                       encoding="utf-8")
        machine = self.folder / "paper-trunnion.yaml"
        machine.write_text(in_guest_time(machine.read_text(encoding="utf-8")), encoding="utf-8")

    def write_hal(self, guarded, simulation_wait_us):
        super().write_hal(guarded, simulation_wait_us)
        hal = self.folder / "paper-trunnion.hal"
        text = hal.read_text(encoding="utf-8")
        text = text.replace(" --simulation ", " --bus vcan0 ")
        assert "--bus vcan0" in text, "the guard would be in LinuxCNC's own process"
        shown = " --status-socket axguard.status --state-dir ."  # here axguardd shows the guard
        assert shown in text
        text = text.replace(shown, "")
        hal.write_text(text, encoding="utf-8")


def mount_places():
    """The guest sees the host's files; what LinuxCNC needs in places of its own is in memory."""
    out = os.environ["AXG_VM_OUT"]  # below /tmp, or not
    for words in ("mkdir -p /run/out /run/lock", f"mount --bind {out} /run/out",
                  "mount -t tmpfs -o mode=1777 none /tmp", f"mkdir -p {out}",
                  f"mount --bind /run/out {out}"):
        subprocess.run(words.split(), check=True)
    for name in ("upper", "work"):
        pathlib.Path(f"/tmp/modules-{name}").mkdir()
    modules = "/usr/lib/linuxcnc/modules"
    subprocess.run(["mount", "-t", "overlay", "none", "-o",
                    f"lowerdir={modules},upperdir=/tmp/modules-upper,workdir=/tmp/modules-work",
                    modules], check=True)


def judged(place):
    """Contacts and ramps of the joints, from the record of every servo period."""
    rows, overruns = place.samples()
    expect(not overruns, "every servo period is recorded", overruns)
    rows = rows[next((i for i, row in enumerate(rows) if row[6]), 0):]
    said = contacts_of([row[1:6] for row in rows], [row[10] for row in rows],
                       [row[9] == 2 for row in rows], place.folder / "paper-trunnion.yaml",
                       place.folder, place.folder, BUILD / "axguard", PERIOD_US)
    return said["stops"], stop_facts(rows, STOPPING["paper-trunnion"], PERIOD_US * 1e-6), len(rows)


def run(program, ended, cause, during=None):
    """What LinuxCNC, its guard and the judge say of a program."""
    guard = Guard(mode="stoppable")
    place = BusPlace(FOLDER, SOURCE, BUILD, "paper-trunnion")
    # A guest's servo thread is late whenever its host is: it waits for nobody, but 20 us at most,
    # and with that a late period is no stop (tests/linuxcnc has one of those).
    place.prepare(program, True, 1, limit_s=30)
    guard.wait_for("selftest")
    watcher = threading.Thread(target=during or (lambda _: None), args=(guard,))
    watcher.start()
    said, output = place.run(90)
    watcher.join()
    expect(said.get("homed"), "LinuxCNC did not come up", said, output)
    contacts, ramps, samples = judged(place)
    expect(not contacts, "contact", contacts)  # busy or not
    for ramp in ramps:
        expect(ramp["periods"] <= ramp["promised"] and not ramp["turned"] and
               ramp["from_last_permit"] <= ramp["from_last_permit_promised"], ramp)
    found = said.get("pins", {}).get("axguard-stop.cause")
    if (said["ended"], found) != (ended, cause):  # else the guest was fast enough
        guard.check_busy()
        fail(said, output[-2000:], *guard.lines)
    expect(bool(ramps) == (ended == "stopped"), "ramps", ramps)
    print(json.dumps({"samples": samples, "permits": said["pins"]["axguard-stop.permits"],
                      "stops": ramps}), flush=True)
    return guard


def clean():
    guard = run(SHORT, "done", "0")
    expect(guard.said("an operator arms"), "the button arms by frames", *guard.lines)


def collide():
    guard = run(COLLIDE, "stopped", CAUSE_STOP_FRAME)
    if not guard.said("stopped: verdict"):
        guard.check_busy()
        fail("the collision was not predicted", *guard.lines)


def in_motion(act):
    """Does it when X runs. A guest that stood still is found out afterwards."""
    def watch(guard):
        bus, before = Bus(only=[AXES]), None
        end = time.monotonic() + 60
        while time.monotonic() < end and guard.process.poll() is None:
            time.sleep(0.05)
            try:
                frames = bus.drain()
            except Busy:
                return
            if not frames:
                continue
            x_mm = struct.unpack_from("<i", frames[-1][1], 4)[0] * 1e-4
            if before is not None and abs(x_mm - before) > 3:
                act(guard)
                return
            before = x_mm
    return watch


def killed():
    run(SWING, "stopped", CAUSE_PERMIT_ENDED, in_motion(lambda guard: guard.process.kill()))


def bus_down():
    try:
        run(SWING, "stopped", CAUSE_PERMIT_ENDED,
            in_motion(lambda _: subprocess.run("ip link set vcan0 down".split(), check=True)))
    finally:
        subprocess.run("ip link set vcan0 up".split(), check=True)


if shutil.which("linuxcnc") is None or not (BUILD / "axguard-hal").exists():
    print("skipped: no LinuxCNC, or axguard-hal is not built (apt install linuxcnc-uspace-dev)")
    sys.exit(vm_bus.SKIPPED)
mount_places()
vm_bus.machine_file = lambda *_: MACHINE
MACHINE.write_text(in_guest_time((SOURCE / EXAMPLE).read_text(encoding="utf-8")), encoding="utf-8")
with module(BUILD):
    for scenario in sys.argv[1:]:
        attempt(globals()[scenario])
