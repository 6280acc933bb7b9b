#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs one of the scripts beside it in a whole aarch64 machine: qemu, Debian's own arm64 kernel
with its CAN modules, and the programs of a cross build. The guest's clock counts instructions, so
that a busy host makes it slow but never late.

boot_machine.py SCRIPT [ARGUMENT...]: with AXG_BUILD, AXG_SOURCE, and AXG_GUEST, the folder that
toolchains/sysroot.sh --guest makes. Exits with the script's status; 77 where qemu is missing."""
import os
import pathlib
import re
import shutil
import stat
import subprocess
import sys
import tempfile

from boot import MODULES

LIMIT_S = int(os.environ.get("AXG_VM_LIMIT_S", "280"))
# Nothing of these is read by the scripts.
LEFT_OUT = re.compile(r"^(boot|lib/modules|usr/share|var|usr/lib/modules|files\.txt|packages\.txt)"
                      r"|/__pycache__|\.pyc$|^usr/lib/aarch64-linux-gnu/(perl|gconv|gawk)"
                      r"|^usr/lib/(udev|systemd|firmware)")
QEMU = "qemu-system-aarch64"


class Archive:
    """A cpio archive in the form that the kernel unpacks its first root folder from ("newc")."""

    def __init__(self, path):
        self.file = open(path, "wb")
        self.number = 0

    def add(self, name, mode, data=b"", device=(0, 0)):
        self.number += 1
        name = name.encode() + b"\0"
        fields = (self.number, mode, 0, 0, 1, 0, len(data), 0, 0, *device, len(name), 0)
        head = b"070701" + b"".join(b"%08X" % field for field in fields) + name
        for part in (head, data):
            self.file.write(part + b"\0" * (-len(part) % 4))

    def add_path(self, path, name):
        mode = path.lstat().st_mode
        if stat.S_ISLNK(mode):
            self.add(name, mode, os.readlink(path).encode())
        elif stat.S_ISDIR(mode):
            self.add(name, mode)
        else:
            self.add(name, mode, path.read_bytes())

    def add_tree(self, folder, name, left_out=re.compile("(?!)")):
        for path in sorted(folder.rglob("*")):
            inside = str(path.relative_to(folder))
            if not left_out.search(inside):
                self.add_path(path, f"{name}{inside}")

    def end(self):
        self.number = -1
        self.add("TRAILER!!!", 0)
        self.file.close()


def settings(guest):
    modules = []
    for name in MODULES:
        modules += [f"/modules/{path.name}" for path in sorted(guest.rglob(name + ".ko"))]
    keep = {key: value for key, value in os.environ.items()
            if key.startswith("AXG_") and key not in ("AXG_BUILD", "AXG_SOURCE", "AXG_GUEST")}
    keep.update(AXG_BUILD="/axguard/build", AXG_SOURCE="/axguard/source", AXG_VM_OUT="/out",
                AXG_VM_LIMIT_S=str(LIMIT_S),
                AXG_VM_MODULES=" ".join(modules), PATH="/usr/sbin:/usr/bin")
    return "\0".join(f"{key}={value}" for key, value in keep.items())


def write_root(path, guest, build, source):
    archive = Archive(path)
    archive.add("dev", stat.S_IFDIR | 0o755)
    archive.add("dev/console", stat.S_IFCHR | 0o600, device=(5, 1))
    for folder in ("proc", "sys", "run", "out", "tmp", "modules", "axguard", "axguard/build",
                   "axguard/build/can_vm", "axguard/source", "axguard/source/config",
                   "axguard/source/config/machines", "axguard/can_vm"):
        archive.add(folder, stat.S_IFDIR | 0o755)
    archive.add("out/settings", stat.S_IFREG | 0o644, settings(guest).encode())
    archive.add_tree(guest, "", LEFT_OUT)
    for name in MODULES:
        for module in sorted(guest.rglob(name + ".ko")):
            archive.add_path(module, f"modules/{module.name}")
    for program in ("axguard", "axguardd"):
        archive.add_path(build / program, f"axguard/build/{program}")
    archive.add_tree(build / "can_vm", "axguard/build/can_vm/")
    archive.add_tree(source / "config/machines", "axguard/source/config/machines/")
    archive.add_tree(source / "tests/can_vm", "axguard/can_vm/")
    archive.end()


def main():
    script, arguments = sys.argv[1], sys.argv[2:]
    if not shutil.which(QEMU):
        print(f"skipped: no {QEMU}; ./setup.sh --all installs it (qemu-system-arm)")
        return 77
    guest, build = pathlib.Path(os.environ["AXG_GUEST"]), pathlib.Path(os.environ["AXG_BUILD"])
    if not guest.is_dir():
        print(f"skipped: no {guest}; toolchains/sysroot.sh --guest makes it")
        return 77
    kernel = sorted(guest.glob("boot/vmlinuz-*"))[-1]
    with tempfile.TemporaryDirectory(prefix="axg-can-machine-") as temporary:
        root = pathlib.Path(temporary, "root.cpio")
        write_root(root, guest, build, pathlib.Path(os.environ["AXG_SOURCE"]))
        words = " ".join(["console=ttyAMA0 quiet panic=-1 rdinit=/usr/bin/python3 --", "-B",
                          "/axguard/can_vm/guest.py", "/out", f"/axguard/can_vm/{script}",
                          *arguments, "end"])
        command = [QEMU, "-M", "virt", "-cpu", "cortex-a72", "-smp", "1", "-m", "1G",
                   "-icount", "shift=1,sleep=off", "-display", "none", "-serial", "stdio",
                   "-monitor", "none", "-net", "none", "-no-reboot", "-kernel", kernel,
                   "-initrd", root, "-append", words]
        try:
            run = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                 errors="replace", timeout=LIMIT_S)
            said = run.stdout
        except subprocess.TimeoutExpired as late:
            print((late.stdout or b"").decode(errors="replace")[-3000:])
            print(f"boot_machine.py: the guest did not end within {LIMIT_S} s")
            return 1
    found = re.search(r"axguard guest: (.*)axguard guest ended: (\d+)", said, re.S)
    if not found:
        print(said[-3000:], run.stderr[-1000:])
        print("boot_machine.py: the guest ended by itself; its last words are above")
        return 1
    print(found.group(1), end="")
    return int(found.group(2))


if __name__ == "__main__":
    sys.exit(main())
