#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""mkdocs builds the pages as a site, and warns of nothing: no missing page, no broken link."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from sources import finish, skip


def main():
    root = pathlib.Path(sys.argv[1])
    tool = shutil.which("mkdocs")
    if tool is None:
        skip("mkdocs is not installed (./setup.sh --all installs it)")
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([tool, "build", "--strict", "--site-dir", folder],
                             cwd=root, text=True, stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, check=False)
        has_front = (pathlib.Path(folder) / "index.html").is_file()
    output = re.sub(r"\x1b\[\d*m", "", run.stdout)
    faults = [line for line in output.splitlines() if re.match(r"(WARNING|ERROR)", line)]
    if run.returncode != 0 and not faults:
        faults = [output]
    finish(faults + ([] if has_front or faults else ["mkdocs.yml: the site has no front page"]))


if __name__ == "__main__":
    main()
