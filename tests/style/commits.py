#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The newest commits: a subject of at most 72 columns, and a body wherever product files change.

commits.py SOURCE_DIR"""
import subprocess
import sys

from comments import FOLDERS
from sources import SKIPPED, finish, is_cpp

COMMITS = 40
SUBJECT_MAX = 72
FORMAT = "%x01%h%x02%s%x02%b%x02"  # then the names of the files


def faults_of(log):
    for commit in log.split("\x01")[1:]:
        short, subject, body, names = commit.split("\x02")
        if len(subject) > SUBJECT_MAX:
            yield (f"commit {short}: the subject has {len(subject)} columns, wanted at most "
                   f"{SUBJECT_MAX}: {subject}")
        is_product = any(is_cpp(name) and name.startswith(FOLDERS) for name in names.split())
        if is_product and not body.strip():
            yield f"commit {short}: it changes product files, and no body says why: {subject}"


def main():
    command = ["git", "-c", "safe.directory=*", "-C", sys.argv[1], "log", f"-{COMMITS}",
               "--no-merges", "--name-only", f"--format={FORMAT}"]
    run = subprocess.run(command, capture_output=True, text=True)
    if run.returncode != 0:
        print("skipped: there are no commits here")
        sys.exit(SKIPPED)
    finish(list(faults_of(run.stdout)))


if __name__ == "__main__":
    main()
