# SPDX-License-Identifier: Apache-2.0
"""`axguard watch` beside a guard: it shows what happens, nothing that it or a browser does reaches
the bus or the guard, and it survives a guard and an interface that go and come back."""
import json
import pathlib
import signal
import socket
import subprocess
import threading
import time
import urllib.error
import urllib.request

from vm_bus import (BUILD, PERMIT, RUNNING, SOURCE, Board, Bus, Busy, Guard, attempt, expect,
                    machine_file)

STATUS = pathlib.Path("/run/watch.status")
NOBODY = 65534


class Watch:
    """The process, and what it serves. As a user without rights: a display needs none."""

    def __init__(self, *options):
        self.process = subprocess.Popen(
            [BUILD / "axguard", "watch", machine_file(), "--mesh-root",
             SOURCE / "config/machines", "--listen", "127.0.0.1:0", *options],
            stderr=subprocess.PIPE, text=True, user=NOBODY)
        RUNNING.append(self.process)
        line = self.process.stderr.readline()
        expect(" at http://127.0.0.1:" in line, line, self.process.poll())
        self.url = line.split(" at ")[1].split(";")[0]
        threading.Thread(target=self.process.stderr.read, daemon=True).start()

    def state(self):
        end = time.monotonic() + 10
        while True:
            try:
                with urllib.request.urlopen(self.url + "state", timeout=10) as reply:
                    return json.load(reply)
            except urllib.error.HTTPError as error:  # before the first event
                expect(error.code == 503 and time.monotonic() < end, error.code)
                time.sleep(0.05)

    def wait_for(self, is_so, guard=None, timeout_s=20):
        end = time.monotonic() + timeout_s
        state = {}
        while time.monotonic() < end:
            state = self.state()
            if is_so(state):
                return state
            if guard:
                guard.check_busy()
            time.sleep(0.1)
        raise Busy(f"the page did not come to it: {state}")

    def provoke(self):
        """Everything that a browser may try."""
        for method in ("POST", "PUT", "DELETE", "PATCH", "OPTIONS"):
            request = urllib.request.Request(self.url + "arm", data=b"arm", method=method)
            try:
                urllib.request.urlopen(request, timeout=10)
                expect(False, method, "was taken")
            except urllib.error.HTTPError as error:
                expect(error.code == 405, method, error.code)
        for path in ("arm", "reset?nonce=1", "../run/watch.status"):
            try:
                urllib.request.urlopen(self.url + path, timeout=10)
                expect(False, path, "was given")
            except urllib.error.HTTPError as error:
                expect(error.code == 404, path, error.code)

    def end(self):
        self.process.send_signal(signal.SIGINT)
        code = self.process.wait(20)
        expect(code == 0, "exit code", code)


def sends_nothing():
    """Of a bus with one sender every frame is known: what candump sees is what was sent."""
    dump = subprocess.Popen(["candump", "-L", "vcan0"], stdout=subprocess.PIPE, text=True)
    RUNNING.append(dump)
    lines = []
    reader = threading.Thread(target=lambda: lines.extend(dump.stdout), daemon=True)
    reader.start()
    watch = Watch("--bus", "vcan0")
    sender = Bus()
    sent = 0
    end = time.monotonic() + 3
    while time.monotonic() < end:
        for identifier, data in ((0x702, b"\x05"), (PERMIT, bytes(8)), (0x584, bytes(8)),
                                 (0x181, bytes(8)), (0x080, b"\x01"), (0x001, b"")):
            sender.send(identifier, data)
            sent += 1
        time.sleep(0.01)
    state = watch.wait_for(lambda state: state["bus"]["frames"] >= sent)
    expect(state["bus"]["bad"] > 100, state["bus"])
    watch.provoke()
    time.sleep(1)
    watch.end()
    time.sleep(0.5)
    dump.terminate()
    reader.join(10)
    print(f"{sent} frames sent by the test, {len(lines)} seen by candump", flush=True)
    if len(lines) < sent:
        raise Busy("candump lost frames")
    expect(len(lines) == sent, "candump saw", len(lines), "of", sent)


def watch_a_guard():
    STATUS.unlink(missing_ok=True)
    board = Board("idle.log")
    watch = Watch("--bus", "vcan0", "--socket", str(STATUS))
    expect(watch.state()["kind"] == "unreachable", watch.state())
    guard = Guard("--status-socket", str(STATUS))
    watch.wait_for(lambda state: state["kind"] in ("init", "selftest", "ready"), guard)
    guard.arm()
    armed = watch.wait_for(lambda state: state["kind"] == "armed" and state["permit"] and
                           state["permit"]["answer"] == "right" and state["axes"], guard)
    guard.check_busy()
    expect(armed["guard"]["same_machine"] and armed["guard"]["machine"] == "paper-trunnion", armed)
    expect(armed["permit"]["word"] in ("run", "slow") and armed["bus"]["bad"] == 0, armed)
    bus = Bus(only=(PERMIT,))
    for _ in range(3):
        watch.provoke()
    time.sleep(0.1)
    guard.check_busy()
    expect(bus.count(PERMIT) > 10, "permits while it is watched", *guard.lines)
    expect(not guard.has_stopped(), *guard.lines)

    Bus().send(PERMIT, bytes(8))
    guard.wait_for("stopped: second_guard")
    stopped = watch.wait_for(lambda state: state["kind"] == "stopped")
    expect(stopped["headline"] == "STOP: second_guard", stopped)
    code, report = guard.end()
    expect(code == 12 and report["operator_acts"] == 0, code, report)
    expect(report["operator_refused"] == 0 and report["operator_ignored"] == 0, report)
    gone = watch.wait_for(lambda state: state["kind"] == "unreachable")
    expect(any("no guard" in note for note in gone["notes"]), gone)

    subprocess.run(["ip", "link", "set", "vcan0", "down"], check=True)
    watch.wait_for(lambda state: not state["bus"]["is_open"])
    subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)
    back = watch.wait_for(lambda state: state["bus"]["is_open"])
    expect(back["kind"] == "unreachable", back)
    board.end()
    watch.end()


def refuses():
    """What cannot be watched ends with words."""
    def code_of(*options):
        done = subprocess.run([BUILD / "axguard", "watch", machine_file(), "--mesh-root",
                               SOURCE / "config/machines", *options], text=True,
                              capture_output=True, timeout=60)
        return done.returncode, done.stderr
    taken = socket.create_server(("127.0.0.1", 0))
    port = taken.getsockname()[1]
    code, words = code_of("--bus", "vcan0", "--listen", f"127.0.0.1:{port}")
    expect(code == 2 and "is in use" in words, code, words)
    code, words = code_of("--bus", "can9")
    expect(code == 12 and "no such interface" in words, code, words)
    code, words = code_of()
    expect(code == 2 and "missing option" in words, code, words)


attempt(sends_nothing)
attempt(watch_a_guard)
attempt(refuses)
