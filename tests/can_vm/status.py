# SPDX-License-Identifier: Apache-2.0
"""The status socket of a guard that permits: everyone may read it, root or not, and whoever reads
slowly, not at all, or writes to it, changes nothing for the guard."""
import json
import os
import pathlib
import socket
import stat
import subprocess
import time

from vm_bus import BUILD, PERMIT, SOURCE, Board, Bus, Guard, attempt, expect

FOLDER = pathlib.Path("/run/axguardd")
STATUS = FOLDER / "guard.status"
NOBODY = 65534
READERS = 300


def command(*options, user=None):
    done = subprocess.run([BUILD / "axguardd", "status", "--socket", STATUS, *options], text=True,
                          capture_output=True, user=user)
    return done.returncode, done.stdout, done.stderr


def connected():
    reader = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    reader.connect(str(STATUS))  # waits while the guard's list of waiting readers is full
    reader.settimeout(5)
    return reader


def line():
    with connected() as reader:
        text = b""
        while part := reader.recv(4096):
            text += part
    expect(text.endswith(b"\n") and text.count(b"\n") == 1, text)
    return json.loads(text)


def refuses_what_is_no_socket():
    for make in (lambda: STATUS.write_text("precious"), STATUS.mkdir,
                 lambda: STATUS.symlink_to("/run/elsewhere")):
        make()
        done = subprocess.run([BUILD / "axguardd", "run", SOURCE / "config/machines/paper-trunnion"
                               ".yaml", "--bus", "vcan0", "--state-dir", "/run", "--status-socket",
                               STATUS], text=True, capture_output=True)
        expect(done.returncode == 3 and "not a socket" in done.stderr, done)
        expect(STATUS.is_symlink() or STATUS.is_dir() or STATUS.read_text() == "precious", "gone")
        STATUS.rmdir() if STATUS.is_dir() else STATUS.unlink()


def readers(guard):
    """Many at once: those that read nothing, those that write, and one that reads byte by byte."""
    silent = [connected() for _ in range(READERS)]
    for at, reader in enumerate(silent):
        reader.setblocking(False)
        if at % 2 == 0:
            try:
                reader.send(bytes(1000))
            except OSError:
                pass  # it is closed already
    slow = connected()
    text = b""
    while part := slow.recv(1):
        text += part
    expect_armed(guard, json.loads(text))
    return silent


def expect_armed(guard, said):
    """A guest that stood still may have been stopped a moment ago, and not have said so yet."""
    if said["phase"] != "armed":
        guard.wait_for("stopped: ")
        guard.check_busy()
    expect(said["phase"] == "armed", said)


def status():
    FOLDER.mkdir(mode=0o755, exist_ok=True)
    STATUS.unlink(missing_ok=True)
    refuses_what_is_no_socket()
    stale = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    stale.bind(str(STATUS))
    stale.close()
    expect(command()[0] == 3, command())
    os.umask(0o077)
    board = Board("idle.log")
    guard = Guard("--status-socket", str(STATUS))
    guard.arm()
    expect(stat.S_IMODE(STATUS.stat().st_mode) == 0o666, STATUS.stat())

    said = line()
    expect_armed(guard, said)
    expect(said["machine"] == "paper-trunnion", said)
    expect(said["bus"] == "vcan0" and said["session"] is True and said["stands"] is True, said)
    expect(said["withheld"] == "nothing" and len(said["configuration_sha256"]) == 64, said)
    expect(said["age_ms"] < 1000, said)
    code, text, _ = command("--json", user=NOBODY)
    expect_armed(guard, json.loads(text))
    expect(code == 0, code)
    code, words, fault = command(user=NOBODY)
    guard.check_busy()
    expect(code == 0 and words.startswith("vcan0: armed"), code, words, fault)

    bus, began = Bus(), time.monotonic()
    while time.monotonic() < began + 2:
        for reader in readers(guard):
            reader.close()
    guard.check_busy()
    expect(bus.count(PERMIT) > 200, "permits while it was read", *guard.lines)
    expect(line()["permits"] > said["permits"], said)

    Bus().send(PERMIT, bytes(8))
    guard.wait_for("stopped: second_guard")
    code, words, fault = command(user=NOBODY)
    expect(code == 12 and "stopped: second_guard" in words, code, words, fault)
    board.end()
    expect(guard.end()[0] == 12, *guard.lines)
    expect(not STATUS.exists(), "the socket of a guard that has ended")
    expect(command()[0] == 3, command())


attempt(status)
