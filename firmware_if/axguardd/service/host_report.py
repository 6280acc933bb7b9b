# SPDX-License-Identifier: Apache-2.0
"""Measures whether this computer can run a guard, and writes what it is into one file: board,
kernel, clocks, driver of the CAN interface, doctor, wake-up latency and admission. It sends nothing
on the bus, changes no setting, and names neither host nor user.

Example: python3 host_report.py can0 --bus-cpu 3 --engine-cpu 2 --seconds 600"""
import argparse
import json
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

MACHINE = "/usr/share/axguard/config/machines/paper-trunnion.yaml"
SAMPLE = "/etc/axguard/sample.yaml"


def text_of(path):
    """A small file of /proc or /sys without its last blank or zero; empty: it is not there."""
    try:
        return pathlib.Path(path).read_text(encoding="utf-8", errors="replace").strip("\0\n ")
    except OSError:
        return ""


def link_name(path):
    try:
        return os.path.basename(os.readlink(path))
    except OSError:
        return ""


def first_of(*texts):
    return next((text for text in texts if text), "unknown")


def computer():
    """What a buyer compares."""
    info = text_of("/proc/cpuinfo")
    model = re.search(r"^model name\s*:\s*(.+)$", info, re.M)
    memory = re.search(r"^MemTotal:\s*(\d+)", text_of("/proc/meminfo"), re.M)
    return {"board": first_of(text_of("/proc/device-tree/model"),
                              text_of("/sys/class/dmi/id/product_name")),
            "processor": first_of(model.group(1).strip() if model else "",
                                  text_of("/proc/device-tree/compatible").replace("\0", " ")),
            "processors": os.cpu_count(),
            "architecture": platform.machine(),
            "memory_mb": int(memory.group(1)) // 1024 if memory else None}


def clocks():
    """Least, most and present clock of each policy in kHz; the mode of a Jetson."""
    policies = {}
    for folder in sorted(pathlib.Path("/sys/devices/system/cpu/cpufreq").glob("policy*")):
        policies[folder.name] = {key: text_of(folder / f"scaling_{key}")
                                 for key in ("governor", "min_freq", "max_freq", "cur_freq")}
    mode = ""
    if shutil.which("nvpmodel"):
        mode = subprocess.run(["nvpmodel", "-q"], text=True, capture_output=True,
                              check=False).stdout.strip()
    return {"policies": policies, "nvpmodel": mode, "l4t": text_of("/etc/nv_tegra_release")}


def can_driver(bus):
    folder = pathlib.Path("/sys/class/net") / bus / "device"
    return {"interface": bus, "driver": link_name(folder / "driver"),
            "behind": link_name(folder / "subsystem")}


def ask(command, *options):
    """The document that a command of axguardd writes, and its exit code; its text is shown."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder, "document.json")
        code = subprocess.run(["axguardd", command, *options, f"--json={file}"],
                              check=False).returncode
        return json.loads(file.read_text(encoding="utf-8")) if file.exists() else None, code


def threads(arguments):
    return [word for name in ("bus_cpu", "engine_cpu") if getattr(arguments, name) is not None
            for word in (f"--{name.replace('_', '-')}", str(getattr(arguments, name)))]


def parse():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("bus", metavar="BUS", help="CAN interface, such as can0")
    parser.add_argument("--machine", help="machine file or compiled machine of the admission "
                                          f"[default: {MACHINE}, else {SAMPLE}]")
    parser.add_argument("--seconds", type=float, default=60,
                        help="duration of the latency test, s [default: 60]")
    parser.add_argument("--bus-cpu", type=int, help="CPU of the bus thread")
    parser.add_argument("--engine-cpu", type=int, help="CPU of the engine thread")
    parser.add_argument("-o", "--output", default="result.json",
                        help="file to write [default: result.json]")
    return parser.parse_args()


def main():
    arguments = parse()
    machine = arguments.machine or (MACHINE if os.path.exists(MACHINE) else SAMPLE)
    if not shutil.which("axguardd"):
        sys.exit("host_report.py: axguardd is not in PATH. Install the package axguardd.")
    doctor, _ = ask("doctor", "--bus", arguments.bus, *threads(arguments))
    cpu = [] if arguments.bus_cpu is None else ["--cpu", str(arguments.bus_cpu)]
    latency, _ = ask("latency-test", "--seconds", str(arguments.seconds), *cpu)
    with tempfile.TemporaryDirectory() as state:
        admit, code = ask("admit", machine, "--bus", arguments.bus, "--state-dir", state,
                          *threads(arguments))
    if doctor is None or latency is None or admit is None:
        sys.exit("host_report.py: no result: a command above could not be run.")
    admit.pop("host")
    result = {"axguard_host_report": 1, "computer": computer(), "kernel": admit["kernel"],
              "preempt_rt": text_of("/sys/kernel/realtime") == "1"
              or "PREEMPT_RT" in admit["kernel"],
              "clocks": clocks(), "can": can_driver(arguments.bus), "doctor": doctor,
              "latency": latency, "admit": admit}
    pathlib.Path(arguments.output).write_text(json.dumps(result, indent=1) + "\n",
                                              encoding="utf-8")
    print(f"{arguments.output}: {admit['verdict']}")
    sys.exit(code)


if __name__ == "__main__":
    main()
