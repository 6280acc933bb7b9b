# SPDX-License-Identifier: Apache-2.0
"""A control panel on the bus, with checksums of its own: it arms the guard, resets its stop and
arms it again. What it said is then played back, and does nothing."""
import time

from vm_bus import PERMIT, Board, Bus, Guard, attempt, expect

MESSAGES, STATUS = 0x584, 0x604
RESET, ARM, REQUEST, CONFIRM = 0x96, 0x69, 0x0F, 0xF0
STOPPED, READY, ARMED = 0, 3, 4


def crc8(data):
    """CRC-8H2F: polynomial 0x2F, start and final XOR 0xFF."""
    value = 0xFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = (value << 1 ^ 0x2F if value & 0x80 else value << 1) & 0xFF
    return value ^ 0xFF


def sealed(identifier, body):
    return bytes([crc8([*body, identifier & 255, identifier >> 8]), *body])


class Panel:
    def __init__(self, guard):
        self.guard, self.bus, self.counter, self.said = guard, Bus(), 0, []
        self.status = None

    def say(self, action, step, nonce=0):
        data = sealed(MESSAGES, [0x10 | self.counter, action, step, 0,
                                 *nonce.to_bytes(3, "little")])
        self.counter = (self.counter + 1) % 16
        self.said.append(data)
        self.bus.send(MESSAGES, data)

    def wait_for(self, is_so, timeout_s=5):
        """Until a status says so; every status on the way is a sealed one of version 1."""
        end = time.monotonic() + timeout_s
        while self.status is None or not is_so(self.status):
            self.guard.check_busy()
            expect(time.monotonic() < end, "no such status", self.status, *self.guard.lines)
            time.sleep(0.005)
            for identifier, data in self.bus.drain():
                if identifier == STATUS:
                    expect(sealed(STATUS, data[1:8]) == data[:8] and data[1] >> 4 == 1, data)
                    self.status = {"phase": data[2], "action": data[3], "refusal": data[4],
                                   "nonce": int.from_bytes(data[5:8], "little")}
        return self.status

    def act(self, action, wanted):
        """Both of a person's actions, again while the guard says why not."""
        end = time.monotonic() + 10
        while time.monotonic() < end:
            self.status = None
            self.say(action, REQUEST)
            status = self.wait_for(lambda status: status["action"] == action or status["refusal"])
            if status["action"] == action:
                self.say(action, CONFIRM, status["nonce"])
                self.status = None
                self.wait_for(lambda status: status["phase"] in wanted)
                return
            time.sleep(0.1)
        expect(False, "refused for 10 s", self.status, *self.guard.lines)


def panel():
    board = Board("idle.log")
    guard = Guard()
    guard.wait_for(" ready")
    person = Panel(guard)
    person.wait_for(lambda status: status["phase"] == READY)
    person.act(ARM, (ARMED,))
    guard.wait_for("an operator arms")
    time.sleep(0.2)
    guard.check_busy()
    expect(person.bus.count(PERMIT) > 10, "permits", *guard.lines)
    begun = list(person.said)

    Bus().send(PERMIT, bytes(8))  # a reason to stop that passes
    guard.wait_for("stopped: second_guard")
    person.act(RESET, (1, 2, READY))
    person.status = None
    person.wait_for(lambda status: status["phase"] == READY)
    for _ in range(16):  # the counter fits at one of them
        for data in begun:
            person.bus.send(MESSAGES, data)
            time.sleep(0.01)
    guard.check_busy()
    person.status = None
    person.wait_for(lambda status: status["phase"] == READY)
    expect(person.bus.count(PERMIT) == 0, "armed by what was played back", *guard.lines)
    person.counter = (begun[-1][1] + 1) % 16
    person.act(ARM, (ARMED,))
    board.end()
    code, report = guard.end()
    expect(report["operator_acts"] == 3, code, report, *guard.lines)
    expect(report["operator_ignored"] + report["operator_refused"] >= 16, report)
    expect(guard.said("refused: "), *guard.lines)


attempt(panel)
