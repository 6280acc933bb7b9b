# SPDX-License-Identifier: Apache-2.0
"""axguardd board-test against a board on a real bus: one that keeps every rule passes, and of one
that ignores the stop frame that rule is named."""
import json
import pathlib
import subprocess

from vm_bus import BUILD, RUNNING, SOURCE, Busy, attempt, expect, machine_file

MESHES = SOURCE / "config/machines"
IGNORES_STOP_FRAME = "30"  # of tests/support/broken_rule.hpp


def play(broken, *options):
    """Exit code, report, and the keys for the machine file."""
    machine = machine_file(has_hashes=True)
    board = subprocess.Popen(["nice", "-n", "-15", BUILD / "tests/axg_bench_board", machine, MESHES,
                              "vcan0", broken], stdin=subprocess.PIPE, text=True)
    RUNNING.append(board)
    test = subprocess.Popen(
        [BUILD / "axguardd", "board-test", machine, "--mesh-root", MESHES, "--bus", "vcan0",
         "--local-board", "--state-dir", "/run", "--yes", "-o", "/run/report.json", "--write",
         "/run/keys.yaml", "--serial", "MB7-0012", *options],
        stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    RUNNING.append(test)
    said = []
    for line in test.stderr:  # the person does as told
        said.append(line)
        if "arm the board" in line:
            board.stdin.write("jog\n" if "Choose a slow jog" in line else "arm\n")
            board.stdin.flush()
    words = test.stdout.read()
    code = test.wait(20)
    board.kill()
    board.wait()
    report = pathlib.Path("/run/report.json")
    expect(report.exists(), "no report", code, *said)
    return code, json.loads(report.read_text()), words


def outcomes(report):
    return {rule["name"]: rule["outcome"] for rule in report["rules"]}


def check_busy(report):
    """The guest stood still: a sample, a session frame or a permit came too late."""
    of = outcomes(report)
    if "FAIL" in (of["samples"], of["session"]) or "unclear" in of.values():
        raise Busy([rule for rule in report["rules"] if rule["outcome"] in ("FAIL", "unclear")][:2])


def good_board_passes():
    code, report, words = play("0", "--jog")
    check_busy(report)
    expect(code == 0 and report["failed"] == 0, code, words)
    expect(report["passed"] > 35, "few rules were judged", words)
    keys = pathlib.Path("/run/keys.yaml").read_text()
    expect("board_reaction_ms:" in keys and "latch_jitter_us:" in keys and "  X: {" in keys, keys)
    record = json.loads(pathlib.Path("/run/vcan0.board-test.json").read_text())
    expect(record["serial"] == "MB7-0012" and record["passed"] == report["passed"] and
           set(record["hashes"]) == {"model", "kinematics", "tools", "limits"}, record)
    print(words, keys, record, flush=True)


def bad_board_is_named():
    code, report, words = play(IGNORES_STOP_FRAME, "--only", "stop_frame")
    check_busy(report)
    failed = [name for name, outcome in outcomes(report).items() if outcome == "FAIL"]
    expect(code == 14 and failed == ["stop_frame"], code, failed, words)


attempt(bad_board_is_named)
attempt(good_board_passes)
