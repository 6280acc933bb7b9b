#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The tables of options in docs/reference/commands.md are those of this build's programs, and the
tables of keys in docs/reference/machine-file.md are those of the schema, and the computers in
docs/guide/every-day.md those of the records."""
import pathlib
import subprocess
import sys

from sources import finish

PAGES = [("command_tables.py", "docs/reference/commands.md"),
         ("key_tables.py", "docs/reference/machine-file.md"),
         ("computer_table.py", "docs/guide/every-day.md")]


def fault_of(root, tool, source, page):
    command = [f"tests/tools/{tool}", str(source), page]
    made = subprocess.run([sys.executable, "-B", *command], cwd=root, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if made.returncode:
        return f"{page}: {made.stdout.strip().splitlines()[-1]}"
    if made.stdout != (root / page).read_text(encoding="utf-8"):
        return f"{page}: its tables are old; run: " \
               f"{' '.join(command)} --write".replace(f"{root}/", "")
    return None


def main():
    root, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    sources = (build, root / "config/schema/machine.schema.json", root / "docs/measurements")
    faults = [fault_of(root, tool, source, page)
              for (tool, page), source in zip(PAGES, sources)]
    finish([fault for fault in faults if fault])


if __name__ == "__main__":
    main()
