# SPDX-License-Identifier: Apache-2.0
"""Judges where the joints of a LinuxCNC have been: every servo period's positions as a trace, and
`axguard replay --mode contact` of it, which knows nothing of the run. Frames by docs/reference/
protocol.md, written here again."""
import json
import pathlib
import subprocess


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ 0x1021 if crc & 0x8000 else crc << 1) & 0xFFFF
    return crc


def trace_of(positions, tools, changes, path, period_us):
    """[periods][X, Y, Z, A, C] in mm and degrees. Each has the number of its tool, and whether the
    tool may change in it."""
    with open(path, "w", encoding="ascii") as out:
        before = None
        for number, (position, tool, changing) in enumerate(zip(positions, tools, changes,
                                                                 strict=True)):
            time_s = 1000 + number * period_us * 1e-6
            sync = number % 240 + 1
            body = bytearray([number & 255, 0])
            for axis, value in enumerate(position):
                count = round((value % 360 if axis == 4 else value) * 1e4)
                body += (count % 3600000 if axis == 4 else count).to_bytes(4, "little",
                                                                           signed=True)
            body += (number * period_us & 0xFFFFFFFF).to_bytes(4, "little")
            body += tool.to_bytes(2, "little")
            body += bytes([2 if changing else 0 if position == before else 1, sync])
            body += bytes(30 - len(body))
            before = position
            crc = crc16(bytes(body) + (0x181).to_bytes(2, "little"))
            out.write(f"({time_s:.6f}) can0 080#{sync:02X}\n({time_s + 150e-6:.6f}) can0 181##0"
                      f"{(crc.to_bytes(2, 'little') + body).hex().upper()}\n")
            if number % max(1, 10000 // period_us) == 0:
                out.write(f"({time_s + 300e-6:.6f}) can0 701#05\n")


def contacts_of(positions, tools, changes, machine, meshes, folder, axguard, period_us=1000):
    """The stops of the replay, and how many samples it judged."""
    folder = pathlib.Path(folder)
    text = pathlib.Path(machine).read_text(encoding="utf-8")
    text = text.replace("hashes: required", "hashes: none")
    judge = folder / "judge.yaml"
    judge.write_text(text, encoding="utf-8")
    trace = folder / "path.log"
    trace_of(positions, tools, changes, trace, period_us)
    answer = subprocess.run(
        [axguard, "replay", judge, trace, "--mesh-root", meshes, "--mode", "contact", "--engine",
         "cpu", "--deadline-us", "10000000", "--json"], capture_output=True, text=True,
        check=False)
    if answer.returncode not in (0, 10):
        raise RuntimeError(answer.stdout + answer.stderr)
    said = json.loads(answer.stdout)
    return said
