#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs one of the scripts beside it where SocketCAN exists: in user-mode Linux, a kernel that is a
program (Debian: user-mode-linux), which sees the host's files read-only. A boot takes 0.3 s.

boot.py SHIM SCRIPT [ARGUMENT...]: exits with the script's status; 77 where there is no such kernel.
The script runs as process 1 of the guest (guest.py) and may write in $AXG_VM_OUT, which is a folder
of the host, and in /run. What it leaves in $AXG_VM_OUT/kept is copied to $AXG_VM_KEEP."""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

LIMIT_S = int(os.environ.get("AXG_VM_LIMIT_S", "840"))  # a record takes longer than a test
MODULES = ["can", "can-raw", "can-dev", "vcan", "vxcan", "slcan", "sch_netem", "overlay"]


def find_kernel():
    """Program and folder of modules, or what is missing."""
    program = shutil.which("linux.uml")
    if program is None:
        return None, None, "no user-mode Linux; ./setup.sh --all installs it (amd64)"
    folders = sorted(pathlib.Path("/usr/lib/uml/modules").glob("*/kernel"))
    if not folders:
        return None, None, "user-mode Linux without modules"
    return program, folders[-1], None


def module_files(folder):
    for name in MODULES:
        found = sorted(folder.rglob(name + ".ko"))
        if found:  # else it is built in
            yield str(found[0])


def memory_folder():
    """Where the guest's memory lies: a file that is run from."""
    room = shutil.disk_usage("/dev/shm").free if os.path.isdir("/dev/shm") else 0
    return "/dev/shm" if room > 600 << 20 else tempfile.gettempdir()


def settle(cpu):
    """One processor: user-mode Linux switches between processes at every system call, which is ten
    times slower between two. Before other programs, where that is allowed: its clock counts the
    processor time that it had (uml_shim.cpp), so a guest that waits takes longer. A guest that is
    never idle stands still too: of each second the host keeps 50 ms from programs in real time."""
    os.sched_setaffinity(0, {cpu})
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(10))
    except OSError:
        pass


def wait_for(run):
    """Like a busy host: stops it for AXG_VM_FROZEN_S [default: 0] after each half second."""
    frozen_s = float(os.environ.get("AXG_VM_FROZEN_S", "0"))
    end = time.monotonic() + LIMIT_S
    while frozen_s > 0 and time.monotonic() < end:
        try:
            run.wait(0.5)
            return
        except subprocess.TimeoutExpired:
            run.send_signal(signal.SIGSTOP)
            time.sleep(frozen_s)
            run.send_signal(signal.SIGCONT)
    run.wait(max(0.0, end - time.monotonic()))


def main():
    shim, script, arguments = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), sys.argv[3:]
    program, folder, missing = find_kernel()
    if missing:
        print(f"skipped: {missing}")
        return 77
    with tempfile.TemporaryDirectory(prefix="axg-can-vm-") as out:
        keep = ("AXG_", "PATH")
        settings = {key: value for key, value in os.environ.items() if key.startswith(keep)}
        settings.update(AXG_VM_OUT=out, AXG_VM_MODULES=" ".join(module_files(folder)),
                        AXG_VM_LIMIT_S=str(LIMIT_S))
        pathlib.Path(out, "settings").write_text(
            "\0".join(f"{key}={value}" for key, value in settings.items()))
        guest = pathlib.Path(__file__).with_name("guest.py")
        log = pathlib.Path(out, "kernel.log")
        cpus = sorted(os.sched_getaffinity(0))
        command = [program, "mem=512M", f"uml_dir={out}/", "rootfstype=hostfs", "rootflags=/", "ro",
                   "quiet", "con=null", "con0=null,fd:2", f"init={sys.executable}", "--", "-B",
                   str(guest), out, str(script), *arguments, "end"]
        with open(log, "wb") as sink:
            run = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=sink, stderr=sink,
                start_new_session=True, preexec_fn=lambda: settle(cpus[-1]),
                env={"PATH": os.environ["PATH"], "LD_PRELOAD": shim, "TMPDIR": memory_folder(),
                     "HOME": out})
            try:
                wait_for(run)
            except subprocess.TimeoutExpired:
                print(f"boot.py: the guest did not end within {LIMIT_S} s")
            finally:
                try:
                    os.killpg(run.pid, signal.SIGKILL)  # its helpers, if it ended badly
                except ProcessLookupError:
                    pass
                run.wait()
        if "AXG_VM_KEEP" in os.environ and pathlib.Path(out, "kept").exists():
            shutil.copytree(pathlib.Path(out, "kept"), os.environ["AXG_VM_KEEP"],
                            dirs_exist_ok=True)
        said = pathlib.Path(out, "said")
        print(said.read_text(errors="replace") if said.exists() else "", end="")
        status = pathlib.Path(out, "status")
        if not status.exists():
            words = log.read_text(errors="replace")
            print("\n".join(words.split("\n")[-40:]))
            if said.exists() or "guest.py" in words:
                print("boot.py: the guest ended by itself; its last words are above")
                return 1
            print("skipped: user-mode Linux does not start here (no ptrace?), its words are above")
            return 77
        return int(status.read_text())


if __name__ == "__main__":
    sys.exit(main())
