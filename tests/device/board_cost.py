#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the board library costs on a Cortex-M4: bytes of code and of RAM, the deepest stack of one
function, and instructions of each call, counted in qemu's trace. Instructions are no cycles: a load
or a taken branch takes more than one. The record is in firmware_if/board/README.md.

Example: board_cost.py ."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
CALLS = {2: "axg_board_latch", 4: "axg_board_frame, plain", 5: "axg_board_frame, inverted, used",
         7: "axg_board_frame, inverted, wrong answer", 8: "axg_board_may_move",
         9: "axg_board_keeps, all bounds rise", 10: "axg_board_encode_classical, 5 axes",
         11: "axg_board_encode_fd, 5 axes", 12: "axg_board_encode_session",
         13: "axg_board_frame, stop"}
SCRIPT = """ENTRY(reset)
SECTIONS {
  .text 0x0 : { KEEP(*(.vectors)) *(.text*) *(.rodata*) }
  .bss 0x20000000 : { *(.data*) *(.bss*) *(COMMON) }
  axg_stack_top = 0x20010000;
}
"""


def instructions(elf, folder):
    """By call: the most instructions between its marks; and whether the program was content."""
    names = subprocess.run(["arm-none-eabi-nm", elf], capture_output=True, text=True, check=True)
    address = {name: int(at, 16) for at, _, name in
               (line.split() for line in names.stdout.split("\n") if line.count(" ") == 2)}
    log = folder / "trace"
    subprocess.run(["qemu-system-arm", "-M", "mps2-an386", "-nographic", "-semihosting",
                    "-singlestep", "-d", "exec,nochain,cpu", "-D", log, "-kernel", elf],
                   check=True, timeout=120, stdout=subprocess.DEVNULL)
    counts, what, count, r0, ends = {}, None, 0, 0, None
    for line in log.open():
        if line.startswith("R00="):
            r0 = int(line[4:12], 16)
            if what == "entered":
                what, count = r0, 0
            continue
        match = re.match(r"Trace \d+: .*?\[[0-9a-f]+/([0-9a-f]+)/", line)
        if not match:
            continue
        pc = int(match.group(1), 16)
        if pc == address["axg_mark_begin"]:
            what = "entered"
        elif pc == address["axg_mark_end"] and isinstance(what, int):
            counts[what] = max(counts.get(what, 0), count)
            what = None
        else:
            count += 1
        ends = what
    return counts, ends


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    for tool in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(tool) is None:
            print(f"skipped: {tool} is not installed")
            sys.exit(SKIPPED)
    sources = sorted(str(path) for path in (root / "firmware_if/board").glob("*.c"))
    good = True
    for level in ("-Os", "-O2"):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            flags = ["arm-none-eabi-gcc", "-std=c99", "-mcpu=cortex-m4", "-mthumb", level,
                     "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror", f"-I{root}"]
            subprocess.run([*flags, "-fstack-usage", "-c", *sources], cwd=folder, check=True)
            objects = sorted(str(path) for path in folder.glob("*.o"))
            size = subprocess.run(["arm-none-eabi-size", "-t", *objects], capture_output=True,
                                  text=True, check=True).stdout.strip().split("\n")[-1].split()
            stack = max(int(line.split("\t")[1]) for path in folder.glob("*.su")
                        for line in path.read_text().strip().split("\n"))
            (folder / "script.ld").write_text(SCRIPT)
            elf = folder / "cost.elf"
            subprocess.run([*[flag for flag in flags if flag != "-pedantic"], "-Wno-conversion",
                            "-fno-tree-loop-distribute-patterns", "-nostdlib", "-Tscript.ld",
                            "-o", elf, str(root / "tests/device/board_cost.c"), *objects,
                            "-lgcc"], cwd=folder, check=True)
            table = subprocess.run(["arm-none-eabi-nm", "-S", elf], capture_output=True, text=True,
                                   check=True).stdout
            ram = int(re.search(r"^\w+ (\w+) [bBdD] board$", table, re.M).group(1), 16)
            counts, ends = instructions(elf, folder)
            print(f"{level}: code and tables {size[0]} bytes, static data "
                  f"{int(size[1]) + int(size[2])}, axg_board {ram}, deepest frame of a function "
                  f"{stack} bytes")
            base = counts.get(1, 0)
            for what, call in CALLS.items():
                print(f"  {call}: {counts.get(what, 0) - base} instructions")
            good = good and ends == 0 and set(CALLS) <= set(counts)
    print("2 passed, 0 failed" if good else "the program or its trace is not as expected")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
