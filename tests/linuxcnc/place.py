# SPDX-License-Identifier: Apache-2.0
"""Runs LinuxCNC without a display and without real time, as an ordinary user in a folder of its
own, with the example machine of firmware_if/linuxcnc/examples; and reads what its servo thread
recorded. LinuxCNC 2.9 refuses root, and wants a terminal."""
import contextlib
import fcntl
import json
import os
import pathlib
import pty
import pwd
import re
import select
import shutil
import signal
import subprocess
import time

MODULES = pathlib.Path("/usr/lib/linuxcnc/modules")
LOCK = "/tmp/axg-linuxcnc.lock"
SAMPLES = "samples.txt"
# Of the sampler, behind its own number: sample, five joints, permit-ok, stopping, left-us, mode,
# tool.
COLUMNS = "ufffffbbuuu"
INCH_MM = 25.4
# Keys of linear joints and axes that have the machine's unit.
LENGTHS = ("MIN_LIMIT", "MAX_LIMIT", "MAX_VELOCITY", "MAX_ACCELERATION", "HOME", "HOME_OFFSET",
           "MAX_LINEAR_VELOCITY", "DEFAULT_LINEAR_VELOCITY", "MAX_LINEAR_ACCELERATION",
           "DEFAULT_LINEAR_ACCELERATION", "FERROR", "MIN_FERROR")


@contextlib.contextmanager
def module(build):
    """The realtime component of this build where LinuxCNC looks for it, and nowhere else does it
    look. One that is installed already stays, if it is the same."""
    installed, built = MODULES / "axguard_stop.so", pathlib.Path(build) / "axguard_stop.so"
    with open(LOCK, "w", encoding="ascii") as lock:  # one LinuxCNC a host: its keys are fixed
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield from place_module(installed, built)


def place_module(installed, built):
    if installed.exists():
        if installed.read_bytes() != built.read_bytes():
            raise NotPossible(f"{installed} is another build's. Remove it.")
        yield
        return
    if not os.access(MODULES, os.W_OK):
        raise NotPossible(f"{MODULES} is not writable. Copy {built} there, or run as root.")
    shutil.copy(built, installed)
    try:
        yield
    finally:
        installed.unlink()


class NotPossible(Exception):
    """What has to be done before the test can run."""


class Place:
    """A folder with one LinuxCNC."""

    def __init__(self, folder, root, build, example):
        self.folder, self.build, self.name = pathlib.Path(folder), pathlib.Path(build), example
        self.example = root / "firmware_if/linuxcnc/examples" / example
        self.meshes = root / "config/machines"
        self.user = pwd.getpwnam("nobody") if os.geteuid() == 0 else pwd.getpwuid(os.geteuid())

    def prepare(self, program, guarded, simulation_wait_us, is_inch=False, is_gantry=False,
                lags=False, **scenario):
        self.unit_mm = INCH_MM if is_inch else 1
        self.joints = [0, 1, 3, 4, 5] if is_gantry else [0, 1, 2, 3, 4]  # of the recorded axes
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        shutil.copy(self.build / "axguard-hal", self.folder)
        shutil.copytree(self.meshes / "meshes", self.folder / "meshes")
        for file in self.example.iterdir():
            shutil.copy(file, self.folder)
        shutil.copy(pathlib.Path(__file__).parent / "display.py", self.folder)
        (self.folder / "display.py").chmod(0o755)
        (self.folder / "program.ngc").write_text(program, encoding="ascii")
        table = self.folder / f"{self.name}.tbl"
        rows = scenario.pop("table", table.read_text(encoding="ascii"))
        table.write_text(re.sub(r"\b([ZD])([\d.]+)", self.in_units, rows), encoding="ascii")
        (self.folder / "after.ngc").write_text(scenario.pop("after", "M2\n"), encoding="ascii")
        scenario.update(guarded=guarded)
        (self.folder / "scenario.json").write_text(json.dumps(scenario), encoding="utf-8")
        if is_gantry:
            self.add_second_y()
        self.write_ini()
        self.write_hal(guarded, simulation_wait_us)
        if lags:
            self.let_axes_lag()
        for path in (self.folder, *self.folder.rglob("*")):
            os.chown(path, self.user.pw_uid, self.user.pw_gid)

    def add_second_y(self):
        """Joints 1 and 2 move Y."""
        def shifted(match):
            return match[1] + str(int(match[2]) + (int(match[2]) > 1))

        self.rewrite("ini", (r"(\[JOINT_)(\d)", shifted), ("XYZAC", "XYYZAC"),
                     ("JOINTS = 5", "JOINTS = 6"),
                     (r"^\[JOINT_1\]([^[]*)", r"[JOINT_1]\1[JOINT_2]\1"))
        index = r"((?:joint\.|axguard-stop\.|\b(?:cmd|out|offset|homed|enable)-))"
        self.rewrite("hal", (index + r"(\d)\b", shifted),
                     (f"^net .*{index}1.*\n",
                      lambda match: match[0] + re.sub(index + "1", r"\g<1>2", match[0])))
        self.rewrite("yaml", ("  Y: {kind: linear, ", "  Y: {kind: linear, skew_mm: 0.1, "))

    def let_axes_lag(self):
        """Behind the command, as the axes of a machine do, by 5 ms."""
        self.rewrite("hal", ("^loadrt and2$", "loadrt and2\nloadrt lowpass count=5"),
                     (r"^net out-(\d) (\S+) => (\S+)$", r"net out-\1 \2 => lowpass.\1.in\n"
                      r"net lag-\1 lowpass.\1.out => \3\nsetp lowpass.\1.gain 0.2\n"
                      r"addf lowpass.\1 servo-thread"))

    def rewrite(self, suffix, *changes):
        file = self.folder / f"{self.name}.{suffix}"
        text = file.read_text(encoding="utf-8")
        for pattern, change in changes:
            text, count = re.subn(pattern, change, text, flags=re.MULTILINE)
            assert count, pattern
        file.write_text(text, encoding="utf-8")

    def write_ini(self):
        ini = self.folder / f"{self.name}.ini"
        text = ini.read_text(encoding="utf-8")
        text = text.replace("DISPLAY = axis", f"DISPLAY = {self.folder}/display.py")
        text = re.sub("MESHES = .*", f"MESHES = {self.folder}", text)
        text = text.replace(f"MACHINE = {self.name}.yaml",
                            f"MACHINE = {self.folder}/{self.name}.yaml")
        if self.unit_mm != 1:
            text = text.replace("LINEAR_UNITS = mm", "LINEAR_UNITS = inch")
            linear = r"^\[(TRAJ|DISPLAY|JOINT_[012]|AXIS_[XYZ])\]$[^[]*"
            text = re.sub(linear, self.section_in_units, text, flags=re.MULTILINE)
        ini.write_text(text, encoding="utf-8")

    def in_units(self, match):
        return f"{match[1]}{float(match[2]) / self.unit_mm:.12g}"

    def section_in_units(self, match):
        return re.sub(rf"^((?:{'|'.join(LENGTHS)}) *= *)(\S+)", self.in_units, match[0],
                      flags=re.MULTILINE)

    def write_hal(self, guarded, simulation_wait_us):
        """The example's file, with the component of this build and a record of each period."""
        hal = self.folder / f"{self.name}.hal"
        text = hal.read_text(encoding="utf-8")
        text = text.replace("loadrt axguard_stop joints=5",
                            f"loadrt sampler depth=16000 cfg={COLUMNS}\n"
                            "loadrt axguard_stop joints=5")
        if len(self.joints) < self.joints[-1] + 1:
            text = text.replace("joints=5", "coordinates=XYYZAC")
        text = text.replace("loadusr -W axguard-hal", f"loadusr -W {self.folder}/axguard-hal")
        text = text.replace("--simulation ", f"--simulation --record {self.folder}/run.log ")
        if simulation_wait_us == 0:
            text = text.replace("--simulation ", "")
        text = re.sub(r"(simulation-wait-us) \d+", rf"\1 {simulation_wait_us}", text)
        text = text.replace("addf and2.0 ", "addf sampler.0 servo-thread\naddf and2.0 ")
        if not guarded:  # the joints are where LinuxCNC sends them, and nobody is asked
            text = re.sub(r"loadusr -W .*|net program-line .*", "", text)
            text = re.sub(r"net out-(\d) .*\n", "", text)
            text = re.sub(r"net cmd-(\d) (\S+) => \S+",
                          r"net cmd-\1 \2 => joint.\1.motor-pos-fb sampler.0.pin.\1+1", text)
            text = re.sub(r"sampler\.0\.pin\.(\d)\+1",
                          lambda match: f"sampler.0.pin.{int(match[1]) + 1}", text)
            text = re.sub(r"net guard-(ok|inhibit|cap) .*\n", "", text)
            text = re.sub(r"net tool-(change|changed|number|out) .*\n", "", text)
            text += ("setp and2.0.in1 1\n"
                     "net tool-loop iocontrol.0.tool-change => iocontrol.0.tool-changed\n")
        else:
            for column, joint in enumerate(self.joints):
                text += (f"net position-{joint} axguard-stop.{joint}.position => "
                         f"sampler.0.pin.{column + 1}\n")
        text += ("net number axguard-stop.sample => sampler.0.pin.0\n"
                 "net permit axguard-stop.permit-ok => sampler.0.pin.6\n"
                 + ("net stopping axguard-stop.stopping => sampler.0.pin.7\n" if guarded else
                    "net inhibit motion.feed-inhibit sampler.0.pin.7\n") +
                 "net left axguard-stop.left-us => sampler.0.pin.8\n"
                 "net mode axguard-stop.mode => sampler.0.pin.9\n"
                 "net tool axguard-stop.tool => sampler.0.pin.10\n"
                 f"loadusr halsampler -t {self.folder}/{SAMPLES}\n")
        hal.write_text(text, encoding="utf-8")

    def run(self, limit_s):
        """Until the display program ends: what it said, and what LinuxCNC printed."""
        def become():
            os.setsid()
            if os.geteuid() == 0:
                os.setgroups([])
                os.setgid(self.user.pw_gid)
                os.setuid(self.user.pw_uid)

        master, slave = pty.openpty()
        environment = dict(os.environ, HOME=str(self.folder), USER=self.user.pw_name,
                           LOGNAME=self.user.pw_name, PYTHONDONTWRITEBYTECODE="1")
        environment.pop("DISPLAY", None)
        process = subprocess.Popen(
            ["linuxcnc", str(self.folder / f"{self.name}.ini")], cwd=self.folder,
            env=environment, stdin=slave, stdout=slave, stderr=slave, preexec_fn=become)
        os.close(slave)
        output = read_all(process, master, limit_s)
        result = self.folder / "result.json"
        said = json.loads(result.read_text(encoding="utf-8")) if result.exists() else {}
        return said, output

    def samples(self):
        """Rows of the record that are whole: [sample, X, Y, Z, A, C, permit, stopping, left, mode,
        tool]."""
        rows, overruns = [], 0
        for line in (self.folder / SAMPLES).read_text(encoding="ascii").splitlines():
            words = line.split()
            if "overrun" in words:
                overruns += 1
            elif len(words) == 1 + len(COLUMNS):
                joints = [float(word) * (self.unit_mm if i < 3 else 1)
                          for i, word in enumerate(words[2:7])]
                rows.append([int(words[1]), *joints, *map(int, words[7:])])
        return rows, overruns


def read_all(process, master, limit_s):
    output, end = bytearray(), time.time() + limit_s
    while True:
        ready, _, _ = select.select([master], [], [], 0.2)
        if ready:
            try:
                data = os.read(master, 65536)
            except OSError:  # the last process with the terminal has ended
                data = b""
            output += data
            if not data:
                break
        elif process.poll() is not None:
            break
        if time.time() > end:
            os.killpg(process.pid, signal.SIGTERM)
            output += b"\n(it took too long)\n"
            end = time.time() + 20
            limit_s = 0
    process.wait(timeout=30)
    os.close(master)
    return output.decode(errors="replace")
