#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""axguard watch cannot send to a guard: no object of its room, nor the listener on the bus, calls
anything that writes to a socket, a pipe or a file descriptor, or a function of ours that does. HTTP
replies are libmicrohttpd's, on sockets that it accepted itself. The check first finds such a call
in an object that has one: a check that sees nothing would pass everything."""
import pathlib
import re
import subprocess
import sys

from sources import finish, skip

# Of libc, also in their fortified forms; io_uring and splice would be others.
SENDS = re.compile(r"^(__)?(send|sendto|sendmsg|sendmmsg|sendfile|sendfile64|write|writev|pwrite|"
                   r"pwrite64|pwritev|pwritev2|splice|vmsplice|tee|syscall|dprintf|fdopen)(_chk)?"
                   r"(@.*)?$")
OURS = re.compile(r"SocketCan::send|CanTransport|open_live_socket|StatusSocket::(serve|hand_over)|"
                  r"Outbox|GuardNode|encode_(permit|any_permit|stop|session|hash|emergency|"
                  r"operator|hints)")
# Encodes in memory, to compare an answer with.
HARMLESS = re.compile(r"axg::encode_any_permit\(")


def undefined(path):
    """Names that an object, or each object of an archive, takes from elsewhere."""
    text = subprocess.run(["nm", "-C", "--undefined-only", str(path)], text=True,
                          capture_output=True, check=True).stdout
    return sorted({line.split(None, 1)[1] for line in text.splitlines()
                   if line.strip().startswith(("U ", "w "))})


def sending(names):
    return [name for name in names
            if (SENDS.match(name) or OURS.search(name)) and not HARMLESS.search(name)]


def main():
    witness, *objects = (pathlib.Path(name) for name in sys.argv[2:])
    missing = [path.name for path in [witness, *objects] if not path.exists()]
    if missing:
        skip(f"not built: {', '.join(missing)}")
    faults = []
    if not any(SENDS.match(name) for name in undefined(witness)):
        faults.append(f"{witness.name}: no call that sends: this check would not see one elsewhere")
    for path in objects:
        faults += [f"{path.name}: calls {name}" for name in sending(undefined(path))]
    finish(faults)


if __name__ == "__main__":
    main()
