#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Takes one rule after the other out of the board library, and lets it play permit2.json: each time
a script has to fail. The text that is replaced has to occur exactly once.

Example: board_ablations.py . cc"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
ROOM = "firmware_if/board"
PERMIT, CAPS, BOARD = "board_permit.c", "board_caps.c", "axguard_board.c"

ABLATIONS = [  # what is left out, file, text, what stands there instead
    ("the end counts from arrival", PERMIT, "record->sample.latched_us + ((uint64_t)samples",
     "board->now_us + ((uint64_t)samples"),
    ("the end is 4 ms after arrival", PERMIT,
     "record->sample.latched_us + ((uint64_t)samples * board->options.period_us)",
     "board->now_us + 4000U"),
    ("any lap is right", PERMIT, "(uint32_t)axg_board_answer(board, record->sample.lap)) {\n"
     "        why = AXG_BOARD_REFUSED_ANSWER",
     "(uint32_t)axg_board_answer(board, record->sample.lap) &&\n"
     "        axg_board_get_little(&data[3], 2U) !=\n"
     "        (uint32_t)axg_board_answer(board, (uint16_t)(record->sample.lap - 1U))) {\n"
     "        why = AXG_BOARD_REFUSED_ANSWER"),
    ("arming keeps the nonce", BOARD, "        board->nonce = nonce;\n        board->has_session",
     "        board->has_session"),
    ("no session after arming", BOARD,
     "        board->nonce = nonce;\n        board->has_session_changed = true;",
     "        board->nonce = nonce;"),
    ("the answer knows no arming", PERMIT, "axg_board_put_little(context, board->nonce, 3U);",
     "axg_board_put_little(context, 0xC0FFEEU, 3U);"),
    ("a late permit counts", PERMIT, "permit->end_us <= board->now_us", "false"),
    ("a permit is late one microsecond after its end", PERMIT,
     "permit->end_us <= board->now_us", "permit->end_us < board->now_us"),
    ("the newest permit sets the end", PERMIT,
     "!board->has_end || (permit->end_us > board->end_us)", "true"),
    ("an end passed in motion latches nothing", BOARD,
     "if (board->moves) {\n            axg_board_halt(board, AXG_BOARD_CAUSE_PERMIT_ENDED)",
     "if (false) {\n            axg_board_halt(board, AXG_BOARD_CAUSE_PERMIT_ENDED)"),
    ("the end is one microsecond later", BOARD, "board->now_us >= board->end_us",
     "board->now_us > board->end_us"),
    ("live counter up to 16 ahead", PERMIT, "AXG_BOARD_AHEAD_MAX 15U", "AXG_BOARD_AHEAD_MAX 16U"),
    ("live counter up to 14 ahead", PERMIT, "AXG_BOARD_AHEAD_MAX 15U", "AXG_BOARD_AHEAD_MAX 14U"),
    ("a wrong answer moves the live counter", PERMIT,
     "why = AXG_BOARD_REFUSED_ANSWER;",
     "why = AXG_BOARD_REFUSED_ANSWER; (void)axg_board_is_next(board, data[2]);"),
    ("the first number after arming counts", PERMIT, "board->has_live && (ahead",
     "(!board->has_live || ahead == ahead) && (ahead"),
    ("32 records", "axguard_board.h", "AXG_BOARD_RECORDS 16U", "AXG_BOARD_RECORDS 32U"),
    ("fifteen records", PERMIT, "(age < AXG_BOARD_RECORDS)", "(age + 1U < AXG_BOARD_RECORDS)"),
    ("an older echo counts", PERMIT, "return board->has_used &&", "return false &&"),
    ("n above the largest", PERMIT, "(samples > board->options.permit_samples_max)", "false"),
    ("the inverse of 2 T ago", PERMIT, "> board->options.period_us)) {",
     "> 2U * board->options.period_us)) {"),
    ("the inverse need not fit", PERMIT, "} else if (same != 0U) {", "} else if (false) {"),
    ("run is for a jog too", PERMIT, "} else if (is_jog != board->is_jogging) {",
     "} else if (is_jog && !board->is_jogging) {"),
    ("jog is for everything", PERMIT, "} else if (is_jog != board->is_jogging) {",
     "} else if (!is_jog && board->is_jogging) {"),
    ("a change leaves the samples", BOARD,
     "        board->records[i].is_kept = false;\n", ""),
    ("a sample of before the change comes after it", BOARD,
     "record->is_kept = sample->latched_us >= board->forgotten_us;", "record->is_kept = true;"),
    ("one permit is enough to begin", "axguard_board.h", "AXG_BOARD_PERMITS_FIRST 3U",
     "AXG_BOARD_PERMITS_FIRST 1U"),
    ("hashes may differ", BOARD, "(board->hashes_equal == AXG_BOARD_ALL_HASHES)", "true"),
    ("the word stop needs a known echo", PERMIT, "if (board->has_moved) {",
     "if (board->has_moved && (record != NULL)) {"),
    ("the stop frame with a byte is none", BOARD,
     "if (frame->id == board->options.stop_id) {",
     "if ((frame->id == board->options.stop_id) && (frame->length == 0U)) {"),
    ("a stopped board takes permits", PERMIT, "} else if (board->phase != AXG_BOARD_ARMED) {",
     "} else if (false) {"),
    ("arming without rest", BOARD, "< axg_board_rest_us(board)) {", "< 1U) {"),
    ("motion without a permit", BOARD,
     "axg_board_halt(board, AXG_BOARD_CAUSE_NOT_PERMITTED);", "board->has_moved = true;"),
    ("a tool change at once", BOARD, "- board->tool_us) >= horizon_us)",
     "- board->tool_us) >= 0U)"),
    ("a tool change without a permit", BOARD, "return motion.may_move && (board->tool",
     "return (board->phase == AXG_BOARD_ARMED) && (board->tool"),
    ("a stamp moves the clock", BOARD, "    bool is_next = is_sync;\n",
     "    bool is_next = is_sync;\n    axg_board_observe(board, sample->latched_us);\n"),
    ("a sample that is stamped ahead permits", PERMIT,
     "(record->sample.latched_us <= board->now_us)", "true"),
    ("a number comes again after a latch out of order", BOARD,
     "if (is_sync && board->has_reference) {", "if (is_sync && board->has_newest) {"),
    ("a change keeps the row", BOARD,
     "    board->permits_in_a_row = 0U;\n    board->forgotten_us", "    board->forgotten_us"),
    ("groups without an axis delay the ack", CAPS,
     "(group < board->options.axis_count) ? wanted->of[group] : 0U", "wanted->of[group]"),
    ("a raise above a stop", CAPS, "(board->phase == AXG_BOARD_ARMED) && board->has_end &&",
     "true &&"),
    ("a capture before now is an hour ahead", BOARD,
     "(passed > missing) && (last_us >= missing)", "false"),
    ("a tool change after a stop", BOARD, "        board->tool = AXG_BOARD_TOOL_CANCELLED;\n",
     ""),
    ("V is the ordered cap before its ack", CAPS,
     "return is_covered;", "return true;"),
    ("rule (iii) looks at the bound of now", CAPS,
     "board->keeps.of[i] = cap;\n",
     "board->keeps.of[i] = cap;\n"
     "for (uint32_t r = 0U; r < AXG_BOARD_RECORDS; ++r) {\n"
     "board->records[r].highest.of[i] = cap; }\n"),
    ("a raise leaves the samples before it", CAPS,
     "*highest = (cap > *highest) ? cap : *highest;", "(void)highest;"),
    ("rule (iv) drops nothing: raises on any permit", CAPS,
     "(board->last.end_us == board->end_us) &&", "true &&"),
    ("axes rise while others slow down", CAPS,
     "(board->last.end_us == board->end_us) &&\n"
     "           axg_board_is_below(&board->keeps, &board->last.caps);",
     "(board->last.end_us == board->end_us);"),
    ("rule (i): the newest order is named at once", CAPS,
     "board->ordered.is_given && axg_board_is_below(&board->keeps, &board->ordered.caps)",
     "board->ordered.is_given"),
    ("a raise names an older permit again", CAPS, "board->is_newest_counted &&", "true &&"),
    ("rule (ii): a raise above what was ordered", CAPS,
     "(asked < most) ? asked : most;", "asked; (void)most;"),
    ("a stale stamp has the bound of now", CAPS,
     "record->sample.latched_us >= board->keeps_us", "true"),
]


def build_and_play(compiler, folder, root):
    sources = sorted(str(path) for path in (folder / ROOM).glob("*.c"))
    program = folder / "play"
    subprocess.run([compiler, "-std=c99", "-O0", "-w", f"-I{folder}", "-o", str(program), *sources,
                    str(root / "tests/vectors/play_permit2.c")], check=True)
    run = subprocess.run([str(program), str(root / "tests/vectors/permit2.json")],
                         stdout=subprocess.PIPE, text=True, check=False)
    return run.returncode, run.stdout


def main():
    root, compiler = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
    if shutil.which(compiler) is None:
        print(f"skipped: no {compiler}")
        sys.exit(SKIPPED)
    faults = []
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        shutil.copytree(root / ROOM, folder / ROOM)
        code, text = build_and_play(compiler, folder, root)
        if code != 0:
            faults.append("the library as it is:\n" + text)
        for what, file, old, new in ABLATIONS:
            path = folder / ROOM / file
            whole = path.read_text()
            if whole.count(old) != 1:
                faults.append(f"{what}: {whole.count(old)} x in {file}: {old}")
                continue
            path.write_text(whole.replace(old, new))
            code, text = build_and_play(compiler, folder, root)
            path.write_text(whole)
            first = text.split("\n", 1)[0].split(": ")[0]
            print(f"{what}: {'found by: ' + first if code == 1 else 'NOT FOUND'}")
            if code != 1:
                faults.append(f"{what}: no script fails")
    for fault in faults:
        print(fault)
    print(f"{len(ABLATIONS) - len(faults)} passed, {len(faults)} failed")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
