#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The pages of man of the programs, from the tables of docs/reference/commands.md, which a
test compares with --help. No program runs, so a cross build has them too.

Example: toolchains/man_pages.py 0.1.0 docs/reference/commands.md build/host-package/packaged"""
import pathlib
import re
import sys

PURPOSES = {"axguard": "check machines, simulate programs and replay traces offline",
            "axguard-certcheck": "check a certificate of a whole program, without axguard",
            "axguardd": "guard a machine tool on a CAN bus",
            "axguard-lab": "measure engines and methods of axguard"}
SHARED = "options of several commands"
FILES = {"axguardd": [
    ("/etc/axguard/BUS.yaml", "machine file of the service axguardd@BUS"),
    ("/etc/axguard/BUS.env", "its options: AXGUARD_OPTIONS"),
    ("/etc/axguard/sample.yaml", "a machine without mesh files, to begin with"),
    ("/usr/share/doc/axguardd/examples/80-can0.network", "the CAN link at each start"),
    ("/var/lib/axguardd", "latch, verdict of the admission, black boxes"),
    ("/run/axguardd/BUS", "status socket and metrics of the service")]}


def plain(text):
    """Markdown of a cell or a sentence as roff."""
    text = re.sub(r"\[([^\[\]]*)\]\([^)]*\)", r"\1", text).replace("\\|", "|")
    text = text.replace("`", "").replace("**", "").replace("\\", "\\e").replace("-", "\\-")
    return re.sub(r"^([.'])", r"\\&\1", text, flags=re.M)


def parts_of(page):
    return dict(re.findall(r"<!-- made: (.+?) -->\n(.*?)<!-- end -->", page, re.S))


def rows_of(part):
    """The cells of a table's rows below its head."""
    rows = [re.split(r"(?<!\\)\|", line.strip().strip("|")) for line in part.split("\n")
            if line.startswith("|")]
    return [[cell.strip() for cell in row] for row in rows[2:]]


def option(row):
    name, value, meaning = row
    kind = f" ({plain(value)})" if value else ""
    return f".TP\n.B {plain(name)}\n{plain(meaning)}{kind}\n"


def command(name, part, shared):
    example = re.search(r"```sh\n(.+?)\n```", part, re.S).group(1)
    purpose = part.strip().split("\n\n")[0]
    also = re.search(r"^Also, .*?: (.+?)\.$", part, re.M | re.S)
    names = [each.strip() for each in re.split(r",\s+(?=`(?!-\w))|,\s+(?=`--)",
                                               also.group(1))] if also else []
    rows = rows_of(part) + [row for row in shared if row[0] in names]
    rows.sort(key=lambda row: row[0].startswith("`-"))
    return (f".SS {plain(name)}\n{plain(purpose)}\n.PP\n.EX\n{plain(example)}\n.EE\n" +
            "".join(option(row) for row in rows))


def exit_codes(page):
    section = page.split("\n## Exit codes\n")[1].split("\n## ")[0]
    return "".join(f".TP\n.B {plain(code)}\n{plain(meaning)}\n"
                   for code, meaning in rows_of(section))


def manual(program, version, page):
    parts = parts_of(page)
    shared = rows_of(parts[SHARED])
    names = [name for name in parts if name.split(" ")[0] == program]
    is_command = names == [program]  # a program without commands of its own
    if not names:
        sys.exit(f"man_pages.py: no command of {program} in the page")
    word = "" if is_command else ".I command\n"
    others = ", ".join(f".BR {name} (1)" for name in PURPOSES if name != program)
    text = (f'.TH {plain(program.upper())} 1 "" "axguard {version}" "axguard"\n'
            f".SH NAME\n{plain(program)} \\- {plain(PURPOSES[program])}\n"
            f".SH SYNOPSIS\n.B {plain(program)}\n{word}[options]\n.PP\n"
            f".B {plain(program)}\n{word}.B \\-\\-help\n"
            ".SH DESCRIPTION\nA collision guard for five\\-axis machine tools. It complements a "
            "wired emergency stop and never replaces it.\n.SH COMMANDS\n")
    text += "".join(command(name, parts[name], shared) for name in names)
    if program in FILES:
        text += ".SH FILES\n" + "".join(f".TP\n.I {plain(path)}\n{plain(what)}\n"
                                        for path, what in FILES[program])
    text += f".SH EXIT STATUS\n{exit_codes(page)}"
    return text + ".SH SEE ALSO\n" + others.replace(", ", ",\n") + \
        "\n.PP\nThe pages of axguard\\-doc: /usr/share/doc/axguard\\-doc/pages\n"


def main():
    version, page, out = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
    out.mkdir(parents=True, exist_ok=True)
    for program in PURPOSES:
        (out / f"{program}.1").write_text(manual(program, version, page.read_text()))


if __name__ == "__main__":
    main()
