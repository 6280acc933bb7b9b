#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The systemd unit as it is installed: systemd knows every word of it, and what it leaves open is
little. The score is that of `systemd-analyze security`: 0 is nothing, 10 everything."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from sources import finish, skip

EXPOSURE_MAX = 1.5


def main():
    build = pathlib.Path(sys.argv[2])
    unit = build / "firmware_if/axguardd/axguardd@.service"
    if shutil.which("systemd-analyze") is None:
        skip("no systemd-analyze (Debian: systemd)")
    with tempfile.TemporaryDirectory() as folder:
        text = unit.read_text()
        # Looked at before it is installed: the program where it was built.
        text = re.sub(r"^ExecStart=\S+", f"ExecStart={build / 'axguardd'}", text, flags=re.M)
        name = pathlib.Path(folder, "axguardd@can0.service")
        name.write_text(text)
        verify = subprocess.run(["systemd-analyze", "verify", "--man=no", "--recursive-errors=no",
                                 str(name)], capture_output=True, text=True)
        score = subprocess.run(["systemd-analyze", "security", "--offline=yes", "--no-pager",
                                str(name)], capture_output=True, text=True)
    faults = [line for line in verify.stderr.splitlines() if "axguardd" in line]
    if verify.returncode != 0 and not faults:
        faults = verify.stderr.splitlines()
    found = re.search(r"exposure level for \S+: ([0-9.]+)", score.stdout)
    if not found:
        skip("systemd-analyze cannot judge a file: " + score.stderr.strip())
    print("exposure", found.group(1))
    if float(found.group(1)) > EXPOSURE_MAX:
        faults.append(f"{unit.name}: exposure {found.group(1)}, wanted at most {EXPOSURE_MAX}")
    finish(faults)


if __name__ == "__main__":
    main()
