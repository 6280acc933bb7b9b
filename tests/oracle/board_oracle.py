#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Judges the scripts of permit2.json by board_model.py; and lets the board library play random ones
that the model has judged: permits lost, late, out of order, repeated and damaged, samples lost,
power cycles, caps, jogs. AXG_COUNT: how many; AXG_SEED: of which.

Example: board_oracle.py tests/vectors build/host-release/tests/axg_play_permit2"""
import copy
import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

from board_model import Board

NONCES = [0xC0FFEE, 0x00BEEF, 0x123456, 0xFFFFFF]


def play(board, step):
    """The board after the step, and what the model wants of it, as the keys of the step."""
    do, at = step["do"], step.get("at", 0)
    if do == "power_up":
        board = Board(step)
        return board, {"want": int(board.good)}
    if do == "arm":
        return board, {"want": board.arm(at, step["nonce"])}
    if do == "latch":
        return board, {"want": board.latch(at, step["sync"], step["lap"])}
    if do == "frame":
        want, why = board.frame(at, step["id"], step["fd"], step["data"])
        return board, {"want": want, "why": why}
    if do == "may_move":
        end, word = board.may_move(at)
        return board, {"end": end, "word": word}
    if do == "moves":
        board.set_moves(at, step["moves"])
        return board, {"phase": "armed" if board.armed else "stopped"}
    if do == "keeps":
        return board, {"want": bytes(board.keeps(at, bytes.fromhex(step["wanted"]))).hex().upper()}
    if do == "change":
        return board, board.change(at, step["jog"]) or {}
    if do == "stop":
        return board, board.stop(at) or {}
    if do == "cause":
        return board, {"want": board.cause, "phase": "armed" if board.armed else "stopped"}
    if do == "refused":
        return board, {"want": board.counts.get(step["why"], 0)}
    if do == "announce":
        return board, {"want": board.announce()}
    if do == "may_tool":
        return board, {"want": board.may_tool(at)}
    if do == "end_tool":
        return board, board.end_tool() or {}
    if do == "flags_of":
        return board, {"want": board.ack_flags(step["mode"])}
    return board, {}  # frames of the board: permit2.py encodes them itself


def faults_of_scripts(document):
    board, seen = None, 0
    for script in document["scripts"]:
        for step in script["steps"]:
            board, wanted = play(board, step)
            for key, value in wanted.items():
                seen += 1
                if step[key] != value:
                    yield f'{script["name"]}: {step}: the model wants {key} = {value}'
    if seen < 1000:
        yield f"only {seen} expectations in permit2.json"


class Drawn:
    """A random script: a guard, a bus and a board that all make mistakes."""

    def __init__(self, dice, permit, twin_of):
        self.dice, self.permit, self.twin_of = dice, permit, twin_of
        self.steps, self.board = [], None

    def step(self, do, **values):
        made = {"do": do, **values}
        self.board, wanted = play(self.board, made)
        self.steps.append({**made, **wanted})
        return wanted

    def frame(self, at, identifier, data, fd=0):
        return self.step("frame", at=at, id=identifier, fd=fd, data=bytes(data).hex().upper())

    def pair(self, number, live):
        dice = self.dice
        chance = dice.random()
        word = 0x3C if self.board.jogging else dice.choice([0xA5, 0xA5, 0xA5, 0xC3])
        if chance < 0.03:
            word = dice.choice([0xA5, 0x3C, 0x5A, 0x00])
        cap, mask = dice.choice([(250, 0), (250, 0), (60, 255), (20, 6), (0, 255), (120, 0x81)])
        n = dice.choice([self.board.n_max, dice.randint(1, self.board.n_max)])
        if dice.random() < 0.01:
            cap, n = dice.randint(0, 255), dice.randint(0, 15)
        if word in (0x3C, 0x5A):
            cap, mask = 250, 0
        nonce = self.board.nonce if dice.random() > 0.02 else dice.choice(NONCES)
        lap = number // 240 % 65536 - (1 if dice.random() < 0.01 else 0)
        return self.permit(word, number % 240 + 1, live, cap, mask, n, nonce, lap % 65536,
                           dice.choice([0, 0, 1, 3]))

    def make(self, periods=120):
        dice = self.dice
        period = dice.choice([500, 1000, 2000])
        start = dice.choice([0, 2**32 - 40 * period])
        self.step("power_up", at=start, nonce=0x777777, period=period,
                  n_max=dice.choice([3, 5, 10, 12, 15]), axes=5, caps=dice.randint(0, 1), hashes=0,
                  jitter=20, reaction=2000, endless=0)
        base = start + 20 * max(1000, period)
        self.step("arm", at=base - 1, nonce=dice.choice(NONCES))
        number = dice.choice([0, 235, 240 * 65536 - 20])
        live, waiting, loss = dice.randint(0, 255), [], dice.choice([0, 0.02, 0.2])
        for index in range(periods):
            at = base + index * period
            number = (number + 1) % (240 * 65536)
            if dice.random() > 0.02:
                self.latch(number, at + dice.randint(0, 20), period)
            live = (live + (1 if dice.random() > 0.02 else dice.randint(0, 20))) % 256
            data = self.pair(number if dice.random() > 0.03 else max(0, number - 3), live)
            sent = at + dice.randint(50, period - 60)
            self.send(waiting, sent, data, period)
            if dice.random() < 0.3:  # another for the same sample
                live = (live + 1) % 256
                self.send(waiting, sent + 50, self.pair(number, live), period)
            if dice.random() < 0.002:
                waiting.append((sent, 0x001, []))
            waiting.sort(key=lambda one: one[0])
            self.run_period(at, period, waiting, loss)

    def latch(self, number, at, period):
        """Now and then stamped ahead of the time, or with a number of before."""
        dice, chance = self.dice, self.dice.random()
        if chance < 0.01:
            at += dice.choice([dice.randint(0, 3 * period), 3_600_000_000])
        elif chance < 0.02:
            number = (number - dice.randint(0, 30)) % (240 * 65536)
        self.step("latch", at=at, sync=number % 240 + 1, lap=number // 240)

    def send(self, waiting, at, data, period):
        late = 0 if self.dice.random() > 0.05 else self.dice.randint(0, 18 * period)
        waiting.append((at + late, 0x103, data))
        waiting.append((at + late + self.dice.randint(1, 50), 0x104, self.twin_of(data)))

    def run_period(self, at, period, waiting, loss):
        dice = self.dice
        while waiting and waiting[0][0] < at + period:
            time, identifier, data = waiting.pop(0)
            chance = dice.random()
            if chance < loss:
                continue
            data = copy.copy(data)
            if chance > 0.99 and data:
                data[dice.randrange(len(data))] ^= 1 << dice.randrange(8)
            self.frame(time, identifier, data)
            if chance > 0.985:
                self.frame(time, identifier, data)
            self.step("may_move", at=time)
            if dice.random() < 0.2:
                self.keep(time, dice.choice([0, 20, 60, 250, 250]))
        end = self.board.end()
        if end is not None and at <= end <= at + period and dice.random() < 0.5:
            for time in (end - 1, end):
                self.step("may_move", at=time)
        self.act(at + period - 1)

    def keep(self, at, bound):
        wanted = [bound] * 8
        wanted[self.dice.randrange(8)] = self.dice.randint(0, 250)
        self.step("keeps", at=at, wanted=bytes(wanted).hex().upper())

    def act(self, at):
        dice, board = self.dice, self.board
        may = self.step("may_move", at=at)["end"] != 0
        if not board.moves and may and dice.random() < 0.6:
            self.step("moves", at=at, moves=1)
        elif board.moves and (not may or dice.random() < 0.1):
            self.step("moves", at=at, moves=0)
        if not board.armed and not board.moves:
            self.step("arm", at=at, nonce=dice.choice(NONCES))
        if dice.random() < 0.02:
            self.step("change", at=at, jog=dice.randint(0, 1))
        if dice.random() < 0.3:
            self.keep(at, dice.choice([0, 20, 60, 120, 250, dice.randint(0, 250)]))
        self.step("flags_of", mode=1)
        if dice.random() < 0.05:
            self.step("announce")
        self.step("may_tool", at=at)
        if dice.random() < 0.02:
            self.step("end_tool")
        self.step("cause")


def text_of(drawn):
    return "".join(f'{{"name": "random {index}", "why": "", "steps": [\n' +
                   "".join(json.dumps(step) + "\n" for step in one.steps)
                   for index, one in enumerate(drawn))


def main():
    folder, player = pathlib.Path(sys.argv[1]), sys.argv[2]
    sys.path.insert(0, str(folder))
    from permit2_frames import permit, twin_of  # encodes what the guard sends
    faults = list(faults_of_scripts(json.loads((folder / "permit2.json").read_text())))
    seed = int(os.environ.get("AXG_SEED", "1"))
    count = int(os.environ.get("AXG_COUNT", "300"))
    print(f"seed {seed} (AXG_SEED overrides it), {count} random scripts")
    drawn = []
    for index in range(count):
        one = Drawn(random.Random(seed * 1_000_003 + index), permit, twin_of)
        one.make()
        drawn.append(one)
    heard = {}
    for one in drawn:
        for step in one.steps:
            if step["do"] == "frame":
                name = step["why"] if step["want"] == "refused" else step["want"]
                heard[name] = heard.get(name, 0) + 1
    print(dict(sorted(heard.items())))
    for name in ("permit", "answer", "live", "late", "echo", "old_echo", "cap", "jog", "stopped",
                 "twin_alone", "twin_missing", "twin_differs", "samples"):
        if heard.get(name, 0) < 10 and count >= 300:
            faults.append(f"the random scripts have hardly any '{name}'")
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        file.write(text_of(drawn))
        file.flush()
        run = subprocess.run([player, file.name], text=True, capture_output=True, check=False)
    if run.returncode != 0:
        faults.append("the library and the model differ:\n" + run.stdout[:4000])
    print(run.stdout[-60:].strip())
    for fault in faults[:20]:
        print(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
