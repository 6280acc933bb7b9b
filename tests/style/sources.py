# SPDX-License-Identifier: Apache-2.0
"""The files the rules are about, and C++ with its comments and strings blanked out."""
import pathlib
import re
import subprocess
import sys

SKIPPED = 77
CPP = {".cpp", ".hpp", ".h", ".c", ".inl", ".cu", ".cuh"}
CODE = CPP | {".py", ".sh", ".cmake"}


def tracked_files(root):
    """Paths under root as git knows them, new ones included; all files where there is no git."""
    command = ["git", "-c", "safe.directory=*", "-C", str(root), "ls-files", "-z", "--cached",
               "--others", "--exclude-standard"]
    try:
        listing = subprocess.run(command, capture_output=True, check=True).stdout.decode()
        names = [name for name in listing.split("\0") if name]
    except (OSError, subprocess.CalledProcessError):
        names = [str(path.relative_to(root)) for path in root.rglob("*") if path.is_file()]
        names = [name for name in names if not re.match(r"(build[^/]*|out|\.git)/", name)]
    return sorted(name for name in set(names) if (root / name).is_file())


def is_code(name):
    path = pathlib.PurePath(name)
    return path.suffix in CODE or path.name == "CMakeLists.txt" or name == ".ci/run"


def is_cpp(name):
    return pathlib.PurePath(name).suffix in CPP


def read_text(root, name):
    return (root / name).read_text(encoding="utf-8", errors="replace")


TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"(?P<d>[^()\s\\]{0,16})\(.*?\)(?P=d)"'
                   r'|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])+\'', re.S)


def without_comments_and_strings(text):
    """Same line numbers; what a compiler would not read as code is gone. #include lines stay."""
    def blank(match):
        start = text.rfind("\n", 0, match.start()) + 1
        if re.search(r"#\s*include\b", text[start:match.start()]):
            return match.group() if match.group().startswith('"') else ""
        return re.sub(r"[^\n]", " ", match.group())
    return TOKEN.sub(blank, text)


def includes(text):
    """(line number, path, quoted) of each #include."""
    for number, line in enumerate(without_comments_and_strings(text).split("\n"), 1):
        match = re.match(r'\s*#\s*include\s*(["<])([^">]+)[">]', line)
        if match:
            yield number, match.group(2), match.group(1) == '"'


def finish(faults):
    """Prints each fault and ends with 1, or silently with 0."""
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


def skip(reason):
    print(f"skipped: {reason}")
    sys.exit(SKIPPED)
