#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The packaged examples of LinuxCNC start by one command of an ordinary user: installed into a
folder as the package installs them, with a LinuxCNC that only states its INI file, and one of them
in earnest, without a display, up to the guard's first permit.

example_test.py SOURCE BUILD"""
import os
import pathlib
import pty
import pwd
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

from place import NotPossible, module

SKIPPED = 77
STARTER = "bin/axguard-linuxcnc-example"
PORT = 5007  # of linuxcncrsh
LIMIT_S = 90


def user():
    return pwd.getpwnam("nobody") if os.geteuid() == 0 else pwd.getpwuid(os.geteuid())


def become():
    os.setsid()
    if os.geteuid() == 0:
        os.setgroups([])
        os.setgid(user().pw_gid)
        os.setuid(user().pw_uid)


def environment(folder, **more):
    home = folder / "home"
    found = dict(os.environ, HOME=str(home), USER=user().pw_name, LOGNAME=user().pw_name,
                 PYTHONDONTWRITEBYTECODE="1", **more)
    found["PATH"] = f"{folder}/fake:{folder}/bin:{found['PATH']}"
    if "DISPLAY" not in more:
        found.pop("DISPLAY", None)
    return found


def check(is_true, *words):
    if not is_true:
        sys.exit("\n".join(["FAILED", *map(str, words)]))


def install(build, folder):
    subprocess.run(["cmake", "--install", build, "--component", "axguard-linuxcnc", "--prefix",
                    folder], check=True, stdout=subprocess.DEVNULL)
    (folder / "home").mkdir()
    for path in (folder, *folder.rglob("*")):
        path.chmod(0o755 if path.is_dir() or path.parent.name == "bin" else 0o644)
    os.chown(folder / "home", user().pw_uid, user().pw_gid)


def starts_with_its_files(folder):
    """What LinuxCNC is given: an INI file in the user's folder, with every file that it names."""
    fake = folder / "fake"
    fake.mkdir()
    (fake / "linuxcnc").write_text("#!/bin/sh\npwd\necho \"$1\"\n", encoding="ascii")
    (fake / "linuxcnc").chmod(0o755)
    for example in sorted(os.listdir(folder / "share/doc/axguard-linuxcnc/examples")):
        for display, wanted in ((":0", "axis"), ("", "linuxcncrsh"), (":0", "axis")):
            more = {"DISPLAY": display} if display else {}
            done = subprocess.run([folder / STARTER, example], env=environment(folder, **more),
                                  text=True, capture_output=True, preexec_fn=become, check=False)
            check(done.returncode == 0, done)
            place, ini = done.stdout.splitlines()[-2:]
            text = pathlib.Path(ini).read_text(encoding="utf-8")
            check(f"\nDISPLAY = {wanted}\n" in text, ini, text)
            meshes = re.search(r"^MESHES = (.+)$", text, re.M)[1]
            for key in ("MACHINE", "HALFILE", "TOOL_TABLE"):
                name = re.findall(rf"^{key} = (.+\..+)$", text, re.M)[-1]
                check((pathlib.Path(place) / name).is_file(), key, name, os.listdir(place))
            machine = (pathlib.Path(place) / f"{example}.yaml").read_text(encoding="utf-8")
            for name in re.findall(r"file: ([^,}\s]+)", machine):
                check((pathlib.Path(meshes) / name).is_file(), "mesh", name)
    done = subprocess.run([folder / STARTER, "nonsense"], env=environment(folder), text=True,
                          capture_output=True, preexec_fn=become, check=False)
    check(done.returncode == 2 and "paper-trunnion" in done.stderr, done)
    (fake / "linuxcnc").unlink()
    print("ok: each example is given its files, with a display and without")


class Shell:
    """A session of linuxcncrsh."""

    def __init__(self):
        end = time.monotonic() + LIMIT_S
        while True:
            try:
                self.socket = socket.create_connection(("localhost", PORT), timeout=10)
                break
            except OSError:
                check(time.monotonic() < end, "linuxcncrsh did not open its port")
                time.sleep(0.5)

    def put(self, line):
        self.socket.sendall(line.encode() + b"\r\n")
        time.sleep(0.5)


def pin(folder, *words):
    done = subprocess.run(["halcmd", *words], env=environment(folder), text=True,
                          capture_output=True, preexec_fn=become, check=False)
    return done.stdout.strip()


def gets_a_permit(folder):
    """As its page of man states it."""
    master, slave = pty.openpty()
    process = subprocess.Popen([folder / STARTER], env=environment(folder), cwd=folder, stdin=slave,
                               stdout=slave, stderr=slave, preexec_fn=become)
    os.close(slave)
    os.set_blocking(master, False)
    try:
        shell = Shell()
        for line in ("hello EMC example 1.0", "set enable EMCTOO", "set estop off",
                     "set machine on", "set mode manual", *(f"set home {i}" for i in range(5))):
            shell.put(line)
        end = time.monotonic() + LIMIT_S
        while pin(folder, "getp", "axguard-stop.permit-ok") != "TRUE":
            check(time.monotonic() < end, "no permit",
                  pin(folder, "show", "pin", "axguard"), read(master))
            pin(folder, "setp", "axguard-stop.arm", "0")
            time.sleep(0.3)
            pin(folder, "setp", "axguard-stop.arm", "1")
            time.sleep(1)
        shell.put("shutdown")
    finally:
        wait_for_end(process, master)
    print("ok: paper-trunnion starts without a display, and gets a permit")


def read(master):
    try:
        return os.read(master, 100_000).decode(errors="replace")
    except OSError:
        return ""


def wait_for_end(process, master):
    """A terminal that nobody reads would hold what prints to it. What does not end by itself is
    ended, and its shared memory, which the next LinuxCNC would find, is removed."""
    end = time.monotonic() + 30
    while process.poll() is None and time.monotonic() < end:
        read(master)
        time.sleep(0.1)
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        subprocess.run(["pkill", "-KILL", "-u", str(user().pw_uid), "-f", "rtapi_app|milltask|"
                        "linuxcncsvr|linuxcncrsh|axguard-hal"], check=False)
        for key in ("0x48484c34", "0x48414c32", "0x00000064"):  # of HAL, RTAPI and motion
            subprocess.run(["ipcrm", "-M", key], stderr=subprocess.DEVNULL, check=False)
        pathlib.Path("/tmp/linuxcnc.lock").unlink(missing_ok=True)
    os.close(master)


def main():
    build = pathlib.Path(sys.argv[2])
    if not (build / "axguard-hal").exists():
        print("skipped: axguard-hal is not built (install linuxcnc-uspace-dev)")
        sys.exit(SKIPPED)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        install(build, folder)
        starts_with_its_files(folder)
        try:
            with module(build):
                gets_a_permit(folder)
        except NotPossible as reason:
            print(f"skipped: {reason}")
            sys.exit(SKIPPED)


if __name__ == "__main__":
    main()
