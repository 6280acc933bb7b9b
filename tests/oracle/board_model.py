# SPDX-License-Identifier: Apache-2.0
"""What a board must make of the permit, written from docs/reference/board.md as the rules state it:
all permits in a list, all bounds in a history, and nothing that is thrown away before it has to be.
It knows no code of axguard; it is slow, and it is meant to be read beside the page."""

WORDS = {0xA5, 0xC3, 0x3C, 0x5A}
JOG, STOP = 0x3C, 0x5A
NUMBERS = 65536 * 240
GROUPS = range(8)


def crc16(data):
    value = 0xFFFF
    for byte in data:
        for bit in range(7, -1, -1):
            turn = (value >> 15 ^ byte >> bit) & 1
            value = value << 1 & 0xFFFF ^ (0x1021 if turn else 0)
    return value


class Refused(Exception):
    pass


class Board:
    def __init__(self, step):
        self.good = (0 < step["period"] <= 100_000 and 1 <= step["n_max"] <= 15 and
                     1 <= step["axes"] <= 13 and step["nonce"] < 1 << 24)
        self.period, self.n_max = step["period"], step["n_max"]
        self.axes = step["axes"]
        self.has_caps, self.asks_hashes = bool(step["caps"]), bool(step["hashes"])
        self.horizon = (101 * self.n_max * self.period + 99) // 100 + step["jitter"] + \
            step["reaction"]
        self.now, self.nonce = step["at"], step["nonce"]
        self.armed, self.cause, self.jogging = False, "power_up", False
        self.moves, self.moved, self.rests_since = False, False, step["at"]
        self.plain, self.live = None, None
        self.told = None  # the permit that the last sample named
        self.bounds = [[0 if self.has_caps else 250] * 8]  # every u there ever was
        self.changed_at = 0
        self.samples, self.newest = {}, None
        self.reference = None  # what the next number and stamp have to be after
        self.permits, self.ordered, self.named = [], None, None
        self.row, self.admitted = 0, False
        self.hashes, self.tool = set(), None
        self.counts = {}
        self.forgotten = 0
        self.forget()

    # --- the parts that every rule needs

    def forget(self):
        self.plain, self.permits, self.ordered, self.named = None, [], None, None
        self.samples = {}
        self.used, self.last_named = None, 0
        self.forgotten, self.row = self.now, 0

    def halt(self, cause):
        if self.armed:
            self.armed, self.cause = False, cause
        for one in self.permits:
            one["over"] = True
        self.cancel()

    def cancel(self):
        if self.tool is not None:
            self.tool = "cancelled"

    def end(self):
        ends = [one["end"] for one in self.permits if one["counts"] and not one["over"]]
        return max(ends, default=None)

    def see(self, now):
        self.now = max(self.now, now)
        end = self.end()
        if end is not None and end <= self.now:
            for one in self.permits:
                one["over"] = True
            self.cancel()
            if self.moves:
                self.halt("permit_ended")

    def highest(self, sample):
        if sample["unknown"]:
            return [250] * 8
        return [max(bound[i] for bound in self.bounds[sample["bound"]:]) for i in GROUPS]

    # --- steps, each returns what has to happen

    def arm(self, at, nonce):
        self.see(at)
        if not self.good:
            return "no_options"
        if self.moves:
            return "moves"
        if self.now - self.rests_since < 16 * max(1000, self.period):
            return "rest"
        if nonce >= 1 << 24:
            return "nonce"
        if crc16(nonce.to_bytes(3, "little")) == crc16(self.nonce.to_bytes(3, "little")):
            return "nonce_again"
        self.forget()
        self.nonce, self.armed, self.live, self.reference = nonce, True, None, None
        self.admitted, self.moved, self.tool = False, False, None
        if self.has_caps:
            self.bounds.append([0] * 8)
            self.changed_at = self.now
        return "done"

    def latch(self, at, sync, lap):
        """A stamp is no time of a call, and not seen as one."""
        number = lap * 240 + sync - 1
        good = 1 <= sync <= 240
        if good and self.reference is not None:
            ahead = (number - self.reference["number"]) % NUMBERS
            good = 1 <= ahead < NUMBERS // 2 and at > self.reference["at"]
        if not good:
            self.forget()
            self.newest = None
            if self.moves:
                self.halt("latch_order")
            return 0
        ack = self.named if self.has_caps else None
        if (ack is not None and ack is not self.told and
                (number - ack["sample"]["number"]) % NUMBERS >= 16):
            ack = None  # (i): its low bits would pass for a newer one's
        self.told = ack
        if ack is not None:  # (i): never an older one than before
            assert ack["order"] >= self.last_named
            assert all(self.bounds[-1][i] <= ack["caps"][i] for i in GROUPS)
            self.last_named = ack["order"]
        self.newest = {"number": number, "at": at, "lap": lap, "sync": sync, "ack": ack,
                       "bound": len(self.bounds) - 1, "unknown": at < self.changed_at}
        self.reference = self.newest
        if at >= self.forgotten:
            self.samples[number] = self.newest
        else:
            self.samples.pop(number, None)
        if self.tool == "wanted":
            self.tool = at
        return 1

    def frame(self, at, identifier, fd, data):
        """What was heard, and why it was refused."""
        self.see(at)
        data = list(bytes.fromhex(data))
        try:
            if identifier == 0x001:
                self.halt("stop_frame")
                return "stop", "nothing"
            if identifier == 0x103:
                return self.on_plain(fd, data), "nothing"
            if identifier == 0x104:
                return self.on_twin(fd, data), "nothing"
            if identifier == 0x602 and self.asks_hashes:
                return self.on_hash(fd, data), "nothing"
        except Refused as refused:
            why = str(refused)
            self.counts[why] = self.counts.get(why, 0) + 1
            self.row = 0
            return "refused", why
        return "nothing", "nothing"

    def on_hash(self, fd, data):
        if fd or len(data) != 8 or data[0] > 3 or data[1:4] != [1, 0, 0]:
            raise Refused("shape")
        if data[4:] == [0x11, 0x22, 0x33, 0x44 + data[0]]:
            self.hashes.add(data[0])
            return "hash"
        self.hashes.discard(data[0])
        if self.moves:
            self.halt("hash_differs")
        return "hash_differs"

    def on_plain(self, fd, data):
        before, self.plain = self.plain, None
        if fd or len(data) != 8:
            raise Refused("shape")
        self.plain = (self.now, data)
        if before is not None:
            raise Refused("twin_missing")
        return "plain"

    def on_twin(self, fd, data):
        before, self.plain = self.plain, None
        if fd or len(data) != 8:
            raise Refused("shape")
        if before is None:
            raise Refused("twin_alone")
        if self.now - before[0] > self.period:
            raise Refused("twin_late")
        if [byte ^ 255 for byte in data] != before[1]:
            raise Refused("twin_differs")
        return self.on_pair(before[1])

    def is_right(self, data, sample):
        seen = bytes(data[:3] + data[5:]) + self.nonce.to_bytes(3, "little") + \
            sample["lap"].to_bytes(2, "little")
        return crc16(seen) ^ 0xC5A3 == data[3] | data[4] << 8

    def on_pair(self, data):
        word, echo, live, cap, mask, n, level = (*data[:3], *data[5:7], data[7] >> 4,
                                                 data[7] & 15)
        if word not in WORDS:
            raise Refused("word")
        if not self.armed:
            raise Refused("stopped")
        sample = None
        if self.newest is not None and 1 <= echo <= 240:
            age = (self.newest["sync"] - echo) % 240
            if age < 16:
                sample = self.samples.get((self.newest["number"] - age) % NUMBERS)
            if sample is not None and sample["at"] > self.now:
                sample = None
        if word == STOP:
            if sample is not None and self.is_right(data, sample):
                self.live = live
            if not self.moved:
                return "not_yet"
            self.halt("stop_word")
            return "stop"
        if sample is None:
            raise Refused("echo")
        if not self.is_right(data, sample):
            raise Refused("answer")
        before, self.live = self.live, live
        if before is None or not 1 <= (live - before) % 256 <= 15:
            raise Refused("live")
        if word != JOG and cap > 250 or level > 3:
            raise Refused("value")
        if not 1 <= n <= self.n_max:
            raise Refused("samples")
        if self.used is not None and (sample["number"] - self.used) % NUMBERS > NUMBERS // 2:
            raise Refused("old_echo")
        end = sample["at"] + n * self.period
        if end <= self.now:
            raise Refused("late")
        if (word == JOG) != self.jogging:
            raise Refused("jog")
        return self.use(sample, word, live, cap, mask, end)

    def use(self, sample, word, live, cap, mask, end):
        caps = [250 if word == JOG or not mask >> i & 1 else cap for i in GROUPS]
        acked = [250] * 8 if sample["ack"] is None else sample["ack"]["caps"]
        permit = {"end": end, "caps": caps, "word": word, "live": live, "over": False,
                  "proven": [max(acked[i], caps[i]) for i in GROUPS],
                  "order": len(self.permits), "sample": sample}
        highest = self.highest(sample)
        permit["counts"] = not self.has_caps or all(highest[i] <= permit["proven"][i]
                                                    for i in GROUPS)
        self.used, self.ordered = sample["number"], permit
        self.name_newest()
        self.permits.append(permit)
        if not permit["counts"]:
            raise Refused("cap")
        self.row += 1
        self.admitted = self.admitted or self.row >= 3
        return "permit"

    def name_newest(self):
        if self.ordered and all(self.bounds[-1][i] <= self.ordered["caps"][i] for i in GROUPS):
            self.named = self.ordered

    def may_move(self, at):
        """E, or 0; and the word."""
        self.see(at)
        end = self.end()
        agreed = not self.asks_hashes or len(self.hashes) == 4
        if not (self.armed and end is not None and self.admitted and agreed):
            return 0, 0
        # The theorem: since the latch of a permit that E stands on, no axis was faster than its V.
        assert not self.has_caps or any(
            one["end"] == end and not one["over"] and one["counts"] and
            all(self.highest(one["sample"])[i] <= one["proven"][i] for i in GROUPS)
            for one in self.permits)
        return end, [one for one in self.permits if one["counts"]][-1]["word"]

    def set_moves(self, at, moves):
        may = self.may_move(at)[0] != 0
        if moves and not self.moves:
            if may:
                self.moved = True
            else:
                self.halt("not_permitted")
        if self.moves and not moves:
            self.rests_since = self.now
        self.moves = bool(moves)

    def keeps(self, at, wanted):
        self.see(at)
        if not self.has_caps:
            return [250] * 8
        wanted = [wanted[i] if i < self.axes else 0 for i in GROUPS]
        bound = [min(wanted[i], self.bounds[-1][i]) for i in GROUPS]
        if bound != self.bounds[-1]:
            self.changed_at = self.now
        self.bounds.append(bound)
        counted = [one for one in self.permits if one["counts"]]
        last = counted[-1] if counted else None
        if (self.armed and last and last is self.ordered and not last["over"] and
                last["end"] == self.end() and
                all(bound[i] <= last["caps"][i] for i in GROUPS)):
            higher = [max(bound[i], min(wanted[i], last["caps"][i])) for i in GROUPS]
            if higher != bound:
                self.bounds.append(higher)
                self.changed_at = self.now
                self.named = last
                for one in self.permits:  # (iv)
                    one["over"] = one["over"] or any(one["proven"][i] < higher[i]
                                                     for i in GROUPS)
                assert not last["over"] and self.end() == last["end"]
        self.name_newest()
        return self.bounds[-1]

    def stop(self, at):
        self.see(at)
        self.halt("person")

    def change(self, at, jog):
        self.see(at)
        self.forget()
        self.jogging = bool(jog)
        if self.moves:
            self.halt("changed")

    def announce(self):
        let = self.armed and self.tool != "cancelled"
        if let and self.tool is None:
            self.tool = "wanted"
        return int(let)

    def may_tool(self, at):
        may = self.may_move(at)[0] != 0
        return int(may and isinstance(self.tool, int) and self.now - self.tool >= self.horizon)

    def end_tool(self):
        if self.tool != "cancelled":
            self.tool = None

    def ack_flags(self, mode):
        ack = None if self.newest is None else self.newest["ack"]
        return 0 if mode == 3 or ack is None else 4 | (ack["live"] & 15) << 4
