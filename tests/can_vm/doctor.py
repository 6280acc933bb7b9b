# SPDX-License-Identifier: Apache-2.0
"""axguardd doctor asks a real kernel about its interfaces, by netlink and /sys."""
import json
import subprocess

from vm_bus import BUILD, expect


def doctor(bus):
    """Exit code, and what was found by subject."""
    run = subprocess.run([BUILD / "axguardd", "doctor", "--bus", bus, "--json"],
                         capture_output=True, text=True)
    found = {check["subject"]: check for check in json.loads(run.stdout)["checks"]}
    return run.returncode, found


code, found = doctor("vcan0")
expect(found["vcan0"]["found"] == "up", found)
expect(found["vcan0 kind"]["found"].startswith('"vcan"'), "netlink was heard", found)
expect(found["locked memory"]["fitness"] == "OK", "process 1 has every capability", found)
expect(found["boot"]["fitness"] == "WARN", "the guest has just started", found)
expect(code == 0, code, found)
expect(doctor("vxcan1")[1]["vxcan1 kind"]["found"].startswith('"vxcan"'))

subprocess.run(["ip", "link", "set", "vcan0", "down"], check=True)
code, found = doctor("vcan0")
expect(code == 14 and found["vcan0"]["fitness"] == "BAD", code, found)
expect(found["vcan0"]["mend"] == "sudo ip link set vcan0 up", found["vcan0"])
subprocess.run(found["vcan0"]["mend"].removeprefix("sudo "), shell=True, check=True)
expect(doctor("vcan0")[0] == 0, "the command mends it")

expect(doctor("can7")[0] == 14, "no such interface")
code, found = doctor("lo")
expect(code == 14 and found["lo"]["found"] == "no CAN interface", code, found)
print("ok: doctor")
