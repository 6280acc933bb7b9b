#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws cycle.svg: the threads of axguardd and one sample on a time line."""
from drawing import GREY, MID, PALE, PAPER, RULE, STOP, WARM, Drawing

SYNC_US, FRAME_US, DEADLINE_US = 65, 135, 500
FRAMES, VERDICT_US = 3, 200  # five axes in classical frames at 1 Mbit/s; an example of a verdict
LEFT, SCALE = 118, 0.395


def at(us):
    return LEFT + 26 + us * SCALE


def lane(figure, y, name, note):
    figure.text(8, y + 16, name, 12, bold=True)
    figure.text(8, y + 31, note, 11, fill=GREY)
    figure.line((LEFT - 6, y + 46), (592, y + 46), stroke=RULE)


def main():
    figure = Drawing("One cycle of axguardd: wire, threads and deadline on a time line", 330)
    figure.text(8, 18, "One sample; the verdict is drawn 200 us after the last frame", 13,
                bold=True)
    figure.text(8, 44, "us after latch", 11, fill=GREY)
    figure.line((LEFT, 54), (592, 54))
    for us in range(0, 1200, 200):
        figure.line((at(us), 54), (at(us), 49))
        figure.text(at(us), 45, str(us), 11, "middle")
    lane(figure, 64, "wire", "CAN")
    lane(figure, 118, "bus thread", "FIFO 80")
    lane(figure, 172, "engine thread", "FIFO 70")
    lane(figure, 226, "logger", "not real-time")
    last = FRAMES * FRAME_US
    answer = last + VERDICT_US

    figure.label(at(-SYNC_US), 70, SYNC_US * SCALE, 30, "S", PAPER, 11)
    for frame in range(FRAMES):
        figure.label(at(frame * FRAME_US), 70, FRAME_US * SCALE, 30, f"axis {frame + 1}", PALE, 11)
    figure.label(at(answer), 70, FRAME_US * SCALE, 30, "permit", MID, 11)
    figure.label(at(answer + FRAME_US), 70, FRAME_US * SCALE, 30, "twin", MID, 11)
    figure.label(at(1000 - SYNC_US), 70, SYNC_US * SCALE, 30, "S", PAPER, 11)
    figure.label(at(1000), 70, FRAME_US * SCALE, 30, "axis 1", PALE, 11)

    for us in (FRAME_US, 2 * FRAME_US, last, answer, answer + FRAME_US, answer + 2 * FRAME_US):
        figure.box(at(us), 124, 9, 28, WARM)
    figure.line((at(last), 100), (at(last) + 4, 123), head=True)
    figure.line((at(last) + 9, 152), (at(last) + 12, 177), head=True)
    figure.line((at(answer) - 4, 177), (at(answer) + 1, 153), head=True)
    figure.line((at(answer) + 4, 124), (at(answer) + 7, 101), head=True)

    work = at(last) + 12
    figure.box(work, 178, 14, 30, WARM)
    figure.label(work + 14, 178, 34, 30, "prove", PALE, 11)
    figure.box(work + 48, 178, 13, 30, WARM)
    figure.label(at(answer) + 28, 178, 62, 30, "advise", PAPER, 11, "4 3")
    figure.label(LEFT, 232, 474, 28, "every 20 ms: black box, notes, latch to disk; each second:"
                 " metrics", PAPER, 11, "4 3")
    figure.line((at(last + DEADLINE_US), 104), (at(last + DEADLINE_US), 222), stroke=STOP,
                dash="5 3", width=1.6)
    figure.text(at(last + DEADLINE_US) + 5, 176, "deadline:\n500 us after\nlast frame", 11,
                fill=STOP)
    for x, y, name in ((at(0), 70, 1), (at(last) + 4, 124, 2), (work + 6, 178, 3),
                       (work + 31, 178, 4), (work + 55, 178, 5), (at(answer) + 22, 130, 6),
                       (at(answer) + 27, 70, 7), (at(answer) + 59, 178, 8), (560, 232, 9)):
        figure.step(x, y, name)
    figure.text(8, 290, "S SYNC: all axes latch as it ends. 1 frames arrive. 2 drain, assemble the"
                " snapshot.", 11)
    figure.text(8, 305, "3 plan. 4 query the engine. 5 decide. 6 phase and permit. 7 send, echo,"
                " twin.", 11)
    figure.text(8, 320, "8 advise, after the permit. 9 record.", 11)
    figure.save(__file__)


if __name__ == "__main__":
    main()
