# SPDX-License-Identifier: Apache-2.0
"""`axguard drive --bus` plays the board for axguardd on vcan: a clean program runs to its end, a
collision is stopped before it, a guard that is killed leaves a board that brakes by itself. None of
them touches anything on its true path."""
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

from vm_bus import BUILD, BUSY, RUNNING, SOURCE, Bus, Busy, Guard, attempt, expect, machine_file

PERMIT_SAMPLES = 5  # as in approaches.py
SYNC = 0x080
CLEAN, COLLISION, CAN = 0, 10, 12


class Drive:
    """axguard drive --bus, and what it says."""

    count = 0

    def __init__(self, program, *options, bus="vcan0"):
        Drive.count += 1
        self.report = pathlib.Path(f"/run/drive-{Drive.count}.json")
        self.words = pathlib.Path(f"/run/drive-{Drive.count}.txt")
        path = machine_file(has_hashes=True, permit_samples=PERMIT_SAMPLES)
        with open(self.words, "wb") as words:
            self.process = subprocess.Popen(
                [BUILD / "axguard", "drive", path, pathlib.Path(__file__).with_name(program),
                 "--mesh-root", SOURCE / "config/machines", "--bus", bus,
                 f"--json={self.report}", *options], stdout=words, stderr=words)
        RUNNING.append(self.process)

    def wait_for(self, words, timeout_s=20):
        """Until it has said these words."""
        end = time.monotonic() + timeout_s
        while words not in self.words.read_text():
            expect(self.process.poll() is None and time.monotonic() < end,
                   f"drive did not say {words!r}", self.words.read_text())
            time.sleep(0.01)

    def end(self):
        """Exit code, document, words."""
        code = self.process.wait(60)
        document = json.loads(self.report.read_text()) if self.report.exists() else None
        return code, document, self.words.read_text()


def started(program, *options, mode="stoppable"):
    """A board that moves, and its guard."""
    board = Drive(program, *options)
    guard = Guard(mode=mode, has_hashes=True, permit_samples=PERMIT_SAMPLES)
    guard.arm()
    board.wait_for(": moving")
    return board, guard


def expect_no_contact(code, document, words):
    expect(document is not None, code, words)
    expect("contact" not in document and "CONTACT" not in words, document, words)
    expect(document["permits"] > 0, document)
    expect(document["bus"]["interface"] == "vcan0", document, words)
    expect(" periods late, max " in words, words)
    print(f"exit {code}, {document['state']}, {document['samples']} samples, "
          f"{document['permits']} permits, {document['frames_lost']} frames refused, "
          f"{document['bus']['late_periods']} periods late, the latest by "
          f"{document['bus']['late_us_max']} us", flush=True)


def clean():
    """To the end of the program, with a table and a page of it."""
    board, guard = started("clean.ngc", "--csv", "/run/drive.csv", "--report", "/run/drive.html")
    code, document, words = board.end()
    if code != CLEAN:
        guard.check_busy()
    expect(code == CLEAN and document["state"] == "finished", code, document, words, *guard.lines)
    expect_no_contact(code, document, words)
    expect(abs(document["rest"]["A_deg"] + 10) < 0.01, document)
    rows = pathlib.Path("/run/drive.csv").read_text().splitlines()
    expect(rows[0].startswith("sample,board,X_mm") and rows[0].endswith(",permit"), rows[0])
    expect(len(rows) == document["samples"] + 1, len(rows), document)
    expect(any(",moving," in row and row.endswith(",1") for row in rows), rows[-1])
    expect(pathlib.Path("/run/drive.html").stat().st_size > 10000, "no page")
    guard.end()


def crash():
    """The guard stops it, and says why; no contact."""
    board, guard = started("collide.ngc")
    code, document, words = board.end()
    guard_code, report = guard.end()
    if report["cause"] != "verdict":
        guard.check_busy()
    expect(guard_code == 10 and report["reason"] == "predicted", report, *guard.lines)
    expect(code == COLLISION and document["state"] == "stopped", code, document, words)
    expect(document["board_stop"]["why"] == "guard_said_stop", document)
    expect(document["bus"]["emergency"]["code"] == "predicted_collision", document)
    expect_no_contact(code, document, words)


def contact():
    """A guard that judges the sampled pose alone stops too late: the contact is named."""
    board, guard = started("collide.ngc", mode="contact")
    code, document, words = board.end()
    guard_code, report = guard.end()
    if report["cause"] != "verdict":
        guard.check_busy()
    expect(guard_code == 10 and report["reason"] == "contact", report, *guard.lines)
    expect(code == COLLISION and document["state"] == "stopped", code, document, words)
    expect(document["contact"]["pair"] == "cutter-c" and "CONTACT" in words, document, words)
    expect(0 < document["contact"]["after_s"] < document["samples"] * 0.005, document)


def killed():
    """SIGKILL of the guard in motion: the permit runs out, and the board brakes by itself."""
    board, guard = started("collide.ngc")
    time.sleep(0.3)
    guard.check_busy()
    guard.kill()
    code, document, words = board.end()
    expect(code == COLLISION and document["state"] == "stopped", code, document, words)
    stop = document["board_stop"]
    expect(stop["why"] == "permit_ran_out", document)
    held_us = stop["asked_us"] - stop["certified_us"]
    expect(held_us == PERMIT_SAMPLES * 5000 or "AXG_VM_PERIOD_US" in os.environ, document)
    expect_no_contact(code, document, words)


def interrupted():
    """Ctrl-C: in motion the board brakes, and reports; before it, there is nothing to stop."""
    board, guard = started("collide.ngc")
    time.sleep(0.3)
    guard.check_busy()
    board.process.send_signal(signal.SIGINT)
    code, document, words = board.end()
    guard.kill()
    expect(code == COLLISION and document["state"] == "stopped", code, document, words)
    expect(document["board_stop"]["why"] == "person_said_stop", document)
    expect_no_contact(code, document, words)
    board = Drive("clean.ngc")
    board.wait_for("waits for a permit")
    board.process.send_signal(signal.SIGTERM)
    code, document, words = board.end()
    expect(code == COLLISION and document["state"] == "waiting", code, document, words)


def guard_first():
    """A guard that was stopped before is reset while the board waits, and then permits."""
    board, guard = started("clean.ngc")
    time.sleep(0.1)
    board.process.kill()
    guard.wait_for("stopped", "input: stale", "input: heartbeat_lost", "stopped: silence")
    board = Drive("clean.ngc")
    board.wait_for("waits for a permit")
    for _ in range(50):
        guard.process.send_signal(signal.SIGUSR2)
        time.sleep(0.1)
        if sum("ready" in line for line in guard.lines) >= 2:
            break
    guard.process.send_signal(signal.SIGUSR1)
    code, document, words = board.end()
    after = [line for line in guard.lines if " ready" in line or " stopped" in line][2:]
    if code != CLEAN and any(words in line for line in after for words in BUSY):
        raise Busy(" / ".join(after))  # the guest stood still after the reset
    expect(code == CLEAN and document["state"] == "finished", code, document, words, *guard.lines)
    expect_no_contact(code, document, words)
    guard.kill()


def no_interface():
    """What is missing is named, and what to do."""
    code, _, words = Drive("clean.ngc", bus="vcan7").end()
    expect(code == CAN and "vcan7: no such interface" in words and "ip link" in words, code, words)
    subprocess.run(["ip", "link", "set", "vcan0", "down"], check=True)
    code, _, words = Drive("clean.ngc").end()
    subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)
    expect(code == CAN and "ip link set vcan0 up" in words, code, words)


def interface_lost():
    """Down in motion: no permit comes any more, the board brakes, and says what it lost."""
    board, guard = started("collide.ngc")
    time.sleep(0.3)
    guard.check_busy()
    subprocess.run(["ip", "link", "set", "vcan0", "down"], check=True)
    code, document, words = board.end()
    subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)
    expect(code == CAN and document["state"] == "stopped", code, document, words)
    expect(document["bus"]["lost"] and document["frames_lost"] > 0, document)
    expect_no_contact(code, document, words)
    guard.kill()


def two_boards():
    """A second board says nothing."""
    first = Drive("clean.ngc")
    bus = Bus()
    first.wait_for("waits for a permit")
    time.sleep(0.5)
    code, document, words = Drive("clean.ngc").end()
    expect(code == CAN and "another sender" in words, code, words)
    expect(document["samples"] == 0, document)
    first.process.send_signal(signal.SIGINT)
    _, document, _ = first.end()
    expect(abs(bus.count(SYNC) - document["samples"]) == 0, document)


for name in sys.argv[1:]:
    attempt({"clean": clean, "crash": crash, "contact": contact, "killed": killed,
             "interrupted": interrupted, "guard_first": guard_first, "no_interface": no_interface,
             "interface_lost": interface_lost, "two_boards": two_boards}[name])
