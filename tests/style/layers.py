#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Who may include whom. Data flows one way: a layer that looked back would no longer be testable
with arrays and a counter for time. Houses (core/, config/, ...) first; then their rooms, which are
the folders below: no circle between rooms, no include of a room that the CMakeLists.txt does not
link, at most forty files a room, each room named by the README of its house, and in the README of
each room the rooms that it links."""
import collections
import pathlib
import re
import sys

from sources import (finish, includes, is_cpp, read_text, tracked_files,
                     without_comments_and_strings)

FOLDERS = {"core", "config", "firmware_if", "cuda", "hil_replay", "tests"}
MAY_INCLUDE = {
    "core": {"core"},
    "config": {"config", "core"},
    "cuda": {"cuda", "core"},
    "firmware_if": {"firmware_if", "config", "cuda", "core"},
    "hil_replay": FOLDERS - {"tests"},
    "tests": FOLDERS,
}
ROOM_FILES_MAX = 40
# Folders of a house that are no room: data, and the C interface, which has no header that a room
# could include.
NO_ROOMS = {"config/machines", "config/machines/meshes", "config/schema",
            "firmware_if/c_interface", "firmware_if/c_interface/example",
            "firmware_if/linuxcnc", "firmware_if/linuxcnc/examples/paper-trunnion",
            "firmware_if/linuxcnc/examples/xyzac-trt",
            "firmware_if/linuxcnc/examples/xyzbc-trt",
            "hil_replay/programs"}
# The one header outside of rooms, and who may include from the folders that are none.
C_HEADER = "firmware_if/axguard.h"
LABORATORY = "hil_replay/lab/"
# The processor's own headers carry the SIMD lanes; they are no operating system.
PROCESSOR = {"immintrin.h", "xmmintrin.h", "pmmintrin.h", "arm_neon.h", "cpuid.h"}
# Parts of the standard library that are an operating system, a clock, a log or a thread.
NOT_IN_CORE = {
    "iostream", "ostream", "istream", "fstream", "sstream", "iomanip", "syncstream", "cstdio",
    "stdio.h", "filesystem", "chrono", "ctime", "time.h", "thread", "mutex", "shared_mutex",
    "condition_variable", "future", "stop_token", "semaphore", "barrier", "latch", "random",
    "locale", "clocale", "csignal", "signal.h", "coroutine", "exception", "stdexcept", "regex",
}
# Operating system headers of the loaders, which open files without following links out of a folder.
OPENING_FILES = {"fcntl.h", "unistd.h", "sys/stat.h", "sys/types.h", "sys/syscall.h",
                 "linux/openat2.h"}
# The judge of certificates shares no code with what writes them: its own headers and the standard
# library's alone; and no other room includes it.
CERTCHECK = "hil_replay/certcheck/"
# Firmware compiles this room for a processor without any of the rest.
BOARD = "firmware_if/board/"
BOARD_HEADERS = {"stdbool.h", "stddef.h", "stdint.h"}
SYSTEM = re.compile(r"(linux|sys|net|netinet|arpa|asm|bits)/|"
                    r"(fcntl|unistd|pthread|sched|poll|dlfcn|signal|dirent|termios|ifaddrs)\.h$")
LIBRARIES = {  # library -> the only folder that may know it (tests beside)
    "yaml-cpp/": {"config"},
    "tinyxml2.h": {"config"},
    "cuda": {"cuda"},
    "gtest/": set(),
    "rapidcheck": set(),
    "CGAL/": set(),
    "nlohmann/": {"hil_replay", "firmware_if"},
    "microhttpd": {"hil_replay"},
}
# Tests read axg::test::Json; valijson, which judges the schema, takes nlohmann's own values.
SCHEMA_TEST = r"tests/unit/config/text/machine_schema_test\.cpp"
TEST_JSON = rf"tests/support/json_value\.cpp|{SCHEMA_TEST}"
SLOW = {  # library that takes seconds to compile -> the only files that may include it
    "CLI/": re.compile(r"firmware_if/cli/command_line\.cpp"),
    "nlohmann/json.hpp": re.compile(rf"{TEST_JSON}|(?!tests/).*_json\.cpp"),
    "nlohmann/": re.compile(rf"{TEST_JSON}|(?!tests/).*_json\.[ch]pp"),
    "valijson/": re.compile(SCHEMA_TEST),
}


def fault_of(name, path, quoted):
    """What is wrong with this file including path, or None."""
    folder = name.split("/")[0]
    may_include = MAY_INCLUDE[folder]
    other = path.split("/")[0]
    if name.startswith(BOARD) and not (path in BOARD_HEADERS or path.startswith(BOARD)):
        return f"{BOARD} includes nothing but itself and {', '.join(sorted(BOARD_HEADERS))}"
    if name.startswith(CERTCHECK) and not path.startswith(CERTCHECK):
        if quoted or "/" in path or path.endswith(".h"):
            return f"{CERTCHECK} includes nothing but itself and the standard library"
    if path.startswith(CERTCHECK) and not name.startswith((CERTCHECK, "tests/")):
        return f"{CERTCHECK} is no part of what it judges: run the program"
    if other in FOLDERS and "/" in path:
        if not quoted:
            return "own headers are included with quotes"
        is_beside = path.rpartition("/")[0] == name.rpartition("/")[0]
        if folder != "tests" and path != C_HEADER and room_of(path) is None and not is_beside:
            return "this header is in no room: the header of a room, or the C interface's own"
        if other not in may_include:
            return f"{folder}/ may include {', '.join(sorted(may_include))} only"
        return None
    if quoted and folder != "tests":
        return "own headers are included from the repository root, libraries with < >"
    if folder == "tests":
        return None
    for library, houses in LIBRARIES.items():
        if path.startswith(library) and folder not in houses:
            return f"{path} belongs in {', '.join(sorted(houses)) or 'tests'}/ alone"
    if folder == "core":
        if path in PROCESSOR:
            return None
        if path in NOT_IN_CORE or "/" in path or path.endswith(".h"):
            return "core/ is pure: std without system, clock, log, thread"
        return None
    if SYSTEM.match(path) and folder != "firmware_if":
        if folder == "hil_replay" or (folder == "config" and path in OPENING_FILES):
            return None
        return "firmware_if/ alone knows Linux"
    return None


def fault_of_file(name, path):
    for library, only in SLOW.items():
        if path.startswith(library) and not only.fullmatch(name):
            return f"{only.pattern} alone includes {library}, which takes seconds to compile"
    return None


# Forms of an include that nobody needs, and that this check would not read.
ODD = re.compile(r"^\s*(%:|#\s*(import|include_next)\b|#\s*include\s*[^\s\"<]|#\s*\\$)|"
                 r"^\s*#\s*include.*\\$", re.M)
MAY_INCLUDE_ITEM = re.compile(r"^- May include:(.*?)(?=^- |^\s*$|\Z)", re.S | re.M)
OTHER_SUFFIXES = re.compile(r"\.(hh|hxx|h\+\+|ipp|tpp|inc|cc|cxx)$")


def faults_in(name, text):
    for match in ODD.finditer(without_comments_and_strings(text)):
        yield f"{name}: '{match.group().strip()}': write #include, and a path after it"
    for number, path, quoted in includes(text):
        if OTHER_SUFFIXES.search(path) and path.split("/")[0] in FOLDERS:
            yield f"{name}:{number}: includes {path}: headers end in .hpp, .h, .inl or .cuh"
        fault = fault_of_file(name, path) or fault_of(name, path, quoted)
        if fault:
            yield f"{name}:{number}: includes {path}: {fault}"


def room_of(name):
    """The room of a file, or None: its folder, when that is below a house."""
    folder = name.rpartition("/")[0]
    if "/" not in folder or folder.startswith("tests/") or folder in NO_ROOMS:
        return None
    return folder if folder.split("/")[0] in FOLDERS else None


def linked_rooms(text):
    """What axg_room() in a CMakeLists.txt names after ROOMS."""
    rooms = set()
    text = re.sub(r"#[^\n]*", "", text)
    for words in re.findall(r"\bROOMS((?:\s+[a-z_]+/[a-z_/]+)+)", text):
        rooms.update(words.split())
    return rooms


def reachable(graph, start):
    seen, waiting = set(), [start]
    while waiting:
        for room in graph.get(waiting.pop(), ()):
            if room not in seen:
                seen.add(room)
                waiting.append(room)
    return seen


def room_faults(files, text_of):
    """What is wrong with the rooms of these files, given the text of each."""
    counts, linked = collections.Counter(), {}
    arrows = collections.defaultdict(dict)
    for name in files:
        room = room_of(name)
        if room is None:
            if (is_cpp(name) and name.count("/") == 1 and name != C_HEADER and
                    name.split("/")[0] in FOLDERS - {"tests"}):
                yield f"{name}: lies in no room: move it into one"
            continue
        counts[room] += 1
        if name.endswith("/CMakeLists.txt"):
            linked[room] = linked_rooms(text_of(name))
        elif is_cpp(name):
            for number, path, quoted in includes(text_of(name)):
                other = room_of(path) if quoted else None
                if other not in (None, room):
                    arrows[room].setdefault(other, f"{name}:{number}: includes {path}")
    for room, count in sorted(counts.items()):
        if count > ROOM_FILES_MAX:
            yield f"{room}/: {count} files, wanted at most {ROOM_FILES_MAX}: part it by subject"
    for room in sorted(arrows):
        links = reachable(linked, room)
        for other, where in sorted(arrows[room].items()):
            if room in reachable(arrows, other):
                yield f"{where}: {room} and {other} include each other: one direction only"
            elif other.startswith(LABORATORY) and not room.startswith(LABORATORY):
                yield f"{where}: no room but the laboratory's own includes the laboratory"
            elif other not in links:
                yield f"{where}: {room}/CMakeLists.txt does not link {other}: name it after ROOMS"


def unnamed_rooms(files, text_of):
    """Rooms that the README of their house does not name."""
    for room in sorted({room_of(name) for name in files} - {None}):
        house, _, inside = room.partition("/")
        readme = f"{house}/README.md"
        if readme in files and f"`{inside.partition('/')[0]}" not in text_of(readme):
            yield f"{readme}: does not name its room {inside}"


def readme_faults(files, text_of):
    """Rooms without a README, and READMEs that leave out a room which the CMakeLists.txt links."""
    linked = {}
    for name in files:
        if room_of(name) is not None and name.endswith("/CMakeLists.txt"):
            if re.search(r"^\s*axg_room\(", text_of(name), re.M):
                linked[room_of(name)] = linked_rooms(text_of(name))
    for room, links in sorted(linked.items()):
        readme = f"{room}/README.md"
        item = MAY_INCLUDE_ITEM.search(text_of(readme)) if readme in files else None
        if item is None:
            yield f"{readme}: no such file, or no item \"- May include:\" in it"
            continue
        named = set(re.findall(r"`([a-z_]+/[a-z_/]*)`", item.group(1)))
        if re.search(r"\brooms\s+below\b", item.group(1)):
            named |= {below for other in named for below in reachable(linked, other)}
        for other in sorted(links - named):
            if other.partition("/")[0] + "/" not in named:
                yield f"{readme}: \"May include:\" leaves out {other}, which the room links"


def main():
    root = pathlib.Path(sys.argv[1])
    files = tracked_files(root)
    faults = list(room_faults(files, lambda name: read_text(root, name)))
    faults += unnamed_rooms(files, lambda name: read_text(root, name))
    faults += readme_faults(files, lambda name: read_text(root, name))
    for name in files:
        folder = name.split("/")[0]
        if is_cpp(name) and folder in FOLDERS:
            faults += faults_in(name, read_text(root, name))
    finish(faults)


if __name__ == "__main__":
    main()
