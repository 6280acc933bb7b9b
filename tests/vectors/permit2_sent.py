# SPDX-License-Identifier: Apache-2.0
"""Scripts of what a board and a control panel send."""

from permit2_frames import NONCE, Script, crc8, crc16, hexed, script, session


def scripts_of_small_frames():
    one = script("small frames", "hashes, SYNC, heartbeat, and a timer of 32 bits")
    one.power_up()
    one.step("hash", part=2, want="0201000011223346").step("hash", part=4, want="")
    one.step("sync", sync=42, want="2A").step("heartbeat", state=127, want="7F")
    one.step("extend", last=100, timer=100, want=100)
    one.step("extend", last=4_294_967_290, timer=5, want=4_294_967_301)
    one.step("extend", last=8_589_934_592, timer=4_294_967_295, want=8_589_934_591)
    one.step("extend", last=5_000_000_100, timer=705_032_794, want=5_000_000_090)  # a capture
    one.step("extend", last=5_000_000_100, timer=2_852_516_451, want=7_147_483_747)
    one.step("extend", last=5_000_000_100, timer=2_852_516_453, want=2_852_516_453)
    one.step("extend", last=3, timer=4_294_967_295, want=4_294_967_295)  # nothing is before 0


def sealed(identifier, body):
    return hexed([crc8(body + [identifier & 255, identifier >> 8]), *body])


def scripts_of_operators():
    one = script("operator frames", "request, nonce of the guard, confirmation; and what is none")
    for action, kind, reads in ((0x96, 0x0F, 1), (0x69, 0xF0, 1), (0x97, 0x0F, 0),
                                (0x69, 0x00, 0), (0x00, 0xF0, 0)):
        one.step("operator", action=action, step=kind, stands=1, counter=17, nonce=0x345678,
                 reads=reads,
                 want=sealed(0x584, [0x11, action, kind, 1, 0x78, 0x56, 0x34]))
    for phase, action, refusal, reads in ((4, 0x96, 0, 1), (0, 0, 6, 1), (5, 0, 0, 0),
                                          (0, 1, 0, 0), (0, 0, 7, 0)):
        one.step("status", phase=phase, action=action, refusal=refusal, counter=2, nonce=0x345678,
                 reads=reads,
                 want=sealed(0x604, [0x12, phase, action, refusal, 0x78, 0x56, 0x34]))


def scripts_of_frames():
    one = script("session", "lap, nonce, and the sample latched last")
    one.power_up().step("session", at=10, want="")
    one.step("session_due", at=10, want=0).arm(50_000).latch(3 * 240 + 14, at=100_000)
    one.step("session_due", at=100_000, want=1)
    one.step("session", at=100_000, want=hexed(session(15, 3, NONCE, 0)))
    one.step("session_due", at=199_999, want=0).step("session_due", at=200_000, want=1)
    one.latch(3 * 240 + 15, at=101_000)
    one.step("session", at=200_000, want=hexed(session(16, 3, NONCE, 1)))
    one.latch(3 * 240 + 16, at=201_000)
    one.step("session", at=201_000, want="1F121103" + "00EEFFC0")
    one.step("session_due", at=201_000, want=0).latch(4 * 240, at=202_000)
    one.step("session_due", at=202_000, want=1)

    one = script("session after a second arming", "at once, with the last latch that is forgotten")
    one.power_up().arm(50_000).latch(3 * 240 + 239)
    at = Script.instant(3 * 240 + 239)
    one.step("session", at=at, want=hexed(session(240, 3, NONCE, 0)))
    one.arm(at + 100, 0x00BEEF).step("session_due", at=at + 100, want=1)
    one.step("session", at=at + 100, want=hexed(session(240, 3, 0x00BEEF, 1)))
    one.permit(3 * 240 + 239, at + 200, want="refused", why="echo")
    one.step("session_due", at=at + 200, want=0)
    one.latch(4 * 240)  # laps go on across arming
    one.step("session_due", at=at + 1000, want=1)
    one.step("session", at=at + 1000, want=hexed(session(1, 4, 0x00BEEF, 2)))
    one.latch(0, at=at + 2000, want=0)  # a lap that begins anew is out of order
    one.step("session_due", at=at + 200_000, want=0).step("session", at=at + 200_000, want="")
    one.latch(4 * 240 + 1, at=at + 200_001).step("session_due", at=at + 200_001, want=1)
    one.step("session", at=at + 200_001, want=hexed(session(2, 4, 0x00BEEF, 3)))

    says = {"mode": 1, "tool": 2, "homed": 1, "spindle": 0, "rapid": 0, "down": 0, "axis": 0}
    counts = [100_000, -50_500, -300_000, 2_712_500, 3_600_001]

    def classical(slots, counter, index):
        frames = []
        for at in range(0, len(slots), 2):
            data = [counter | index << 4, *slots[at], *slots[at + 1]]
            identifier = 0x181 + 0x100 * (at // 2)
            frames.append(hexed([crc8(data + [identifier & 255, identifier >> 8]), *data]))
        return "/".join(frames)

    def slot(value):
        return list((value & 0xFFFFFF).to_bytes(3, "little"))

    one = script("classical axis frames", "five axes, the last one endless")
    one.power_up().step("classical", **says, counts=counts, want="").latch(41)
    slots = [slot(value) for value in counts[:4]] + [slot(1), [1, 2, 0]]
    one.step("classical", **says, counts=counts, want=classical(slots, 0, 41 % 16))
    unknown = [2**31 * -1, 8_388_607, -8_388_607, 0, -1]
    slots = [slot(-2**23), slot(8_388_607), slot(-8_388_607), slot(0), slot(3_599_999),
             [3, 2, 0x43]]
    one.step("classical", **{**says, "mode": 3, "homed": 0, "down": 1, "axis": 4}, counts=unknown,
             want=classical(slots, 1, 41 % 16))
    for index, value in ((0, 8_388_608), (3, -8_388_608)):
        wrong = list(counts)
        wrong[index] = value
        one.step("classical", **says, counts=wrong, want="")
    slots = [slot(value) for value in counts[:4]] + [slot(1), [1, 255, 0]]
    one.step("classical", **{**says, "tool": 255}, counts=counts,
             want=classical(slots, 2, 41 % 16))
    for tool in (256, 258, 65535):  # a byte of 258 is tool 2
        one.step("classical", **{**says, "tool": tool}, counts=counts, want="")

    one = script("flexible axis frames", "five axes in 32 bytes")
    one.power_up().step("fd", **says, counts=counts, want="").latch(41, at=0x1_0000_1234)
    for counter, mode in enumerate((0, 1, 2)):
        flags = 10
        body = [counter, flags]
        for value in counts[:4] + [1]:
            body += list((value & 0xFFFFFFFF).to_bytes(4, "little"))
        body += [0x34, 0x12, 0, 0, 2, 1, mode, 42]
        total = crc16(body + [0x81, 0x01])
        one.step("fd", **{**says, "tool": 0x0102, "mode": mode, "spindle": 1, "rapid": 1},
                 counts=counts, want=hexed([total & 255, total >> 8, *body]))

    one = script("options that are none", "the board remains stopped")
    for changed in ({"period": 0}, {"period": 100_001}, {"n_max": 0}, {"n_max": 16},
                    {"axes": 0}, {"axes": 14}, {"nonce": 0x1000000}):
        one.power_up(**changed, want=0).arm(50_000, want="no_options")
        one.nonce = NONCE
