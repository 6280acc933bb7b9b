# SPDX-License-Identifier: Apache-2.0
"""Stands in for systemd in the guest, as far as two pages of the guide need it (pages.py), for
axguardd@BUS. It starts what the unit and its drop-ins start, with the unit's limits and folders
and as a user without rights; the sandbox it leaves out. Its journal is root's, as systemd's is."""
import os
import pathlib
import resource
import shlex
import signal
import subprocess
import sys

BUILD = pathlib.Path(os.environ["AXG_BUILD"])
FOLDER = pathlib.Path("/run/page")
JOURNAL, PROCESS = FOLDER / "journal", FOLDER / "service.pid"
UNIT = BUILD / "firmware_if/axguardd/axguardd@.service"
DROP_INS = pathlib.Path("/etc/systemd/system/axguardd@.service.d")
NOBODY = 65534


def exec_start():
    """As systemd reads it: an empty one forgets those before it."""
    command = ""
    for path in (UNIT, *sorted(DROP_INS.glob("*.conf"))):
        for line in path.read_text().splitlines():
            if line.startswith("ExecStart="):
                command = line.partition("=")[2]
    return command


def options_of(bus):
    path = pathlib.Path(f"/etc/axguard/{bus}.env")
    lines = path.read_text().splitlines() if path.exists() else []
    settings = dict(line.partition("=")[::2] for line in lines)
    return settings.get("AXGUARD_OPTIONS", "")


def become_service():
    resource.setrlimit(resource.RLIMIT_RTPRIO, (99, 99))
    resource.setrlimit(resource.RLIMIT_MEMLOCK, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    os.setsid()
    os.setgroups([])
    os.setgid(NOBODY)
    os.setuid(NOBODY)


def start(bus):
    for folder in ("/var/lib/axguardd", f"/run/axguardd/{bus}"):
        os.makedirs(folder, exist_ok=True)
        os.chown(folder, NOBODY, NOBODY)
    command = exec_start().replace("%i", bus).replace("$AXGUARD_OPTIONS", options_of(bus))
    program, *words = shlex.split(command)
    with open(JOURNAL, "wb") as journal:
        JOURNAL.chmod(0o600)
        service = subprocess.Popen(
            [BUILD / pathlib.Path(program).name, *words, *os.environ["AXG_PAGE_OPTIONS"].split()],
            stdout=journal, stderr=journal, stdin=subprocess.DEVNULL, preexec_fn=become_service)
    PROCESS.write_text(str(service.pid))


def main():
    words = sys.argv[1:]
    if words[:2] == ["enable", "--now"]:
        _, _, bus = words[2].partition("@")
        start(bus)
    elif words[:2] == ["kill", "-s"]:
        os.kill(int(PROCESS.read_text()), signal.Signals["SIG" + words[2]])
    elif words[0] not in ("daemon-reload", "enable", "mask"):
        sys.exit(f"the guest's systemctl cannot {words}")


main()
