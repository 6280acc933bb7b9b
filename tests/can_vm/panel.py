# SPDX-License-Identifier: Apache-2.0
"""A control panel on the bus, with checksums of its own: it arms the guard, resets its stop and
arms it again. What it said is then played back, and does nothing."""
import time

from vm_bus import PERMIT, Board, Bus, Guard, attempt, expect

MESSAGES, STATUS = 0x584, 0x604
RESET, ARM, REQUEST, CONFIRM = 0x96, 0x69, 0x0F, 0xF0
INIT, SELFTEST, READY, ARMED = 1, 2, 3, 4
RUN = 0xA5  # word of a permit


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

    def say(self, action, step, nonce=0):
        data = sealed(MESSAGES, [0x10 | self.counter, action, step, 0,
                                 *nonce.to_bytes(3, "little")])
        self.counter = (self.counter + 1) % 16
        self.said.append(data)
        self.bus.send(MESSAGES, data)

    def wait_for(self, is_so, timeout_s=5.0):
        """The first status that says so, or None; every one is a sealed one of version 1."""
        end = time.monotonic() + timeout_s
        while time.monotonic() < end:
            self.guard.check_busy()
            for identifier, data in self.bus.drain():
                if identifier != STATUS:
                    continue
                expect(sealed(STATUS, data[1:8]) == data[:8] and data[1] >> 4 == 1, data)
                status = {"phase": data[2], "action": data[3], "refusal": data[4],
                          "nonce": int.from_bytes(data[5:8], "little")}
                if is_so(status):
                    return status
            time.sleep(0.005)
        return None

    def act(self, action, wanted):
        """Both of a person's actions, again where the guard refuses."""
        end = time.monotonic() + 10
        while time.monotonic() < end:
            self.bus.drain()
            self.say(action, REQUEST)
            asked = self.wait_for(lambda status: status["action"] == action, 0.3)
            if asked:
                self.say(action, CONFIRM, asked["nonce"])
                if self.wait_for(lambda status: status["phase"] in wanted, 1):
                    return
        expect(False, "refused for 10 s", *self.guard.lines)


def run_permits(bus):
    return sum(identifier == PERMIT and data[0] == RUN for identifier, data in bus.drain())


def panel():
    board = Board("idle.log")
    guard = Guard()
    guard.wait_for(" ready")
    person = Panel(guard)
    expect(person.wait_for(lambda status: status["phase"] == READY), "a status", *guard.lines)
    person.act(ARM, (ARMED,))
    guard.wait_for("an operator arms (584)")
    time.sleep(0.2)
    guard.check_busy()
    expect(run_permits(person.bus) > 10, "permits", *guard.lines)
    begun = list(person.said)

    Bus().send(PERMIT, bytes(8))  # a reason to stop that passes
    guard.wait_for("stopped: second_guard")
    person.act(RESET, (INIT, SELFTEST, READY))
    expect(person.wait_for(lambda status: status["phase"] == READY), *guard.lines)
    person.bus.drain()
    for _ in range(16):  # the counter fits at one of them
        for data in begun:
            person.bus.send(MESSAGES, data)
            time.sleep(0.01)
    time.sleep(0.1)
    guard.check_busy()
    expect(run_permits(person.bus) == 0, "armed by what was played back", *guard.lines)
    person.counter = (begun[-1][1] + 1) % 16
    person.act(ARM, (ARMED,))
    board.end()
    code, report = guard.end()
    expect(report["operator_acts"] == 3, code, report, *guard.lines)
    expect(report["operator_ignored"] + report["operator_refused"] >= 16, report)
    expect(guard.said("rejected: "), *guard.lines)


attempt(panel)
