# SPDX-License-Identifier: Apache-2.0
"""The tests that the tree registers, without a build: ctest cases from CMake's own files, and the
cases of GoogleTest from the sources that tests/CMakeLists.txt makes programs of.

CMake is read as far as the tests need: set, list(APPEND), foreach, functions and their calls,
file(GLOB_RECURSE), add_test. Both sides of an if() count, for a test of another preset is a test
too, but not those of if(FALSE)."""
import pathlib
import posixpath
import re

from sources import without_comments_and_strings

TEST = re.compile(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", re.M)
CMAKE = re.compile(r"(?:CMakeLists\.txt|\.cmake)$")
TOKEN = re.compile(r'#[^\n]*|"(?:\\.|[^"\\])*"|[()]|[^\s()#"]+')
VARIABLE = re.compile(r"\$\{(\w+)\}")
NEVER = {"FALSE", "OFF", "NO", "0"}
ENDS = {"if": "endif", "foreach": "endforeach", "function": "endfunction", "macro": "endmacro"}


def commands_of(text):
    """(name, arguments) of each command."""
    found, name, arguments, depth = [], "", [], 0
    for match in TOKEN.finditer(text):
        token = match.group()
        if token.startswith("#"):
            continue
        if token == "(":
            depth += 1
        elif token == ")":
            depth -= 1
            if depth == 0:
                found.append((name.lower(), arguments))
                arguments = []
        elif depth:
            arguments.append(token.strip('"'))
        else:
            name = token
    return found


def block_end(commands, begin):
    """Index of the command that ends the block which commands[begin] opens."""
    opens = commands[begin][0]
    depth = 0
    for index in range(begin, len(commands)):
        depth += (commands[index][0] == opens) - (commands[index][0] == ENDS[opens])
        if depth == 0:
            return index
    return len(commands)


class Reader:
    """What one file of CMake registers."""

    def __init__(self):
        self.names, self.globs, self.files, self.functions = set(), set(), set(), {}

    def run(self, commands, values):
        index = 0
        while index < len(commands):
            name, words = commands[index]
            if name in ENDS:
                end = block_end(commands, index)
                self.block(name, words, commands[index + 1:end], values)
                index = end
            else:
                self.command(name, self.replaced(words, values), values)
            index += 1

    @staticmethod
    def replaced(words, values):
        """With the values of variables; a word that is one variable is as many words."""
        out = []
        for word in words:
            whole = VARIABLE.fullmatch(word)
            if whole and whole[1] in values:
                out += values[whole[1]]
            else:
                out.append(VARIABLE.sub(
                    lambda each: ";".join(values.get(each[1], [each[0]])), word))
        return out

    def block(self, name, words, body, values):
        if name in ("function", "macro"):
            self.functions[words[0].lower()] = (words[1:], body)
        elif name == "foreach":
            for value in self.items(self.replaced(words[1:], values), values):
                values[words[0]] = [value]
                self.run(body, values)
        else:
            self.branches(words, body, values)

    @staticmethod
    def items(words, values):
        if words[:2] == ["IN", "LISTS"]:
            return [value for name in words[2:] for value in values.get(name, [])]
        return words[2:] if words[:2] == ["IN", "ITEMS"] else words

    def branches(self, words, body, values):
        begin, condition, index = 0, words, 0
        while index <= len(body):
            is_end = index == len(body)
            if is_end or body[index][0] in ("else", "elseif"):
                if " ".join(condition).upper() not in NEVER:
                    self.run(body[begin:index], values)
                begin, condition = index + 1, [] if is_end else body[index][1]
            elif body[index][0] in ENDS:
                index = block_end(body, index)
            index += 1

    def command(self, name, words, values):
        if name == "add_test" and words[:1] == ["NAME"]:
            self.names.add(words[1])
        elif name == "set" and words:
            values[words[0]] = words[1:]
        elif name == "list" and words[:1] == ["APPEND"]:
            values[words[1]] = values.get(words[1], []) + words[2:]
        elif name == "file" and words[:1] == ["GLOB_RECURSE"]:
            self.globs |= set(words[2:])
        elif name == "include" and words:
            self.files.add(words[0])
        elif name == "add_subdirectory" and words:
            self.files.add(f"{words[0]}/CMakeLists.txt")
        elif name in self.functions:
            parameters, body = self.functions[name]
            own = {key: [value] for key, value in zip(parameters, words)}
            self.run(body, values | own | {"ARGN": words[len(parameters):]})


def read_cmake(text):
    reader = Reader()
    reader.run(commands_of(text), {})
    return reader


def ctest_names(files):
    """files: the text of each file by its name. Read from tests/CMakeLists.txt on, as far as it
    leads. A name with an unknown variable is none."""
    names, waiting, seen = set(), ["tests/CMakeLists.txt"], set()
    while waiting:
        name = waiting.pop()
        if name in seen or name not in files:
            continue
        seen.add(name)
        reader = read_cmake(files[name])
        names |= {test for test in reader.names if "$" not in test}
        waiting += [posixpath.join(posixpath.dirname(name), file) for file in reader.files]
    return names


def gtest_kinds(text):
    """Folders below tests/ of which tests/CMakeLists.txt takes every *_test.cpp."""
    found = (re.search(r"/(\w+)/\*_test\.cpp$", glob) for glob in read_cmake(text).globs)
    return {match[1] for match in found if match}


def gtest_names(files):
    kinds = gtest_kinds(files.get("tests/CMakeLists.txt", ""))
    names = set()
    for name, text in files.items():
        path = pathlib.PurePosixPath(name)
        if path.parts[0] == "tests" and path.parts[1] in kinds and \
                name.endswith("_test.cpp"):
            names |= {f"{suite}.{test}"
                      for suite, test in TEST.findall(without_comments_and_strings(text))}
    return {name for name in names if "DISABLED_" not in name}


def is_read(name):
    """Whether a file can register a test."""
    return name.startswith("tests/") and (CMAKE.search(name) is not None or
                                          name.endswith("_test.cpp"))
