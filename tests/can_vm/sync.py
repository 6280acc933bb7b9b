# SPDX-License-Identifier: Apache-2.0
"""axguardd as the producer of SYNC (can.sync: guard): drives that number nothing latch on it, each
permit names the sample of a SYNC that was on the bus, and a second producer stops."""
import struct
import threading
import time

from vm_bus import PERIOD_US, PERMIT, STOP, Bus, Guard, attempt, expect

SYNC = 0x080
NODES = (3, 4, 5, 6, 7)
EXTENDED = 1 << 31  # of a socket; a COB-ID marks 29 bits by its bit 29
# X and Y have the same number, of 29 bits and of 11.
STATUS_IDS = {3: 0x184 | EXTENDED, 7: 0x18FF0187 | EXTENDED} | {n: 0x180 + n for n in (4, 5, 6)}
COB_IDS = {node: one & ~EXTENDED | (1 << 29 if one & EXTENDED else 0)
           for node, one in STATUS_IDS.items()}
KEYS = "  sync: guard\n  drives:\n" + "".join(
    f"    {axis}: {{pdos: [{{cob_id: {COB_IDS[node]:#x}, map: [0x60410010, 0x60640020]}}, "
    f"{{cob_id: 0x28{node}, map: [0x606C0020]}}], counts: 10000, per_{unit}: 1, absolute: true, "
    f"velocity: {{counts: 1000, per_{unit}_s: 1}}"
    f"{', range_counts: 3600000' if axis == 'C' else ''}}}\n"
    for node, axis, unit in zip(NODES, "XYZAC", ("mm", "mm", "mm", "deg", "deg")))
# A guest wakes up when its host lets it: nearly a period, and in contact mode no proof needs less.
JITTER = f"  latch_jitter_us: {PERIOD_US - 500}\n"


SESSION = 0x583


def session_frame(lap, sync, counter, nonce=0x5E5510):
    """Of docs/reference/board.md, which the guard needs with permit 2: it counts laps of SYNC."""
    data = bytes([0x10 | counter & 15, sync]) + struct.pack("<HI", lap, nonce)[:5]
    crc = 0xFF
    for byte in data + struct.pack("<H", SESSION):
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (0x2F if crc & 0x80 else 0)) & 0xFF
    return bytes([crc ^ 0xFF]) + data


class Drives:
    """Five drives at rest: they answer SYNC, whoever sends it. What obeys the permit says its
    session beside them."""

    def __init__(self):
        self.bus = Bus()
        self.lap = self.sync = self.sessions = 0
        self.frames = []  # SYNC and permits, in order
        self.is_over = False
        self.thread = threading.Thread(target=self._answer, daemon=True)
        self.thread.start()

    def _answer(self):
        self.bus.socket.settimeout(0.2)
        while not self.is_over:
            try:
                frame = self.bus.socket.recv(72)
            except TimeoutError:
                continue
            identifier, length = struct.unpack_from("=IB", frame)
            if identifier in (SYNC, PERMIT, STOP):
                self.frames.append((identifier, frame[8:8 + length]))
            if identifier == SYNC:
                for node in NODES:
                    self.bus.send(STATUS_IDS[node], struct.pack("<Hi", 0x0237, 0))
                    self.bus.send(0x280 + node, struct.pack("<i", 0))
                # Of others, with a number or low bits of ours: a fault of a drive, if one read it.
                for other in (0x185 | EXTENDED, 0x1CFF0187 | EXTENDED, 0x187):
                    self.bus.send(other, struct.pack("<Hi", 0x0008, 0))
                self._say_session(frame[8])

    def _say_session(self, sync):
        """Every 100 ms, and with each lap."""
        is_lap = sync < self.sync
        self.lap += is_lap
        self.sync = sync
        if is_lap or sync % max(1, 100_000 // PERIOD_US) == 1:
            self.bus.send(SESSION, session_frame(self.lap, sync, self.sessions))
            self.sessions += 1

    def end(self):
        self.is_over = True
        self.thread.join()


def guard_sends_sync():
    drives = Drives()
    try:
        guard = Guard(format_="cia402", can_keys=KEYS, guard_keys=JITTER)
        guard.arm()
        begin = len(drives.frames)
        time.sleep(1)
        guard.check_busy("input")
        frames = drives.frames[begin:]
        counters = [data[0] for identifier, data in frames if identifier == SYNC]
        steps = {(b - a) % 240 for a, b in zip(counters, counters[1:])}
        expect(len(counters) > 0.5e6 / PERIOD_US, "SYNC each period", len(counters))
        expect(steps <= {1, 2, 3}, "its counter numbers the periods", steps)
        heard, permits = [], 0
        for identifier, data in frames:
            if identifier == SYNC:
                heard = (heard + [data[0]])[-10:]
            elif identifier == PERMIT and len(heard) == 10:
                permits += 1
                expect(data[1] in heard, "a permit names a sample that was latched", data[1], heard)
        guard.check_busy("input")  # what it said after the frames
        expect(permits > 0.25e6 / PERIOD_US, "permits flow", permits, *guard.lines)
        expect(all(identifier != STOP for identifier, _ in frames), "no stop", *guard.lines)
        Bus().send(SYNC, b"\x07")
        guard.wait_for("stopped: second_guard")
        guard.end()
        print(f"{len(counters)} SYNC, {permits} permits", flush=True)
    finally:
        drives.end()


attempt(guard_sends_sync)
