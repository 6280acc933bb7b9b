# SPDX-License-Identifier: Apache-2.0
"""Three pages of the guide, read and obeyed: each block of commands runs as the user whom it names,
after a login of its own, in the order of the page. tests/style/guide_blocks.py describes how a page
marks its blocks, STAND_INS what replaces a thing that a guest has not.

pages.py PAGE: runs it.  pages.py broken: copies with one error each fail."""
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import threading
import time

from vm_bus import BUILD, BUSY, RUNNING, SOURCE, Busy, attempt, expect, machine_file

sys.path.insert(0, str(SOURCE / "tests/style"))
import guide_blocks  # noqa: E402

HERE = pathlib.Path(__file__).parent
FOLDER = pathlib.Path("/run/page")  # what the blocks print
PROGRAMS = FOLDER / "bin"
USER = "axguard-user"
HOME = pathlib.Path("/home", USER)
WORK = HOME / "axguard"
LIMIT_S = 60
UNFIT = "--admit-seconds 0.05 --admit-unfit latency,engine,cycle"
# What a guest that stood still prints; board-test judges that a board's samples came late.
STOOD_STILL = re.compile("|".join(map(re.escape, BUSY)) +
                         r"|^ ?\d+ (\S+ +unclear|(samples|session) +FAIL)")
# What is replaced in a block, by what, and why.
STAND_INS = (
    (r"(?<=^axguardd run)(.*)$", rf"\1 {UNFIT}", "the guest's clock is its host's"),
    (r" type can bitrate \d+ restart-ms 0", "", "can0 is an end of a vxcan pair"),
    (r" ?--bus-cpu \d --engine-cpu \d", "", "the guest has one processor"),
    (r" --cpu \d", "", "the guest has one processor"),
    (r"(?<=axguardd board-test)(.*)$", r"\1 --yes --only stop_frame",
     "one case of forty, and nobody to answer"),
    (r"(?<=axguardd proof-test)(.*)$", r"\1 --person-seconds 2", "nobody moves the machine"),
    (r"--seconds 600", "--seconds 1", "a test has no ten minutes"),
)


class Fault(Exception):
    """A block does not do what its page states."""


class Terminal:
    """A block's commands after a login, and what they print."""

    def __init__(self, block):
        self.place = block.place
        name = block.place.replace("/", "-")
        script, self.words = FOLDER / f"{name}.sh", FOLDER / f"{name}.txt"
        script.write_text(block.commands)
        user = {"user": USER, "root": "root"}[block.user]
        with open(self.words, "wb") as words:
            self.process = subprocess.Popen(
                ["su", "--login", user, "--session-command",
                 f"cd {WORK} && export TMPDIR={HOME} PATH={PROGRAMS}:{BUILD}:$PATH && "
                 f"exec bash -euo pipefail {script}"],
                stdin=subprocess.DEVNULL, stdout=words, stderr=words, start_new_session=True)
        RUNNING.append(self)

    def printed(self):
        return self.words.read_text(errors="replace")

    def send(self, number):
        try:
            os.killpg(self.process.pid, number)
        except ProcessLookupError:
            pass

    def interrupt(self):
        """Ctrl-C."""
        self.send(signal.SIGINT)
        self.wait()

    def kill(self):
        self.send(signal.SIGKILL)

    def wait(self):
        """The exit code; None where it goes on."""
        try:
            return self.process.wait(LIMIT_S)
        except subprocess.TimeoutExpired:
            return None


class Page:
    """The terminals of a person who follows it."""

    def __init__(self):
        self.terminals = {}
        self.board = None  # how it starts, and its process

    def fail(self, place, *words):
        """Raises Busy where the guest stood still."""
        printed = [*words, *(terminal.printed() for terminal in self.terminals.values())]
        for line in "\n".join(printed).split("\n"):
            if STOOD_STILL.search(line):
                raise Busy(f"{place}: {line}")
        raise Fault("\n".join([place, *words]))

    def wait_for(self, name, words, place):
        """Until the terminal has printed these words."""
        terminal, end = self.terminals[name], time.monotonic() + LIMIT_S
        while words not in terminal.printed():
            if terminal.process.poll() is not None or time.monotonic() > end:
                code = terminal.process.poll()
                self.fail(place, f"terminal {name} did not print {words!r}, exit code {code}",
                          terminal.printed())
            time.sleep(0.05)

    def connect_board(self, start):
        """Behind can0; another one instead of the one there."""
        if self.board is None or self.board[0] is not start:
            if self.board is not None:
                self.board[1].kill()
                self.board[1].wait()
            self.board = (start, start())

    def run(self, block):
        commands = block.commands
        for pattern, stand_in, why in STAND_INS:
            commands, count = re.subn(pattern, stand_in, commands, flags=re.M)
            if count:
                print(f"  {pattern!r} becomes {stand_in!r}: {why}")
        if "can0" in commands:
            self.connect_board(tested_board if "board-test" in commands else moving_board)
        block.commands = commands
        if block.after:
            name, _, words = block.after.partition(" prints ")
            self.wait_for(name, words, block.place)
            time.sleep(0.3)  # a person is no faster
        if before := self.terminals.pop(block.terminal, None):
            before.interrupt()
        terminal = Terminal(block)
        if "board-test" in commands:
            threading.Thread(target=arm_as_told, args=(self.board[1], terminal)).start()
        if block.until:
            self.terminals[block.terminal] = terminal
            if block.until == "now":
                time.sleep(1)
            else:
                self.wait_for(block.terminal, block.until, block.place)
        elif (code := terminal.wait()) not in block.exit_codes:
            self.fail(block.place, f"ended with {code}, wanted {block.exit_codes}",
                      block.commands, terminal.printed())
        for wanted in (block.prints, block.output):
            if wanted not in terminal.printed():
                self.fail(block.place, "not what it printed:", wanted, terminal.printed())
        if block.then:
            self.check_then(block)

    def check_then(self, block):
        name, is_end, wanted = block.then.partition(" ends with ")
        if not is_end:
            name, _, wanted = block.then.partition(" prints ")
            self.wait_for(name, wanted, block.place)
            return
        terminal = self.terminals.pop(name)
        if (code := terminal.wait()) != int(wanted):
            self.fail(block.place, f"terminal {name} ended with {code}, wanted {wanted}",
                      terminal.printed())


def sh(command):
    subprocess.run(["bash", "-euo", "pipefail", "-c", command], check=True)


def prepare_once():
    """A user, programs that a guest has not, and folders where root may write."""
    for name in ("etc", "var"):
        sh(f"mkdir -p /run/over/{name} /run/over/{name}.work; mount -t overlay overlay /{name} -o "
           f"lowerdir=/{name},upperdir=/run/over/{name},workdir=/run/over/{name}.work")
    sh(f"mount -t tmpfs tmpfs /home; useradd --create-home --shell /bin/bash {USER}")
    sh(f"install -D -m 4755 /usr/bin/setpriv {PROGRAMS}/as-root")
    scripts = {"sudo": f"env PATH={PROGRAMS}:{BUILD}:/usr/sbin:/usr/bin:/sbin:/bin "
                       f'{PROGRAMS}/as-root --reuid=0 --regid=0 --clear-groups -- "$@"',
               "systemctl": f"env AXG_BUILD={BUILD} AXG_PAGE_OPTIONS='{UNFIT}' {sys.executable} "
                            f'-B {HERE / "systemctl.py"} "$@"',
               "journalctl": f"tail -n +1 -f {FOLDER}/journal"}
    for name, command in scripts.items():
        (PROGRAMS / name).write_text(f"#!/bin/sh\nexec {command}\n")
        (PROGRAMS / name).chmod(0o755)


def prepare(page):
    """A checkout, a machine of one's own and interfaces, as the page finds them."""
    sh(f"rm -rf {WORK} /etc/axguard /etc/security/limits.d/axguard.conf /var/lib/axguardd "
       f"/etc/systemd/system/axguardd@.service.d {FOLDER}/*.txt {FOLDER}/journal; "
       "pkill -KILL -x axguardd || true")
    sh("for name in vcan0 can0; do ip link del $name 2>/dev/null || true; done; "
       "ip link add can0 type vxcan peer name board0; "
       "ip link set can0 mtu 72 up; ip link set board0 mtu 72 up")
    shutil.copytree(SOURCE / "config/machines", WORK / "config/machines")
    shutil.copytree(SOURCE / "hil_replay/programs", WORK / "hil_replay/programs")
    shutil.copytree(SOURCE / "config/machines/meshes", WORK / "meshes")
    service = "firmware_if/axguardd/service"
    shutil.copytree(SOURCE / service, WORK / service)
    machine = machine_file(has_hashes=True, permit_samples=5)
    shutil.copy(machine, WORK / "machine.yaml")
    if page.endswith("live.md"):
        print("a period of 5 ms, and a shorter program: a guest cannot keep 1 kHz for 40 s")
        shutil.copy(machine, WORK / "config/machines/paper-trunnion.yaml")
        shutil.copy(HERE / "collide.ngc", WORK / "hil_replay/programs/paper-trunnion-demo.ngc")
    if page.endswith("every-day.md"):
        print("a guard runs already, as a service")
        sh(f"install -D -m 644 {machine} /etc/axguard/can0.yaml; "
           f"cp -r {WORK}/meshes /etc/axguard/; "
           f"{PROGRAMS}/systemctl enable --now axguardd@can0; for try in $(seq 100); do "
           "[ -S /run/axguardd/can0/status ] && exit; sleep 0.2; done; "
           f"cat {FOLDER}/journal; exit 1")
    sh(f"chown -R {USER}: {WORK}")


def board_of(*command, **options):
    with open(FOLDER / "board.txt", "wb") as words:
        board = subprocess.Popen(command, stdout=words, stderr=words, **options)
    RUNNING.append(board)
    return board


def moving_board():
    """It moves when it gets permits."""
    return board_of(BUILD / "axguard", "drive", WORK / "machine.yaml", HERE / "clean.ngc", "--bus",
                    "board0", stdin=subprocess.DEVNULL)


def tested_board():
    """It keeps every rule; a person arms it."""
    return board_of(BUILD / "tests/axg_bench_board", WORK / "machine.yaml", WORK, "board0", "0",
                    stdin=subprocess.PIPE, text=True)


def arm_as_told(board, terminal):
    """The person at the board, each time that board-test prints what to do."""
    count = 0
    while terminal.process.poll() is None:
        while count < terminal.printed().count("arm the board"):
            board.stdin.write("arm\n")
            board.stdin.flush()
            count += 1
        time.sleep(0.05)


def play(page, text=None):
    text = text or (SOURCE / page).read_text()
    blocks = list(guide_blocks.blocks_of(page, text))
    faults = [block for block in blocks if isinstance(block, str)]
    if faults:
        raise Fault("\n".join(faults))
    prepare(page)
    person = Page()
    for block in blocks:
        if block.left_out:
            print(f"{block.place}: left out: {block.left_out}", flush=True)
            continue
        begin = time.monotonic()
        person.run(block)
        print(f"{block.place}: ran as {block.user}, {time.monotonic() - begin:.1f} s", flush=True)


def follow(page):
    try:
        play(page)
    except Fault as fault:
        expect(False, fault)


# Of a copy: the page's name, what is changed, and what is then reported.
BROKEN = {
    "without limits": ("live", "run -->\n```sh\n# user\nprintf",
                       "left out: not here -->\n```sh\n# user\nprintf", "locked memory"),
    "unknown option": ("live", "--local-board\n", "--local-bord\n", "--local-bord"),
    "block without mark": ("live", "<!-- guest: run -->\n```sh\n# user\naxguardd doctor",
                           "\n```sh\n# user\naxguardd doctor", "neither run nor left out"),
    "wrong user": ("bring-up", "# root\n", "# user\n", "Permission denied"),
    "wrong output": ("bring-up", "no such interface\n", "no such thing\n",
                     "not what it printed"),
}


def is_found_out(error):
    name, right, wrong, words = BROKEN[error]
    page = f"docs/guide/{name}.md"
    text = (SOURCE / page).read_text()
    expect(right in text, page, right)
    try:
        play(page, text.replace(right, wrong, 1))
    except Fault as fault:
        expect(words in str(fault), fault)
        return
    expect(False, f"{page} passes with an error: {error}")


prepare_once()
for name in sys.argv[1:]:
    if name == "broken":
        for error in BROKEN:
            attempt(is_found_out, error)
    else:
        attempt(follow, f"docs/guide/{name}.md")
