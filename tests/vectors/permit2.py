#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes permit2.json: frames of permit version 2, good and bad, and scripts of times, each with
what must happen. Everything is written out by hand from docs/reference/board.md: this file and
permit2_frames.py know no code of axguard.

Examples: permit2.py > permit2.json; permit2.py --check permit2.json"""
import json
import pathlib
import sys

from permit2_frames import (JOG, NONCE, RUN, SCRIPTS, SLOW, STOP, T, Script, crc8, crc16, hexed,
                            permit, script, session, twin_of)
from permit2_sent import scripts_of_frames, scripts_of_operators, scripts_of_small_frames


def frames_of_the_contract():
    """Section by section as the page shows them; nonce and lap are what the answer was made for."""
    shown = [
        ("nothing but run", RUN, 1, 1, 250, 0, 15, 0, 0),
        ("run", RUN, 17, 42, 250, 0, 15, NONCE, 3),
        ("cap 60 on axes 1 and 2", RUN, 240, 43, 60, 6, 10, NONCE, 3),
        ("the next lap", RUN, 1, 44, 60, 6, 10, NONCE, 4),
        ("jog", JOG, 2, 45, 250, 0, 3, NONCE, 4),
        ("stop", STOP, 3, 46, 250, 0, 0, NONCE, 4),
        ("slow", SLOW, 5, 47, 125, 255, 12, NONCE, 4, 2),
        ("hold", RUN, 6, 48, 0, 255, 10, NONCE, 4)]
    for name, word, echo, live, cap, mask, n, nonce, lap, *advice in shown:
        level = advice[0] if advice else 0
        data = permit(word, echo, live, cap, mask, n, nonce, lap, level)
        yield {"name": name, "plain": hexed(data), "twin": hexed(twin_of(data)), "word": word,
               "echo": echo, "live": live, "cap": cap, "mask": mask, "n": n, "level": level,
               "nonce": nonce, "lap": lap}


def scripts_of_the_end():
    at = Script.instant(4)
    one = script("an end is t_k + n T, and not a microsecond later",
                 "the guard is dead after the permit of sample 3; nothing else extends it")
    end = Script.instant(3) + 10 * T
    one.begin().latch(4).latch(5).may_move(end - 1, end).may_move(end)
    one.step("cause", want="permit_ended", phase="stopped")

    one = script("a permit one microsecond before its end is used, and at its end is late",
                 "arrival never extends anything")
    one.begin().latch(4)
    one.pair(permit(RUN, 5, 5, 250, 0, 3, NONCE, 0), at + 2980, twin_at=at + 2999)
    one.may_move(at + 2999, end).latch(5, at=at + 3000)
    one.pair(permit(RUN, 5, 6, 250, 0, 3, NONCE, 0), at + 3001, "refused", "late",
             twin_at=at + 3002)
    one.step("refused", why="late", want=1)

    one = script("exactly at its end a permit is late", "end <= now is refused")
    one.begin().latch(4)
    one.pair(permit(RUN, 5, 5, 250, 0, 3, NONCE, 0), at + 2980, "refused", "late",
             twin_at=at + 3000)

    one = script("a newer permit with an earlier end never shortens the end", "the hold rule")
    one.begin(n=15).latch(4).permit(4, at + 400, n=3)
    one.may_move(at + 500, Script.instant(3) + 15 * T)
    one.permit(4, at + 600, n=15).may_move(at + 700, at + 15 * T)

    one = script("a longer permit for the same sample", "n of the newer one counts")
    one.begin(n=5).latch(4).permit(4, at + 400, n=6).may_move(at + 500, at + 6 * T)
    one.permit(4, at + 500, n=8).may_move(at + 600, at + 8 * T)

    one = script("lost permits cost nothing until the end", "eight lost in a row at n = 10")
    one.begin()
    for number in range(4, 12):
        one.latch(number)
        one.may_move(Script.instant(number) + 900, end)
    one.latch(12).permit(12, Script.instant(12) + 400, live=13).may_move(
        Script.instant(12) + 500, Script.instant(12) + 10 * T)

    one = script("a permit after the end in motion is no way out", "the stop has latched")
    one.begin()
    for number in range(4, 13):
        one.latch(number)
    one.latch(13, at=end + 1)
    one.permit(13, end + 100, want="refused", why="stopped")
    one.step("cause", want="permit_ended", phase="stopped")

    one = script("an end at rest latches nothing", "the next permit lets it begin again")
    one.begin().moves(Script.instant(3) + 600, 0).latch(4).may_move(end)
    one.latch(14).permit(14, Script.instant(14) + 400).may_move(
        Script.instant(14) + 500, Script.instant(14) + 10 * T)
    one.step("cause", want="power_up", phase="armed")

    one = script("times beyond 32 bits", "an end after 2^32 us is an end like any other")
    base = 4_294_967_296 - 5_000 - 100_000
    one.power_up(at=base - 200_000)
    one.arm(base)
    for number in range(4):
        instant = base + 100_000 + number * T
        one.latch(number, at=instant)
        one.permit(number, instant + 400, want="permit" if number else "refused",
                   why="nothing" if number else "live")
    instant = base + 103_000
    one.moves(instant + 500).may_move(instant + 9_999, instant + 10_000)
    one.may_move(instant + 10_000)


def scripts_of_the_echo():
    one = script("the same echo a lap later", "a bus that held everything for 240 periods")
    one.begin()
    held = permit(RUN, 5, 5, 250, 0, 10, NONCE, 0)
    for number in range(4, 245):
        one.latch(number)
        if number < 244:
            live = (number + 2) % 256
            one.permit(number, Script.instant(number) + 400, live=live,
                       want="permit", why="nothing")
    one.pair(held, Script.instant(244) + 300, "refused", "answer")
    one.may_move(Script.instant(244) + 350, Script.instant(243) + 10 * T)

    one = script("laps count in the answer", "sample 240 is the first of lap 1")
    one.begin(first=237)
    one.latch(241).permit(241, Script.instant(241) + 400)
    one.permit(241, Script.instant(241) + 600, lap=0, want="refused", why="answer")

    one = script("the lap ends at 65535 and begins again", "samples go on across it")
    one.begin(first=65536 * 240 - 2)

    one = script("the sixteenth sample before is known, the seventeenth is not",
                 "records of 16 samples, no more")
    one.begin()
    for number in range(4, 20):
        one.latch(number, at=Script.instant(3) + 600 + 10 * number)
    late = Script.instant(3) + 600 + 200
    one.permit(3, late, want="refused", why="echo")
    one.permit(4, late + 100, n=15)

    one = script("an echo that was never latched", "0, 241, and a sample of the future")
    one.begin().latch(4)
    for index, echo in enumerate([0, 241, 255, 6]):
        one.permit(4, Script.instant(4) + 100 + 50 * index, echo=echo, want="refused",
                   why="echo")

    one = script("an older echo than the newest used", "permits out of order")
    one.begin().latch(4).latch(5).permit(5, Script.instant(5) + 400)
    one.permit(4, Script.instant(5) + 500, n=15, want="refused", why="old_echo")
    one.permit(5, Script.instant(5) + 600, n=12).may_move(
        Script.instant(5) + 700, Script.instant(5) + 12 * T)

    one = script("a lost sample leaves the others where they are", "no latch of sample 5")
    one.begin().latch(4).latch(6).permit(6, Script.instant(6) + 400)
    one.permit(5, Script.instant(6) + 500, want="refused", why="echo")

    one = script("samples out of order are forgotten, and stop a motion",
                 "a latch that counts or dates backwards")
    one.begin().latch(3, at=Script.instant(4), want=0)
    one.step("cause", want="latch_order", phase="stopped")
    one = script("a latch that is dated backwards", "its time is not after the last one's")
    one.begin().latch(4, at=Script.instant(3), want=0)
    one.step("cause", want="latch_order", phase="stopped")
    one = script("a number comes only once", "until a person arms, with another nonce")
    one.begin(first=30).latch(30, at=Script.instant(34), want=0)
    at = Script.instant(40)
    one.step("cause", want="latch_order", phase="stopped").moves(Script.instant(34) + 100, 0,
                                                                "stopped")
    for number in (29, 30, 33):  # what came once, or is before it
        one.latch(number, at=at + number, want=0)
    one.latch(34, at=Script.instant(33), want=0).latch(34, at=at + 100)
    one.arm(Script.instant(60), 0x00BEEF).latch(30, at=Script.instant(60) + 1)
    one.permit(30, Script.instant(60) + 2, want="refused", why="live")

    one = script("a sample that is stamped ahead permits nothing yet", "a stamp is no clock")
    at = Script.instant(4)
    one.begin().latch(4, at=at + 600).permit(4, at + 300, want="refused", why="echo")
    one.permit(4, at + 580, live=5, want="refused", why="echo", twin_at=at + 599)
    one.permit(4, at + 590, live=6, twin_at=at + 600).may_move(at + 700, at + 600 + 10 * T)

    one = script("a stamp an hour ahead", "time goes on as it is told: the end passes, and latches")
    hour = 3_600_000_000
    one.begin().moves(Script.instant(3) + 550, 0).latch(4, at=Script.instant(4) + hour)
    one.permit(4, Script.instant(4) + 100, want="refused", why="echo")
    one.may_move(Script.instant(13) + 1).latch(5, want=0)
    one.permit(5, Script.instant(5) + 100, live=6, want="refused", why="echo")
    one.may_move(Script.instant(14))

    one = script("a latch without a counter", "SYNC counts from 1 to 240")
    one.power_up().step("latch", at=10, sync=0, lap=0, want=0)
    one.step("latch", at=20, sync=241, lap=0, want=0)
    one.step("latch", at=30, sync=240, lap=0, want=1)


def scripts_of_the_nonce():
    one = script("a recording of before the stop", "a person armed; the nonce is another one")
    one.begin().latch(4)
    recorded = permit(RUN, 5, 5, 250, 0, 15, NONCE, 0)
    at = Script.instant(4)
    one.frame(0x001, [], at + 100, "stop").moves(at + 200, 0, "stopped")
    one.arm(at + 200 + 15_999, 0x00BEEF, "rest").arm(at + 200 + 16_000, NONCE, "nonce_again")
    one.arm(at + 16_200, 0x1000000, "nonce").arm(at + 16_200, 0x00BEEF)
    one.latch(240 + 4, at=at + 17_000)
    one.pair(recorded, at + 17_100, "refused", "answer")
    one.permit(244, at + 17_200, nonce=NONCE, live=5, want="refused", why="answer")
    one.permit(244, at + 17_300, live=6, want="refused", why="live")
    one.permit(244, at + 17_400).permit(244, at + 17_500).may_move(at + 17_600)
    one.permit(244, at + 17_700).may_move(at + 17_800, at + 17_000 + 10 * T)

    one = script("samples of before arming", "nothing latched before is a reason to move")
    one.power_up().latch(0).arm(100_500).permit(0, 100_600, want="refused", why="echo")
    one.step("latch", at=100_499, sync=2, lap=0, want=1)
    one.permit(1, 100_700, want="refused", why="echo")

    one = script("the wrong known answer", "an engine that answers its known question wrongly")
    one.begin().latch(4)
    one.permit(4, Script.instant(4) + 400, answer=0xC5A2, want="refused", why="answer")
    one.permit(4, Script.instant(4) + 500, live=5)

    for name, index, bits in [("n raised by one bit", 7, 0x10), ("n raised to 14", 7, 0x40),
                              ("word turned to slow", 0, 0x66), ("cap", 5, 0x01),
                              ("mask", 6, 0x80), ("level", 7, 0x01), ("live counter", 2, 0x01),
                              ("answer", 3, 0x01)]:
        one = script("one field changed in both frames: " + name, "the answer covers it")
        one.begin().latch(4)
        data = permit(RUN, 5, 5, 250, 0, 10, NONCE, 0)
        data[index] ^= bits
        one.pair(data, Script.instant(4) + 400, "refused", "answer")
        one.permit(4, Script.instant(4) + 500, live=5)


def scripts_of_pairs():
    at = Script.instant(4)
    good, other = permit(RUN, 5, 5, 250, 0, 10, NONCE, 0), permit(RUN, 5, 6, 250, 0, 10, NONCE, 0)
    one = script("the inverse of another permit", "every bit is turned")
    one.begin().latch(4).frame(0x103, good, at + 100, "plain")
    one.frame(0x104, twin_of(other), at + 110, "refused", "twin_differs")
    one.frame(0x104, twin_of(good), at + 120, "refused", "twin_alone")
    for bit in range(64):
        turned = twin_of(good)
        turned[bit // 8] ^= 1 << bit % 8
        one.frame(0x103, good, at + 200 + 4 * bit, "plain")
        one.frame(0x104, turned, at + 202 + 4 * bit, "refused", "twin_differs")

    one = script("the inverse within T", "at T it is used, a microsecond later it is not")
    one.begin().latch(4).pair(good, at + 100, twin_at=at + 1100)
    one = script("the inverse after T", "at T it is used, a microsecond later it is not")
    one.begin().latch(4).pair(good, at + 100, "refused", "twin_late", twin_at=at + 1101)

    one = script("inverse first", "plain comes first")
    one.begin().latch(4).frame(0x104, twin_of(good), at + 100, "refused", "twin_alone")
    one.frame(0x103, good, at + 110, "plain").frame(0x103, other, at + 120, "refused",
                                                    "twin_missing")
    one.frame(0x104, twin_of(other), at + 130, "permit")

    one = script("shapes", "eight bytes, not flexible")
    one.begin().latch(4)
    for identifier in (0x103, 0x104):
        for data, fd in ((good[:7], 0), ([], 0), (good, 1)):
            one.frame(0x103, good, at + 100, "plain")
            one.frame(identifier, data, at + 110, "refused", "shape", fd)
            one.frame(0x104, twin_of(good), at + 120, "refused", "twin_alone")
    one.frame(0x105, good, at + 130, "nothing").frame(0x102, good, at + 130, "nothing")
    one.pair(good, at + 140)

    one = script("words", "any other byte is none")
    one.begin().latch(4)
    for word in (0x00, 0xFF, 0xA4, 0xC5, 0x3D, 0x5B):
        one.pair(permit(word, 5, 5, 250, 0, 10, NONCE, 0), at + 100, "refused", "word")
    one.pair(good, at + 200)


def scripts_of_live_counters():
    for ahead, want, why in [(1, "permit", "nothing"), (15, "permit", "nothing"),
                             (16, "refused", "live"), (0, "refused", "live"),
                             (255, "refused", "live"), (128, "refused", "live")]:
        one = script(f"live counter {ahead} ahead", "1 to 15 ahead of the last right answer")
        one.begin().latch(4)
        one.permit(4, Script.instant(4) + 400, live=(4 + ahead) % 256, want=want, why=why)
        one.permit(4, Script.instant(4) + 500)

    one = script("wrong answers do not move the live counter", "20 of them, then the next number")
    one.begin().latch(4)
    for index in range(20):
        one.permit(4, Script.instant(4) + 20 * index, live=5 + index, answer=0, want="refused",
                   why="answer")
    one.permit(4, Script.instant(4) + 600, live=5)

    one = script("refused for anything but its answer, a pair moves the live counter",
                 "n = 0 fifteen ahead, then fifteen more")
    one.begin().latch(4)
    one.permit(4, Script.instant(4) + 400, live=19, n=0, want="refused", why="samples")
    one.permit(4, Script.instant(4) + 500, live=34)

    one = script("three usable permits in a row before the first motion",
                 "one refused in between begins the row again")
    one.power_up().arm(50_000).latch(0)
    at = Script.instant(0)
    one.permit(0, at + 100, want="refused", why="live").permit(0, at + 200).permit(0, at + 300)
    one.permit(0, at + 400, n=0, want="refused", why="samples").permit(0, at + 500)
    one.permit(0, at + 600).may_move(at + 650).permit(0, at + 700)
    one.may_move(at + 800, at + 10 * T)


def scripts_of_values():
    at = Script.instant(4)
    one = script("n above the board's largest", "permit_samples_max is 12")
    one.begin(n_max=12).latch(4).permit(4, at + 100, n=13, want="refused", why="samples")
    one.permit(4, at + 200, n=0, want="refused", why="samples").permit(4, at + 300, n=12)

    one = script("values that mean nothing", "a cap above 250, a level above 3")
    one.begin().latch(4)
    one.permit(4, at + 100, cap=251, want="refused", why="value")
    one.permit(4, at + 200, level=4, want="refused", why="value")
    one.permit(4, at + 300, word=SLOW, level=3).may_move(at + 400, at + 10 * T, SLOW)

    one = script("a change begins the row anew", "three in a row before the first motion")
    one.power_up().arm(50_000)
    for number in range(3):
        one.latch(number)
        one.permit(number, Script.instant(number) + 400, want="permit" if number else "refused",
                   why="nothing" if number else "live")
    one.step("change", at=Script.instant(2) + 500, jog=0)
    for number in range(3, 6):
        one.latch(number).may_move(Script.instant(number) + 100)
        one.permit(number, Script.instant(number) + 400)
    one.may_move(Script.instant(5) + 500, Script.instant(5) + 10 * T)

    one = script("jog for jog alone", "and run is not for a jog")
    one.begin().latch(4).permit(4, at + 100, word=JOG, want="refused", why="jog")
    one.moves(at + 200, 0).step("change", at=at + 300, jog=1).may_move(at + 300)
    one.permit(4, at + 350, word=JOG, want="refused", why="echo").latch(5)
    at = Script.instant(5)
    one.permit(5, at + 100, want="refused", why="jog")
    one.permit(5, at + 200, word=SLOW, want="refused", why="jog")
    one.permit(5, at + 300, word=JOG, n=3).may_move(at + 400, at + 3 * T, JOG)
    one.permit(5, at + 500, word=JOG, n=3, cap=251, mask=3)

    one = script("a late permit of before the change", "its sample was latched with another tool")
    one.begin().latch(4).moves(Script.instant(4) + 100, 0)
    one.step("change", at=Script.instant(4) + 200, jog=0)
    one.permit(4, Script.instant(4) + 300, want="refused", why="echo")
    one.step("latch", at=Script.instant(4) + 199, sync=6, lap=0, want=1)
    one.permit(5, Script.instant(4) + 400, want="refused", why="echo").latch(6)
    one.permit(6, Script.instant(6) + 100).may_move(Script.instant(6) + 200,
                                                    Script.instant(6) + 10 * T)

    one = script("a change in motion is a stop", "nothing allows the motion any more")
    one.begin().step("change", at=Script.instant(3) + 600, jog=1)
    one.step("cause", want="changed", phase="stopped")


def scripts_of_stops():
    at = Script.instant(4)
    for name, data in [("no byte", []), ("bytes that it should not have", [0])]:
        one = script("the stop frame with " + name, "at once, and only a person leads out")
        one.begin().latch(4).frame(0x001, data, at + 100, "stop").may_move(at + 100)
        one.permit(4, at + 200, want="refused", why="stopped")
        one.step("cause", want="stop_frame", phase="stopped")
        one.arm(at + 50_000, 0x00BEEF, "moves")

    one = script("the word stop once it moved", "whatever sample it echoes")
    one.begin().latch(4).permit(4, at + 100, word=STOP, n=0, want="stop")
    one.step("cause", want="stop_word", phase="stopped")
    one = script("the word stop with an echo that is unknown", "a guard without samples says it")
    one.begin().latch(4).permit(4, at + 100, word=STOP, n=0, echo=99, want="stop")
    one.step("cause", want="stop_word", phase="stopped")
    one = script("the word stop before the first motion", "it says not yet")
    one.power_up().arm(50_000).latch(0)
    one.permit(0, Script.instant(0) + 100, word=STOP, n=0, want="not_yet")
    one.permit(0, Script.instant(0) + 200).step("cause", want="power_up", phase="armed")

    one = script("no motion before a person", "power-up is a stop")
    one.power_up().latch(0)
    for index in range(5):
        one.permit(0, Script.instant(0) + 100 + 50 * index, nonce=0x123456, want="refused",
                   why="stopped")
    one.may_move(Script.instant(0) + 800)
    one.moves(Script.instant(0) + 900, 1, "stopped")

    one = script("motion without a permit", "the axes moved before they might")
    one.power_up().arm(50_000).latch(0).moves(Script.instant(0) + 10, 1, "stopped")
    one.step("cause", want="not_permitted", phase="stopped")

    one = script("a stop of the board's own", "a person or a drive")
    one.begin().step("stop", at=Script.instant(3) + 600)
    one.step("cause", want="person", phase="stopped")

    one = script("equal hashes before the first motion", "all four, and again after a change")
    one.power_up(hashes=1).arm(50_000).latch(0)
    start = Script.instant(0)
    for live in range(1, 6):
        one.permit(0, start + 50 * live, live=live, want="permit" if live > 1 else "refused",
                   why="nothing" if live > 1 else "live")
    one.may_move(start + 300)
    for part in range(4):
        one.may_move(start + 310)
        one.frame(0x602, [part, 1, 0, 0, 0x11, 0x22, 0x33, 0x44 + part], start + 310, "hash")
    one.may_move(start + 320, start + 10 * T)
    one.frame(0x602, [2, 1, 0, 0, 0x11, 0x22, 0x33, 0], start + 330, "hash_differs")
    one.may_move(start + 340)
    for data in ([4, 1, 0, 0, 0, 0, 0, 0], [0, 2, 0, 0, 0, 0, 0, 0], [0, 1, 1, 0, 0, 0, 0, 0],
                 [0, 1, 0, 1, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0, 0]):
        one.frame(0x602, data, start + 350, "refused", "shape")
    one.frame(0x602, [2, 1, 0, 0, 0x11, 0x22, 0x33, 0x46], start + 360, "hash")
    one.moves(start + 400)
    one.frame(0x602, [0, 1, 0, 0, 0, 0, 0, 0], start + 500, "hash_differs")
    one.step("cause", want="hash_differs", phase="stopped")


def scripts_of_tools():
    horizon = 15_150 + 20 + 2000
    one = script("a tool change H(n_max) after its first announced sample", "not one us earlier")
    one.begin().moves(Script.instant(3) + 600, 0).step("announce", want=1)
    one.step("may_tool", at=Script.instant(3) + 700, want=0)
    for number in range(4, 22):
        one.latch(number).permit(number, Script.instant(number) + 100)
    begins = Script.instant(4) + horizon
    one.step("may_tool", at=begins - 1, want=0).step("may_tool", at=begins, want=1)
    one.step("end_tool").step("may_tool", at=begins, want=0)

    one = script("no tool change without a permit", "it is a motion like any other")
    one.power_up().arm(50_000).step("announce", want=1).latch(0)
    one.step("may_tool", at=Script.instant(40), want=0)
    for number in range(41, 45):  # the fourth pair is the third that is used
        one.latch(number)
        one.step("may_tool", at=Script.instant(number) + 300, want=0)
        one.permit(number, Script.instant(number) + 400,
                   want="refused" if number == 41 else "permit",
                   why="live" if number == 41 else "nothing")
    one.step("may_tool", at=Script.instant(44) + 500, want=1)
    one.step("change", at=Script.instant(44) + 600, jog=0)
    one.step("may_tool", at=Script.instant(44) + 700, want=0)

    for name, kill in [("a stop frame", True), ("an end that passed", False)]:
        one = script("a tool change is cancelled by " + name, "until a person armed")
        one.begin().moves(Script.instant(3) + 600, 0).step("announce", want=1).latch(4)
        if kill:
            one.permit(4, Script.instant(4) + 100)
            one.frame(0x001, [], Script.instant(4) + 200, "stop")
        one.step("may_tool", at=Script.instant(4) + 30_000, want=0).step("announce", want=0)
        one.step("end_tool").step("announce", want=0)
        one.arm(Script.instant(4) + 40_000, 0x00BEEF).step("announce", want=1)


def caps(*values):
    return hexed(values[:1] * 8 if len(values) == 1 else values)


def kept(*values):
    """Bounds that hold on a board of five axes: nothing is kept of a group without one."""
    return hexed([*(values[:1] * 8 if len(values) == 1 else values)][:5] + [0] * 3)


def scripts_of_caps():
    start = Script.instant(3)
    one = script("a cap is kept, acknowledged and raised", "rules (i) and (ii)")
    one.begin(caps=1)
    one.step("flags_of", mode=1, want=0x34)
    one.step("keeps", at=start + 550, wanted=caps(250), want=kept(250))
    one.latch(4).step("flags_of", mode=1, want=0x44)
    one.step("flags_of", mode=3, want=0x00)
    one.permit(4, Script.instant(4) + 100, cap=60, mask=6)
    one.latch(5).step("flags_of", mode=1, want=0x44)  # it still slows down
    slow = (250, 60, 60, 250, 250, 250, 250, 250)
    one.step("keeps", at=Script.instant(5) + 100, wanted=caps(*slow), want=kept(*slow))
    one.latch(6).step("flags_of", mode=1, want=0x54)
    one.step("keeps", at=Script.instant(6) + 100, wanted=caps(250), want=kept(*slow))
    one.permit(6, Script.instant(6) + 200, cap=80, mask=2)
    one.step("keeps", at=Script.instant(6) + 300, wanted=caps(250),
             want=kept(250, 80, 250, 250, 250, 250, 250, 250))
    one.latch(7).step("flags_of", mode=1, want=0x64)

    one = script("a permit whose sample was faster than its proof", "rule (iii), a late order")
    one.begin(caps=1)
    one.step("keeps", at=start + 550, wanted=caps(20), want=kept(20)).latch(4)
    one.permit(4, Script.instant(4) + 100, cap=20, mask=255).latch(5)  # acked: 20
    one.latch(6)
    one.step("flags_of", mode=1, want=0x54)
    one.permit(6, Script.instant(6) + 100, cap=100, mask=255)
    one.step("keeps", at=Script.instant(6) + 200, wanted=caps(100), want=kept(100))
    one.step("keeps", at=Script.instant(6) + 300, wanted=caps(10), want=kept(10))
    one.permit(6, Script.instant(6) + 400, cap=20, mask=255, n=12, want="refused", why="cap")
    one.may_move(Script.instant(6) + 450, Script.instant(6) + 10 * T)
    one.latch(7).permit(7, Script.instant(7) + 100, cap=20, mask=255)

    one = script("no raise on a permit that was refused for a cap", "rule (ii)")
    one.begin(caps=1)
    one.step("keeps", at=start + 550, wanted=caps(50), want=kept(50))
    one.latch(4).permit(4, Script.instant(4) + 100, cap=50, mask=255).latch(5)
    one.latch(6).permit(6, Script.instant(6) + 100, cap=90, mask=255)
    one.step("keeps", at=Script.instant(6) + 200, wanted=caps(90), want=kept(90))
    one.step("keeps", at=Script.instant(6) + 250, wanted=caps(40), want=kept(40))
    # Axis 0 was at 90 since sample 6, and this proof knows 50 of it. Samples may have named it, so
    # a raise on the permit before it would name an older one again.
    one.permit(6, Script.instant(6) + 300, cap=50, mask=1, n=12, want="refused", why="cap")
    one.latch(7).step("flags_of", mode=1, want=0x74)
    one.step("keeps", at=Script.instant(7) + 50, wanted=caps(40, *[250] * 7), want=kept(40))
    one.permit(7, Script.instant(7) + 100, cap=90, mask=254)
    one.step("keeps", at=Script.instant(7) + 200, wanted=caps(40, *[250] * 7),
             want=kept(40, *[90] * 7))

    one = script("a raise waits for the end in force", "rule (iv): it shortens nothing")
    one.begin(caps=1, n=15)
    one.step("keeps", at=start + 550, wanted=caps(30), want=kept(30)).latch(4)
    one.permit(4, Script.instant(4) + 100, n=15, cap=30, mask=255).latch(5)
    one.permit(5, Script.instant(5) + 100, n=3, cap=200, mask=255)
    one.step("keeps", at=Script.instant(5) + 200, wanted=caps(200), want=kept(30))
    one.may_move(Script.instant(5) + 300, Script.instant(4) + 15 * T).latch(6)
    one.permit(6, Script.instant(6) + 100, n=15, cap=200, mask=255)
    one.step("keeps", at=Script.instant(6) + 200, wanted=caps(200), want=kept(200))

    one = script("no axis rises while another has still to slow down", "rule (i): one ack for all")
    one.begin(caps=1)
    one.step("keeps", at=start + 550, wanted=caps(20, *[250] * 7), want=kept(20, *[250] * 7))
    one.latch(4).permit(4, Script.instant(4) + 100, cap=40, mask=2)
    one.step("keeps", at=Script.instant(4) + 200, wanted=caps(250), want=kept(20, *[250] * 7))
    one.step("keeps", at=Script.instant(4) + 300, wanted=caps(250, 40, *[250] * 6),
             want=kept(250, 40, *[250] * 6))

    one = script("groups without an axis", "what is handed in for them delays no acknowledgement")
    one.begin(caps=1).latch(4).permit(4, Script.instant(4) + 100, cap=60, mask=255)
    one.step("keeps", at=Script.instant(4) + 200, wanted=caps(*[60] * 5, *[250] * 3),
             want=kept(60)).latch(5).step("flags_of", mode=1, want=0x54)

    one = script("a raise above a stop", "stopped, u only falls")
    one.begin(caps=1).latch(4).permit(4, Script.instant(4) + 100)
    one.step("keeps", at=Script.instant(4) + 200, wanted=caps(90), want=kept(90))
    one.frame(0x001, [], Script.instant(4) + 300, "stop")
    one.step("keeps", at=Script.instant(4) + 400, wanted=caps(200), want=kept(90))
    one.step("keeps", at=Script.instant(4) + 500, wanted=caps(80), want=kept(80))

    one = script("hold", "cap 0: it stands on its path, and permits go on")
    one.begin(caps=1).latch(4).permit(4, Script.instant(4) + 100, cap=0, mask=255)
    one.step("keeps", at=Script.instant(4) + 200, wanted=caps(250), want=kept(0))
    one.latch(5).step("flags_of", mode=1, want=0x54)
    one.may_move(Script.instant(5) + 100, Script.instant(4) + 10 * T)

    one = script("a stamp from before the bound fell", "what it was then is not known: rapid")
    one.begin(caps=1)
    one.step("keeps", at=start + 550, wanted=caps(250), want=kept(250)).latch(4)
    one.permit(4, Script.instant(4) + 100, cap=30, mask=255)
    one.step("keeps", at=Script.instant(4) + 200, wanted=caps(30), want=kept(30))
    one.latch(5, at=Script.instant(4) + 199).permit(5, Script.instant(5) + 100, cap=30, mask=255,
                                                    want="refused", why="cap")

    one = script("a board without caps says no ack", "what the permit orders is advice")
    one.begin().latch(4).permit(4, Script.instant(4) + 100, cap=0, mask=255)
    one.latch(5).step("flags_of", mode=1, want=0)
    one.step("keeps", at=Script.instant(5) + 100, wanted=caps(3), want=caps(250))


def document():
    SCRIPTS.clear()
    for part in (scripts_of_the_end, scripts_of_the_echo, scripts_of_the_nonce, scripts_of_pairs,
                 scripts_of_live_counters, scripts_of_values, scripts_of_stops, scripts_of_tools,
                 scripts_of_caps, scripts_of_frames,
                 scripts_of_small_frames, scripts_of_operators):
        part()
    digits = list(b"123456789")
    return {"about": "permit version 2: docs/reference/board.md; made by permit2.py",
            "checks": {"crc16": f"{crc16(digits):04X}", "crc8": f"{crc8(digits):02X}"},
            "permits": list(frames_of_the_contract()),
            "sessions": [{"frame": hexed(session(17, 3, NONCE, 2)), "sync": 17, "lap": 3,
                          "nonce": NONCE, "counter": 2}],
            "scripts": [{"name": one.name, "why": one.why, "steps": one.steps}
                        for one in SCRIPTS]}


def text_of(made):
    """One step a line, so that a reader in C needs no parser."""
    lines = ["{", f'"about": {json.dumps(made["about"])},',
             f'"checks": {json.dumps(made["checks"])},']
    for key in ("permits", "sessions"):
        rows = ",\n".join(json.dumps(row) for row in made[key])
        lines.append(f'"{key}": [\n{rows}\n],')
    lines.append('"scripts": [')
    blocks = []
    for one in made["scripts"]:
        steps = ",\n".join(json.dumps(step) for step in one["steps"])
        head = f'"name": {json.dumps(one["name"])}, "why": {json.dumps(one["why"])}'
        blocks.append("{" + head + ', "steps": [\n' + steps + "\n]}")
    lines += [",\n".join(blocks), "]", "}"]
    return "\n".join(lines) + "\n"


def main():
    text = text_of(document())
    assert json.loads(text) == document()
    if sys.argv[1:2] == ["--check"]:
        same = pathlib.Path(sys.argv[2]).read_text(encoding="utf-8") == text
        print("permit2.json is what permit2.py writes" if same else
              "permit2.json: differs from what permit2.py writes; run permit2.py > permit2.json")
        sys.exit(0 if same else 1)
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
