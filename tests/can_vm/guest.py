# SPDX-License-Identifier: Apache-2.0
"""Process 1 of the guest: mounts, loads the CAN modules, makes the interfaces, runs one script,
leaves its words and its status in the folder shared with the host, and switches the guest off. A
whole machine (boot_machine.py) shares no folder: its console takes them."""
import ctypes
import os
import subprocess
import sys
import traceback

LIBC = ctypes.CDLL(None, use_errno=True)
IS_PROGRAM = os.uname().machine == "x86_64"  # user-mode Linux; the whole machine is an aarch64
SYS_FINIT_MODULE = 313 if IS_PROGRAM else 273
POWER_OFF = 0x4321FEDC
READ_ONLY = 1


def mount(source, target, kind, options=""):
    if LIBC.mount(source.encode(), target.encode(), kind.encode(), 0, options.encode()) != 0:
        raise OSError(ctypes.get_errno(), f"mount {kind} on {target}")


def prepare(out):
    mount("proc", "/proc", "proc")
    mount("sys", "/sys", "sysfs")
    mount("run", "/run", "tmpfs", "mode=0755")
    if not IS_PROGRAM:
        mount("dev", "/dev", "devtmpfs")
    os.makedirs("/dev/pts", exist_ok=True)  # the kernel's own /dev comes without
    mount("devpts", "/dev/pts", "devpts")
    with open(out + "/settings") as file:
        os.environ.update(entry.split("=", 1) for entry in file.read().split("\0"))
    for path in os.environ["AXG_VM_MODULES"].split():
        with open(path, "rb") as module:
            if LIBC.syscall(SYS_FINIT_MODULE, module.fileno(), b"", 0) != 0:
                raise OSError(ctypes.get_errno(), f"load {path}")
    for words in ("link add vcan0 type vcan", "link set vcan0 mtu 72 up",
                  "link add vxcan0 type vxcan peer name vxcan1", "link set vxcan0 mtu 72 up",
                  "link set vxcan1 mtu 72 up", "link set lo up"):
        subprocess.run(["ip", *words.split()], check=True)
    for pid in filter(str.isdigit, os.listdir("/proc")):
        with open(f"/proc/{pid}/comm") as file:
            if file.read().startswith("ksoftirqd"):  # brings the frames: before whoever sends them
                os.sched_setscheduler(int(pid), os.SCHED_FIFO, os.sched_param(90))
    os.chdir("/run")


def main():
    words = sys.argv[1:]
    out, script, *arguments = words[:words.index("end")]  # the kernel adds words of its own
    status = 1
    if IS_PROGRAM:
        mount("out", out, "hostfs", out)
    try:
        prepare(out)
        with open(out + "/said", "wb") as said:
            status = subprocess.run([sys.executable, "-B", script, *arguments], stdout=said,
                                    stderr=subprocess.STDOUT).returncode
    except Exception:
        with open(out + "/said", "a") as said:
            traceback.print_exc(file=said)
    with open(out + "/status", "w") as file:
        file.write(str(status))
    if not IS_PROGRAM:
        with open(out + "/said") as said, open("/dev/console", "w") as console:
            console.write(f"axguard guest: {said.read()}axguard guest ended: {status}\n")
    os.sync()
    LIBC.reboot(ctypes.c_int(ctypes.c_int32(POWER_OFF).value))


main()
