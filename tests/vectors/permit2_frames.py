# SPDX-License-Identifier: Apache-2.0
"""Frames of permit version 2 and scripts of a board, written out by hand from
docs/reference/board.md, with checksums of their own."""

RUN, SLOW, JOG, STOP = 0xA5, 0xC3, 0x3C, 0x5A
NONCE = 0xC0FFEE
T = 1000  # us


def crc(data, polynomial, bits, start, end):
    """Bit by bit, as the definition says."""
    value, top, mask = start, 1 << (bits - 1), (1 << bits) - 1
    for byte in data:
        value ^= byte << (bits - 8)
        for _ in range(8):
            value = ((value << 1) ^ (polynomial if value & top else 0)) & mask
    return value ^ end


def crc16(data):
    return crc(data, 0x1021, 16, 0xFFFF, 0)


def crc8(data):
    return crc(data, 0x2F, 8, 0xFF, 0xFF)


def hexed(data):
    return bytes(data).hex().upper()


def permit(word, echo, live, cap, mask, n, nonce, lap, level=0, answer=0xC5A3):
    data = [word, echo, live, 0, 0, cap, mask, n << 4 | level]
    context = list(nonce.to_bytes(3, "little") + lap.to_bytes(2, "little"))
    answer ^= crc16(data[:3] + data[5:] + context)
    data[3], data[4] = answer & 255, answer >> 8
    return data


def twin_of(data):
    return [byte ^ 255 for byte in data]


def session(sync, lap, nonce, counter):
    data = [counter & 15 | 0x10, sync, *lap.to_bytes(2, "little"), *nonce.to_bytes(3, "little")]
    return [crc8(data + [0x83, 0x05]), *data]


class Script:
    """Steps of one board. What is wanted stands in each step."""

    def __init__(self, name, why):
        self.name, self.why, self.steps = name, why, []
        self.nonce, self.live, self.number, self.at = NONCE, 0, -1, 0

    def step(self, do, **values):
        self.steps.append({"do": do, **values})
        return self

    def power_up(self, **changed):
        options = {"at": 0, "nonce": 0x123456, "period": T, "n_max": 15, "axes": 5, "caps": 0,
                   "hashes": 0, "jitter": 20, "reaction": 2000, "endless": 16, "want": 1}
        return self.step("power_up", **{**options, **changed})

    def arm(self, at, nonce=NONCE, want="done"):
        if want == "done":
            self.nonce = nonce
        return self.step("arm", at=at, nonce=nonce, want=want)

    def latch(self, number, at=None, want=1):
        """Sample `number` of all laps, by default at its place of the grid."""
        at = self.instant(number) if at is None else at
        return self.step("latch", at=at, sync=number % 240 + 1, lap=number // 240 % 65536,
                         want=want)

    @staticmethod
    def instant(number):
        return 100_000 + number * T

    def permit(self, number, at, n=10, word=RUN, cap=250, mask=0, live=None, want="permit",
               why="nothing", nonce=None, lap=None, level=0, answer=0xC5A3, twin_at=None,
               echo=None):
        """A pair for sample `number`; the second frame 10 us after the first."""
        self.live = (self.live + 1) % 256 if live is None else live
        data = permit(word, number % 240 + 1 if echo is None else echo, self.live, cap, mask, n,
                      self.nonce if nonce is None else nonce,
                      number // 240 % 65536 if lap is None else lap, level, answer)
        return self.pair(data, at, want, why, twin_at)

    def pair(self, data, at, want="permit", why="nothing", twin_at=None):
        self.frame(0x103, data, at, "plain")
        return self.frame(0x104, twin_of(data), at + 10 if twin_at is None else twin_at, want,
                          why)

    def frame(self, identifier, data, at, want, why="nothing", fd=0):
        return self.step("frame", at=at, id=identifier, fd=fd, data=hexed(data), want=want,
                         why=why)

    def may_move(self, at, end=0, word=RUN):
        """end 0: it may not."""
        return self.step("may_move", at=at, end=end, word=word if end else 0)

    def moves(self, at, moves=1, phase="armed"):
        return self.step("moves", at=at, moves=moves, phase=phase)

    def begin(self, first=0, n=10, **changed):
        """Armed, four samples with their permits, and in motion; the last is first + 3."""
        self.power_up(**changed).arm(50_000)
        for number in range(first, first + 4):
            self.latch(number)
            is_first = number == first
            self.permit(number, self.instant(number) + 400, n=n,
                        want="refused" if is_first else "permit",
                        why="live" if is_first else "nothing")
        end = self.instant(first + 3) + n * T
        return self.may_move(self.instant(first + 3) + 500, end).moves(
            self.instant(first + 3) + 500)


def script(name, why):
    made = Script(name, why)
    SCRIPTS.append(made)
    return made


SCRIPTS = []
