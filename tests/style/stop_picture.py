#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""docs/figures/stop.svg is what this build finds: the demo program simulated, replayed and drawn
again gives the same bytes. When it should change, run the commands in make_stop_picture.py."""
import pathlib
import subprocess
import sys
import tempfile

from sources import finish

COLLISION = 10


def main():
    root, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    machine = root / "config" / "machines" / "paper-trunnion.yaml"
    program = root / "hil_replay" / "programs" / "paper-trunnion-demo.ngc"
    figures = root / "docs" / "figures"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        trace, document, drawn = folder / "demo.log", folder / "demo.json", folder / "stop.svg"
        steps = [([build / "axguard", "simulate", machine, program, "-o", trace], 0),
                 ([build / "axguard", "replay", machine, trace, "--mode", "contact",
                   f"--json={document}"], COLLISION),
                 ([sys.executable, "-B", figures / "make_stop_picture.py", document, "-o", drawn],
                  0)]
        for command, wanted in steps:
            done = subprocess.run(command, text=True, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, check=False)
            if done.returncode != wanted:
                finish([f"{' '.join(map(str, command))}: ended with {done.returncode}, wanted "
                        f"{wanted}\n{done.stdout[-2000:]}"])
        same = drawn.read_bytes() == (figures / "stop.svg").read_bytes()
        finish([] if same else ["docs/figures/stop.svg: not what this build finds; draw it again "
                                "with the commands in docs/figures/make_stop_picture.py"])


if __name__ == "__main__":
    main()
