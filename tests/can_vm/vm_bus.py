# SPDX-License-Identifier: Apache-2.0
"""What the scripts for the guest share: a raw CAN socket, the guard as a process, a board that
can-utils' canplayer plays. Ids are the default ones (docs/reference/protocol.md)."""
import json
import os
import pathlib
import select
import signal
import socket
import struct
import subprocess
import sys
import threading
import time

BUILD = pathlib.Path(os.environ["AXG_BUILD"])
SOURCE = pathlib.Path(os.environ["AXG_SOURCE"])
PERMIT, TWIN, STOP, EMERGENCY, HEARTBEAT = 0x103, 0x104, 0x001, 0x082, 0x702
# With the word stop a permit's ids permit nothing: here such frames go by names of their own.
WORD_STOP, WORD_STOP_TWIN = "word stop", "its twin"
SKIPPED = 77
LIMIT_S = float(os.environ["AXG_VM_LIMIT_S"])  # boot.py ends the guest then
# A guest's system call takes 15 us: ten periods of 5 ms until the permit runs out. At 1 kHz the
# guest spends longer in calls than a period lasts.
PERIOD_US = int(os.environ.get("AXG_VM_PERIOD_US", "5000"))
# What a guest that stood still looks like from inside: what its clock counts as its own may be
# another's, under a hypervisor. Never what a test is about.
BUSY = ("stopped: gap", "input: stale", "input: heartbeat_lost", "stopped: silence",
        "stopped: flapping", "stopped: engine", "input: loss_limit", "SYNC ended later",
        "input: sync_period")  # a board that stood still sends what it missed closer together


# What a guest cannot be fit in: its clock is not real. Memory and the known answers it can.
UNFIT = ("--admit-seconds", "0.05", "--admit-unfit", "system,latency,engine,cycle")

RUNNING = []  # every board and guard, so that none of them outlives its scenario


class Busy(Exception):
    """The guest stood still: nothing is shown by this attempt."""


def fail(*words):
    print("FAILED:", *words, sep="\n  ", flush=True)
    sys.exit(1)


def expect(is_true, *words):
    if not is_true:
        fail(*words)


def attempt(scenario, *arguments):
    """Runs it until the guest did not stand still, later each time, for a host is busy for seconds;
    skips the whole script when it would end before another attempt could (its clock began with it).
    """
    longest, pause = 0.0, 0.0
    while (began := time.monotonic() + pause) + longest + 10 < LIMIT_S:
        time.sleep(pause)
        subprocess.run("rm -f /run/*.latch", shell=True, check=True)
        try:
            scenario(*arguments)
            print("ok:", scenario.__name__, *arguments, flush=True)
            return
        except Busy as busy:
            print("the guest stood still:", busy, flush=True)
            longest = max(longest, time.monotonic() - began)
            pause = min(2 * pause + 0.5, 15.0)
        finally:
            while RUNNING:
                process = RUNNING.pop()
                process.kill()
                process.wait()
    print("skipped: this machine is too busy for the guest", flush=True)
    sys.exit(SKIPPED)


def name_of(identifier, data):
    """The identifier, but for the word stop."""
    if identifier == PERMIT and data[:1] == b"\x5a":
        return WORD_STOP
    if identifier == TWIN and data[:1] == b"\xa5":
        return WORD_STOP_TWIN
    return identifier


class Bus:
    """A raw socket that sees everything but its own frames, or of that only some identifiers: in
    the guest, Python takes frames more slowly than five drives send them."""

    def __init__(self, name="vcan0", only=()):
        self.socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        if only:
            exactly = 0xC00007FF  # the identifier, and that the frame is a standard data frame
            self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER,
                                   b"".join(struct.pack("=II", each, exactly) for each in only))
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1)
        so_rcvbufforce = 33
        self.socket.setsockopt(socket.SOL_SOCKET, so_rcvbufforce, 1 << 24)
        self.socket.bind((name,))

    def send(self, identifier, data=b""):
        self.socket.send(struct.pack("=IB3x8s", identifier, len(data), data))

    def drain(self):
        """Everything that is there: identifier, or the name of a word stop, and data."""
        frames = []
        end = time.monotonic() + 10
        while select.select([self.socket], [], [], 0)[0]:
            if time.monotonic() > end:
                raise Busy("frames come faster than they are taken")
            frame = self.socket.recv(72)
            identifier, length = struct.unpack_from("=IB", frame)
            data = frame[8:8 + length]
            frames.append((name_of(identifier, data), data))
        return frames

    def count(self, identifier):
        return sum(frame[0] == identifier for frame in self.drain())


class Board:
    """A trace from build/can_vm, played at its own pace."""

    def __init__(self, trace):
        with open(BUILD / "can_vm" / trace) as file:
            self.process = subprocess.Popen(["nice", "-n", "-15", "canplayer", "-g", "1",
                                             "vcan0=can0"], stdin=file, stderr=subprocess.DEVNULL)
        RUNNING.append(self.process)

    def end(self):
        self.process.kill()
        self.process.wait()


def machine_file(format_="classical", has_hashes=False, can_keys="", permit_samples=10,
                 guard_keys=""):
    """The paper's machine with the guest's period. Who plays a trace answers no hashes."""
    path = pathlib.Path(f"/run/machine-{format_}.yaml")
    text = (SOURCE / "config/machines/paper-trunnion.yaml").read_text()
    if format_ == "cia402":  # drives cannot say which axis may jog
        text = "".join(line for line in text.splitlines(True) if "single_jog:" not in line)
    text = text.replace("\nguard:\n", "\nguard:\n" + guard_keys)
    if not has_hashes:
        text = text.replace("hashes: required", "hashes: none")
    # `can` is the last section of the file. In one step: a board may be reading the last one.
    new = path.with_suffix(".new")
    new.write_text(text + f"  format: {format_}\n  sample_us: {PERIOD_US}\n"
                   f"  permit_samples: {permit_samples}\n"
                   f"  stale_after_us: {permit_samples * PERIOD_US}\n{can_keys}"
                   f"deadline_us: {PERIOD_US // 2}\n")
    return new.replace(path)


class Guard:
    """axguardd, and what it says."""

    def __init__(self, *options, format_="classical", mode="contact", is_local=True,
                 has_hashes=False, can_keys="", permit_samples=10, bus="vcan0", admission=UNFIT,
                 guard_keys="", state_dir="/run"):
        self.lines = []
        self.changed = threading.Condition()
        path = machine_file(format_, has_hashes, can_keys, permit_samples, guard_keys)
        self.process = subprocess.Popen(
            [BUILD / "axguardd", "run", path, "--mesh-root", SOURCE / "config/machines",
             "--bus", bus, "--state-dir", state_dir, "--mode", mode, "--engine", "cpu",
             "--json=/run/guard.json", *(["--local-board"] if is_local else []), *admission,
             *options],
            stderr=subprocess.PIPE, text=True)
        RUNNING.append(self.process)
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stderr:
            with self.changed:
                self.lines.append(line.rstrip())
                self.changed.notify_all()
        with self.changed:
            self.lines.append("(ended)")
            self.changed.notify_all()

    def said(self, words):
        return any(words in line for line in self.lines)

    def has_stopped(self):
        """And was not reset since."""
        states = [line for line in self.lines if "stopped: " in line or " ready" in line]
        return bool(states) and "stopped: " in states[-1]

    def check_busy(self, *expected):
        """Raises Busy where the guest stood still, unless that is what is wanted."""
        for words in BUSY:
            if words not in expected and self.said(words):
                lines = list(self.lines)
                self.kill()
                raise Busy(" / ".join(lines[-3:]))

    def wait_for(self, words, *expected, timeout_s=60):
        """Nobody waits for a stop of a guard that has stopped for another reason."""
        end = time.monotonic() + timeout_s
        with self.changed:
            while not self.said(words):
                is_over = (time.monotonic() > end or self.lines[-1:] == ["(ended)"]
                           or words.startswith("stopped: ") and self.has_stopped())
                if is_over:
                    break
                self.changed.wait(0.2)
        if not self.said(words):
            self.check_busy(words, *expected)
            fail(f"the guard did not say {words!r}", *self.lines)

    def arm(self):
        """Permits flow when this returns. A person who is told that the axes do not stand tries
        again."""
        self.wait_for("ready")
        end = time.monotonic() + 10
        while not self.said(" armed") and self.process.poll() is None and time.monotonic() < end:
            self.process.send_signal(signal.SIGUSR1)
            with self.changed:
                self.changed.wait(0.1)
        self.wait_for(" armed")

    def kill(self):
        self.process.kill()
        self.process.wait()

    def ended(self, timeout_s=20):
        """Its exit code, when all that it said has been read."""
        code = self.process.wait(timeout_s)
        self.reader.join(timeout_s)
        return code

    def end(self):
        """The exit code, and the document."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
        code = self.ended()
        with open("/run/guard.json") as file:
            return code, json.load(file)


def reset_only_at_rest(guard, bus, is_moving, rests_at_s):
    """A stopped guard whose machine moves now and rests from `rests_at_s` (time.monotonic) on: no
    reset and a stop each period before, afterwards none, a reset and an arming. The stop frames of
    half a second in motion."""
    bus.drain()
    time.sleep(0.5)
    guard.process.send_signal(signal.SIGUSR2)
    guard.wait_for("rejected: reset: the axes are not yet at rest")
    stops = bus.count(STOP)
    if not is_moving():
        raise Busy("the machine rested before its stops were counted")
    guard.check_busy()
    expect(stops > 50, "one a period while an axis moves", stops)
    time.sleep(max(0.0, rests_at_s - time.monotonic()))
    for _ in range(10):  # a busy host plays the trace late
        bus.drain()
        time.sleep(0.3)
        if bus.count(STOP) == 0:
            break
    else:
        guard.check_busy()
        fail("the axes stand: the stop is confirmed", *guard.lines)
    del guard.lines[:]
    guard.process.send_signal(signal.SIGUSR2)
    guard.wait_for(" ready")
    guard.arm()
    return stops
