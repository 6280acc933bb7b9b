# SPDX-License-Identifier: Apache-2.0
"""axguardd as a service: what it says to systemd, which sockets it has, what the metrics count."""
import os
import pathlib
import re
import signal
import socket
import time

from vm_bus import Board, Guard, attempt, expect

NOTIFY = "/run/notify"
METRICS = pathlib.Path("/run/guard.prom")


def open_manager():
    pathlib.Path(NOTIFY).unlink(missing_ok=True)
    manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
    manager.bind(NOTIFY)
    manager.setblocking(False)
    return manager


def heard(manager):
    words = []
    while True:
        try:
            words.append(manager.recv(512).decode())
        except BlockingIOError:
            return words


def sockets_of(pid):
    """How many of each kind the process has; what no table lists is the CAN socket."""
    kinds = {}
    for table in ("unix", "tcp", "tcp6", "udp", "udp6", "raw", "raw6", "packet", "netlink"):
        path = pathlib.Path(f"/proc/{pid}/net/{table}")
        for word in path.read_text().split() if path.exists() else ():
            kinds.setdefault(word, table)
    counts = {}
    for name in os.listdir(f"/proc/{pid}/fd"):
        found = re.match(r"socket:\[(\d+)\]", os.readlink(f"/proc/{pid}/fd/{name}"))
        if found:
            kind = kinds.get(found.group(1), "can")
            counts[kind] = counts.get(kind, 0) + 1
    return counts


def metric(name):
    found = re.search(rf"^axguard_{name}(?:{{[^}}]*}})? (\d+)$", METRICS.read_text(), re.M)
    expect(found is not None, f"no metric {name}", METRICS.read_text())
    return int(found.group(1))


def service():
    manager = open_manager()
    os.environ.update(NOTIFY_SOCKET=NOTIFY, WATCHDOG_USEC="1000000")
    board = Board("idle.log")
    guard = Guard("--metrics", str(METRICS))
    guard.arm()
    time.sleep(2.5)
    guard.check_busy()
    words = heard(manager)
    expect(words.count("READY=1") == 1, words)
    expect(words.index("READY=1") < words.index("WATCHDOG=1"), words)
    expect(5 <= words.count("WATCHDOG=1") <= 20, words)
    expect(any(word.startswith("STATUS=armed") for word in words), words)

    expect(sockets_of(guard.process.pid) == {"can": 1, "unix": 1},
           "the bus and the manager; nothing that listens", sockets_of(guard.process.pid))

    first = metric("permits_total")
    expect(first > 0 and metric("echoes_total") >= 2 * first - 2, METRICS.read_text())
    expect('phase="armed"} 1' in METRICS.read_text(), METRICS.read_text())
    time.sleep(2)
    expect(metric("permits_total") > first, "written once a second", METRICS.read_text())

    guard.process.send_signal(signal.SIGSTOP)
    time.sleep(0.05)
    heard(manager)
    time.sleep(1)
    expect(heard(manager) == [], "fed while it stood still")
    guard.process.send_signal(signal.SIGCONT)
    guard.wait_for("stopped: gap", "input: stale", "input: heartbeat_lost")
    time.sleep(0.5)
    words = heard(manager)
    expect(any(word.startswith("STATUS=stopped: gap") for word in words), words)
    expect("WATCHDOG=1" in words, "a stop is no reason to be ended", words)
    board.end()
    expect(guard.end()[0] == 11, *guard.lines)
    expect(heard(manager)[-1].startswith("ST"), "STOPPING, and what was left to say")
    expect(not METRICS.exists(), "metrics of a guard that has ended")


attempt(service)
