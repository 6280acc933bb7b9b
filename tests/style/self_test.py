#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The rules notice what they are for, and let pass what they should."""
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap

import banned_calls
import comments
import commits
import contraction_flags
import deployed_symbols
import figure_labels
import files
import guide_blocks
import isa_symbols
import layers
import links
import mutant_list
import readme_commands
import readme_example
import readme_figures
import shared_copies
import words
from sources import finish, without_comments_and_strings

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tools"))
import changed  # noqa: E402
import step_table  # noqa: E402

FAULTS = []


def expect(what, condition):
    if not condition:
        FAULTS.append(f"self_test: {what}")


def layers_notice():
    for folder, line, bad in [
            ("core", "#include <linux/can.h>", True), ("core", '#include "config/x.hpp"', True),
            ("core", "#include <iostream>", True), ("core", "#include <chrono>", True),
            ("core", "#include <yaml-cpp/yaml.h>", True), ("core", "#include <vector>", False),
            ("core", "#include <Eigen/Core>", True), ("core", "#include <immintrin.h>", False),
            ("core", "// #include <iostream>", False), ("core", '#include "core/a/x.hpp"', False),
            ("core", '#include "core/x.hpp"', True),
            ("core", '# include "config/a/x.hpp"', True), ("core", "# include <iostream>", True),
            ("core", '/**/ #include "config/a/x.hpp"', True),
            ("core", "%:include <iostream>", True), ("core", "#include MACRO", True),
            ("core", "#include \\\n<iostream>", True), ("core", '#import "core/a/x.hpp"', True),
            ("core", '#include "core/a/x.ipp"', True),
            ("firmware_if", "#include <hil_replay/motion/program.hpp>", True),
            ("firmware_if", '#include "firmware_if/c_interface/x.hpp"', True),
            ("firmware_if", '#include "firmware_if/axguard.h"', False),
            ("config", '#include "firmware_if/x.hpp"', True),
            ("config", "#include <linux/can.h>", True), ("config", "#include <fcntl.h>", False),
            ("config", "#include <yaml-cpp/yaml.h>", False),
            ("hil_replay", "#include <yaml-cpp/yaml.h>", True),
            ("hil_replay", '#include "firmware_if/a/x.hpp"', False),
            ("firmware_if", "#include <linux/can.h>", False),
            ("firmware_if", '#include "config/a/x.hpp"', False),
            ("firmware_if", '#include "hil_replay/x.hpp"', True),
            ("hil_replay", '#include "x.hpp"', True)]:
        expect(f"layers: {folder}: {line}",
               bool(list(layers.faults_in(folder + "/room/f", line))) == bad)
    for name, line, bad in [
            ("firmware_if/cli/command_line.cpp", "#include <CLI/CLI.hpp>", False),
            ("firmware_if/cli/command_line.hpp", "#include <CLI/CLI.hpp>", True),
            ("hil_replay/commands/axguard.cpp", "#include <CLI/App.hpp>", True),
            ("tests/unit/x_test.cpp", "#include <CLI/CLI.hpp>", True),
            ("hil_replay/x/x_json.cpp", "#include <nlohmann/json.hpp>", False),
            ("hil_replay/x/x_json.hpp", "#include <nlohmann/json.hpp>", True),
            ("hil_replay/x/x_json.hpp", "#include <nlohmann/json_fwd.hpp>", False),
            ("hil_replay/x/x.hpp", "#include <nlohmann/json_fwd.hpp>", True),
            ("hil_replay/x/json.cpp", "#include <nlohmann/json.hpp>", True),
            ("config/x/x_json.cpp", "#include <nlohmann/json.hpp>", True),
            ("firmware_if/board/x.c", "#include <stdint.h>", False),
            ("firmware_if/board/x.c", '#include "firmware_if/board/y.h"', False),
            ("firmware_if/board/x.c", '#include "firmware_if/can/y.hpp"', True),
            ("firmware_if/board/x.c", "#include <stdio.h>", True),
            ("firmware_if/can/x.cpp", "#include <stdio.h>", False),
            ("hil_replay/certcheck/x.cpp", "#include <vector>", False),
            ("hil_replay/certcheck/x.cpp", '#include "hil_replay/certcheck/y.hpp"', False),
            ("hil_replay/certcheck/x.cpp", '#include "core/base/pose.hpp"', True),
            ("hil_replay/certcheck/x.cpp", "#include <sys/stat.h>", True),
            ("hil_replay/certcheck/x.cpp", "#include <fmt/format.h>", True),
            ("hil_replay/check/x.cpp", '#include "hil_replay/certcheck/y.hpp"', True),
            ("tests/unit/x_test.cpp", '#include "hil_replay/certcheck/y.hpp"', False),
            ("tests/support/json_value.cpp", "#include <nlohmann/json.hpp>", False),
            ("tests/support/json_value.hpp", "#include <nlohmann/json_fwd.hpp>", True),
            ("tests/unit/x_test.cpp", "#include <nlohmann/json.hpp>", True),
            ("tests/unit/x/x_json.cpp", "#include <nlohmann/json.hpp>", True),
            ("tests/unit/x_test.cpp", "#include <valijson/validator.hpp>", True),
            ("firmware_if/cli/x.cpp", '#include "config/a/x.hpp"', False),
            ("firmware_if/cli/x.cpp", '#include "hil_replay/x.hpp"', True)]:
        expect(f"layers: {name}: {line}",
               bool(list(layers.faults_in(name, line))) == bad)
    for what, texts, bad in [
            ("a linked room", {"core/b/CMakeLists.txt": "axg_room(SOURCES x.cpp\n  ROOMS core/a)",
                               "core/b/x.cpp": '#include "core/a/y.hpp"\n'}, False),
            ("a room linked by another", {"core/c/CMakeLists.txt": "axg_room(ROOMS core/b)",
                                          "core/b/CMakeLists.txt": "axg_room(ROOMS core/a)",
                                          "core/c/x.inl": '#include "core/a/y.hpp"\n'}, False),
            ("a room that is not linked", {"core/b/CMakeLists.txt": "axg_room(SOURCES x.cpp)",
                                           "core/b/x.cpp": '#include "core/a/y.hpp"\n'}, True),
            ("a room named in a comment", {"core/b/CMakeLists.txt": "axg_room() # ROOMS core/a",
                                           "core/b/x.cpp": '#include "core/a/y.hpp"\n'}, True),
            ("a file in no room", {"core/x.hpp": ""}, True),
            ("a room whose name begins as a folder that is none",
             {"firmware_if/c_interface_more/x.hpp": '#include "firmware_if/can/y.hpp"\n'}, True),
            ("the laboratory's own", {"hil_replay/lab/b/CMakeLists.txt": "ROOMS hil_replay/lab/a",
                                      "hil_replay/lab/b/x.cpp":
                                          '#include "hil_replay/lab/a/y.hpp"\n'}, False),
            ("the laboratory elsewhere", {"hil_replay/b/CMakeLists.txt": "ROOMS hil_replay/lab/a",
                                          "hil_replay/b/x.cpp":
                                              '#include "hil_replay/lab/a/y.hpp"\n'}, True),
            ("a circle", {"core/a/CMakeLists.txt": "axg_room(ROOMS core/b)",
                          "core/b/CMakeLists.txt": "axg_room(ROOMS core/a)",
                          "core/a/y.hpp": '#include "core/b/x.hpp"\n',
                          "core/b/x.hpp": '#include "core/a/y.hpp"\n'}, True),
            ("forty files", {f"core/a/{i}.hpp": "" for i in range(40)}, False),
            ("forty-one files", {f"core/a/{i}.hpp": "" for i in range(41)}, True)]:
        expect(f"layers: {what}", bool(list(layers.room_faults(texts, texts.get))) == bad)
    for words, bad in [("Rooms: `a`.", False), ("Rooms: `b`.", True), ("Room a.", True)]:
        texts = {"core/README.md": words, "core/a/x.hpp": ""}
        expect(f"layers: {words}", bool(list(layers.unnamed_rooms(texts, texts.get))) == bad)
    rooms = {"core/b/CMakeLists.txt": "axg_room(ROOMS core/a)", "core/b/README.md":
             "- May include: `core/`.", "firmware_if/a/CMakeLists.txt": "# no axg_room()",
             "core/c/CMakeLists.txt": "axg_room(ROOMS core/a core/b)"}
    for words, bad in [("- May include: `core/a`,\n  `core/b`; fmt.", False),
                       ("- May include: `core/b` and the rooms\n  below it.", False),
                       ("- May include: `core/`.", False), ("- May include: `core/b`.", True),
                       ("- May include: `core/b`.\n- Start with `core/a`.", True),
                       ("- May include `core/a`, `core/b`.", True)]:
        texts = rooms | {"core/c/README.md": words}
        expect(f"layers: {words}", bool(list(layers.readme_faults(texts, texts.get))) == bad)
    expect("layers: a room without a README", bool(list(layers.readme_faults(rooms, rooms.get))))


def banned_calls_notice():
    for line, bad in [
            ("int* p = new int;", True), ("::new (p) int;", False), ("int new_count = 0;", False),
            ("void* p = malloc(3);", True), ("throw 1;", True), ("printf(\"x\");", True),
            ("std::snprintf(b, 3, f);", True), ("y = std::sin(x);", True), ("y = cos(x);", True),
            ("s = sin_cos(x);", False), ("// throw", False), ("const char* s = \"new\";", False),
            ("X(const X&) = delete;", False), ("delete p;", True), ("y = std::sqrt(x);", False),
            ("assert(x);", True), ("static_assert(x);", False), ("AXG_ASSERT(x);", False),
            ("std::chrono::seconds s;", True), ("const int n = 1'000;", False),
            ("a.free(b);", False), ("y = std::fma(a, b, c);", False)]:
        expect(f"banned_calls: {line}", bool(list(banned_calls.faults_in("f", line))) == bad)


def files_notice():
    first = "// SPDX-License-Identifier: Apache-2.0\n"
    place = "/" + "home" + "/someone"
    for name, text, bad in [
            ("core/a.cpp", first, False), ("core/a.cpp", "int a;\n", True),
            ("core/a.cpp", first + "x" * 100, False), ("core/a.cpp", first + "x" * 101, True),
            ("core/a.cpp", first + "x\n" * 598, False), ("core/a.cpp", first + "x\n" * 600, True),
            ("core/a.cpp", first + "x \n", True), ("docs/a.md", place, True),
            ("docs/a.md", "x" * 400, False), ("docs/a.md", "tests/home/x", False)]:
        expect(f"files: {name}: {text[:60]!r}", bool(list(files.faults_in(name, text))) == bad)
    script = "#!/bin/sh\n# SPDX-License-Identifier: Apache-2.0\n"
    for text, bad in [("python3 -m pip install -q \\\n  --require-hashes -r a.txt\n", False),
                      ("python3 -m pip install -q \\\n  cantools==45.1.0\n", True)]:
        expect(f"files: {text!r}", bool(list(files.faults_in("a.sh", script + text))) == bad)
    expect("files: a capital in a name", files.name_fault("core/Bvh.hpp") is not None)
    expect("files: a good name", files.name_fault("core/bvh_node.hpp") is None)


def contraction_flags_notice():
    for name, command, bad in [
            ("core/a.cpp", "c++ -ffp-contract=off", False), ("core/a.cpp", "c++ -O2", True),
            ("core/a.cpp", "c++ -ffp-contract=off -ffp-contract=fast", True),
            ("core/a.cpp", "c++ -ffp-contract=fast -ffp-contract=off", False),
            ("core/a.cpp", "c++ -ffp-contract=off -ffast-math", True),
            ("core/a.cpp", "c++ -ffp-contract=off -mfma", True),
            ("core/a.cpp", "c++ -ffp-contract=off -march=native", True),
            ("core/collision/traverse_avx2.cpp", "c++ -ffp-contract=off -mfma", False),
            ("hil_replay/lab/methods/fused.cpp", "c++ -ffp-contract=off -ffp-contract=fast", False),
            ("hil_replay/lab/methods/fused.cpp", "c++ -ffp-contract=off", True),
            ("cuda/a.cu", "nvcc --fmad=false", False), ("cuda/a.cu", "nvcc -O3", True)]:
        expect(f"contraction_flags: {name}: {command}",
               bool(list(contraction_flags.faults_of(name, command.split()))) == bad)


def shared_copies_notice():
    with tempfile.TemporaryDirectory() as folder:
        ours, theirs, other = (pathlib.Path(folder) / name for name in ("a", "b", "c"))
        ours.write_bytes(b"x" * 100)
        theirs.write_bytes(b"x" * 100)
        other.write_bytes(b"y" * 100)
        expect("shared_copies: a copy", len(list(shared_copies.copies([ours], [theirs]))) == 1)
        expect("shared_copies: another file", not list(shared_copies.copies([ours], [other])))


def readme_blocks_are_found():
    text = ("<!-- ctest: run -->\n```sh\ntrue\n```\n```sh\nfalse\n```\n"
            "<!-- ctest: run data exit=10 -->\n```sh\nexit 10\n```\n\n```text\na\nb\n```\n")
    blocks = list(readme_commands.marked_blocks(text))
    expect("readme: two marked blocks", len(blocks) == 2)
    if len(blocks) == 2:
        expect("readme: plain block", blocks[0].exit_code == 0 and not blocks[0].needs_data)
        expect("readme: options", blocks[1].exit_code == 10 and blocks[1].needs_data)
        expect("readme: its commands", blocks[1].commands == "exit 10\n")
        expect("readme: no output is asked for", blocks[0].output == "")
        expect("readme: its output", blocks[1].output == "a\nb\n")
    block = readme_commands.Block(1, "echo a", 0, False, "a\n")
    expect("readme: what it printed", readme_commands.run_block(block, ".", None) is None)
    block.output = "b\n"
    expect("readme: not what it printed", readme_commands.run_block(block, ".", None) is not None)
    for broken in ("<!-- ctest: run -->\ntext\n", "<!-- ctest: run often -->\n```sh\n```\n"):
        try:
            list(readme_commands.marked_blocks(broken))
            expect(f"readme: a broken mark passes: {broken!r}", False)
        except ValueError:
            pass


def readme_figures_notice():
    for claim, record, is_same in [
            ("15.1", "15.06", True), ("15.1", "15.16", False), ("114", "114.10", True),
            ("2,000", "2000", True), ("0.63", "0.63", True), ("0.63", "0.6", False)]:
        expect(f"readme_figures: {claim} of {record}",
               readme_figures.same(claim, record) == is_same)
    claims = [("a", r"takes (\d+) us", "b", r"\| (\d+) \|")]
    for page, count in [("takes 5 us", 0), ("takes 6 us", 1), ("took 5 us", 1)]:
        found = list(readme_figures.claim_faults({"a": page, "b": "| 5 |"}, claims))
        expect(f"readme_figures: {page}", len(found) == count)
    times = ("which the README has:\naxguard avx 0.63 4.24 6.68 99 0 0\n"
             "ODE mesh 3.98 64.39 114.10 99 0 0\n")
    page = "| axguard, AVX | 0.63 | 4.24 | 6.68 |\n| ODE 0.16 | 3.98 | 64.4 | 114 |\n"
    readme = "all five libraries find the 99 contacts\n" + page
    bars = "<t>axguard</text><t>0.63, 6.68</text><t>ODE</text><t>3.98, 114</text>"
    for what, arguments, is_right in [
            ("as recorded", (readme, page, times, bars), True),
            ("a figure", (readme.replace("64.4", "64.5"), page, times, bars), False),
            ("a row less", (readme, page.split("\n", maxsplit=1)[0], times, bars), False),
            ("a missed contact", (readme, page, times.replace("99 0 0", "98 1 0"), bars), False),
            ("a bar", (readme, page, times, bars.replace("114", "115")), False)]:
        expect(f"readme_figures: {what}",
               is_right == (not list(readme_figures.peer_faults(*arguments))))
    for words_of_link, is_right in [("116 s", True), ("2 min", True), ("120 s", False),
                                    ("3 min", False), ("soon", True)]:
        link = f"[{words_of_link}](docs/measurements/fresh-debian.md)"
        expect(f"readme_figures: a demo of {words_of_link}", is_right == (
            not list(readme_figures.demo_faults(link, "| `./demo.sh` | 116 s |"))))
    rule = "| share of it for the longest cycle | 0.9 |"
    for most, is_right in [(450, True), (475, False)]:
        text = f"takes at most {most} us; the default deadline is 500 us"
        expect(f"readme_figures: at most {most} us",
               is_right == (not list(readme_figures.deadline_faults(text, rule))))


def readme_example_notices():
    claim = readme_example.REVIEW.search(
        "In the example two lines stay, the limits of one axes and `stop_reversal`: more")
    axis, key = "init: X: {slot: 0, kind: linear, ...", "init: stop_reversal: jerk_limited"
    for lines, is_right in [([axis, key], True), ([axis], False), ([axis, key, key], False),
                            ([axis, axis], False), ([key, "init: tool: true"], False)]:
        expect(f"readme_example: {lines}",
               is_right == (not list(readme_example.review_faults(claim, lines))))
    own = {"hashes": {"kinematics": "a"}, "tools": [{"number": 1, "length_mm": 140.0}]}
    for ours, is_right in [(own, True), ({**own, "hashes": {"kinematics": "b"}}, False),
                           ({**own, "tools": [{"number": 1, "length_mm": 141.0}]}, False)]:
        expect(f"readme_example: {ours}",
               is_right == (not list(readme_example.machine_faults(ours, own))))
    right = {"height": "29", "stop": "27", "braking": "17", "proof": "34", "with_jerk": "26"}
    machine = {"axes": [{"name": "Z", "stopping_distance": 17.4}]}
    stop = {"axes": {"Z_mm": -230.9}, "pairs": [{"clearance_mm": 29.1}],
            "why": {"needed_mm": 33.7, "reach": {"Z_mm": [-257.7, -230.9]}}}
    limited = {"pairs": [{"clearance_mm": 26.1}]}
    expect("readme_example: distances",
           not list(readme_example.distance_faults(right, machine, stop, limited)))
    for name in right:
        wrong = {**right, name: "3"}
        expect(f"readme_example: the distance {name}",
               len(list(readme_example.distance_faults(wrong, machine, stop, limited))) == 1)


def guide_blocks_name_user_and_mark():
    def faults(text):
        return [block for block in guide_blocks.blocks_of("p.md", text) if isinstance(block, str)]

    mark = '<!-- guest: run exit=0,14 until="a b" after="1 prints c" -->\n'
    text = mark + "```sh\n# user, terminal 2, on the PC\ntrue\n```\n\n```text\nd\n```\n"
    block, = guide_blocks.blocks_of("p.md", text)
    expect("guide: who and where", (block.user, block.terminal) == ("user", "2"))
    expect("guide: options", (block.exit_codes, block.until, block.after) ==
           ((0, 14), "a b", "1 prints c"))
    expect("guide: its output", block.output == "d\n")
    block, = guide_blocks.blocks_of(
        "p.md", "<!-- guest: left out: no bus -->\n```sh\n# root\ntrue\n```\n")
    expect("guide: left out", (block.user, block.left_out) == ("root", "no bus"))
    fence = "```sh\n# user\ntrue\n```\n"
    for good in ("<!-- guest: run -->\n", "<!-- ctest: run exit=3 -->\n"):
        expect(f"guide: {good!r}", not faults(good + fence))
    for bad in (fence, "\n" + fence, "<!-- guest: left out: -->\n" + fence,
                "<!-- guest: run often=1 -->\n" + fence, "<!-- ctest: run data -->\n" + fence,
                "<!-- guest: run -->\n```sh\ntrue\n```\n", "<!-- guest: run -->\n\n" + fence):
        expect(f"guide: passes: {bad!r}", faults(bad))


def links_are_found():
    page = "[a](b.md) [c](https://x.org) [d](#e)\n```sh\n[f](g.md)\n```\n[h](../i.md#j)\n"
    expect("links: of a page", list(links.targets("docs/p.md", page)) ==
           [(1, "docs/b.md", None), (1, "docs/p.md", "e"), (5, "i.md", "j")])
    expect("links: of a comment", [target for _, target, _ in links.targets(
        "core/x.hpp", "// Source: docs/accuracy.md, section 1\n// see other/docs/no.md\n")] ==
           ["docs/accuracy.md"])
    expect("links: headings", links.headings("# A `b` (c), d\n```\n# no\n```\n## E\n## E\n") ==
           {"a-b-c-d", "e", "e-1"})
    for index, bad in [("[a](a.md)", False), ("[a](b.md)", True)]:
        expect(f"links: index {index}", bool(list(links.unlinked(
            {"docs/guide/index.md": index, "docs/guide/a.md": ""}))) == bad)


def sections_and_tests_are_found():
    text = '// Source: docs/p.md, "A b" and\n// "C". Tests: x_test,\n// y_test.\nint z_test;\n'
    expect("links: sections", list(links.sections(text)) == [(1, "docs/p.md", "A b"),
                                                             (1, "docs/p.md", "C")])
    expect("links: tests", list(links.named_tests(text)) == [(1, "x_test"), (1, "y_test")])
    for page, has in [("## A b\n", True), ("## 2. A b\n", True), ("- **A b** is\n", True),
                      ("| `A b` |\n", True), ("of A b\n", False), ("## Not A b\n", False)]:
        expect(f"links: has_section {page!r}", links.has_section(page, "A b") == has)


def comments_notice():
    for text, bad in [
            ("// It knows nothing.\n", True), ("// The known-answer test.\n", False),
            ('f("it knows");\n', False), ("// NOLINT: as told\n", False),
            ("// What is open.\n", True), ("// It is\n// What it is.\n", False),
            ("int a = 1'000;  // it's what it keeps\n", True)]:
        found = list(comments.faults_of("room", comments.sentences_of(text)))
        expect(f"comments: {text}", bool(found) == bad)
    few = ["Returns the pose of a body. " * 60, "It keeps the pose."]
    expect("comments: a few are no fault", not list(comments.faults_of("room", few)))


def commits_notice():
    core, docs = "core/a/x.cpp", "docs/x.md"
    for subject, body, name, bad in [
            ("core: pose boxes", "Why.", core, False), ("core: " + 67 * "a", "Why.", "", True),
            ("core: pose boxes", "", core, True), ("docs: shorten", "", docs, False),
            ("tests: pose boxes", "", "tests/unit/" + core, False)]:
        log = f"\x01abc\x02{subject}\x02{body}\n\x02\n\n{name}\n"
        expect(f"commits: {subject}, {name}", bool(list(commits.faults_of(log))) == bad)


def words_notice():
    old = words.old_words("- **b**: x. *Not: kept\n  back, answer.*\n")
    expect("words: of the glossary", old == {"kept back"})
    for text, bad in [
            ("it was kept back", True), ("it was `kept back`", False),
            ("```\nkept back\n```", False), ("withheld", False)]:
        expect(f"words: {text}", bool(list(words.word_faults("p.md", text, old))) == bad)
    for text, bad in [
            ('f("it was kept " /* a */\n  "back");', False),
            ('f("it was kept "\n  "back: {}");', True),
            ('f("kept_back");  // kept back', False), ('f("got {}");', True), ('f("got");', False),
            ('f("queries of --got a {}");', False), ("c == '\"' && d; // got it, \"", False),
            ('f(R"(x\n got it)");', True), ('f("a \\" got it");', True)]:
        found = words.message_faults("a.cpp", text, old | {"got"})
        expect(f"words: message {text}", bool(list(found)) == bad)
    one = "One of " + "ten " * 17 + "words."
    for what, text, bad in [
            ("sentences of 20", one + " " + one, False),
            ("a sentence of 21", one.replace("One", "Not one"), True),
            ("a short one beside a long one", "Two words. " + one.replace("One", "Not one"), False),
            ("a formula begins a sentence", one + " u is one. " + one, False),
            ("signs of a formula", one + " + = <", False),
            ("a sentence of 40", "Go on. " * 9 + "Of " + "ten " * 38 + "words.", False),
            ("a sentence of 41", "Go on. " * 9 + "Of " + "ten " * 39 + "words.", True),
            ("a long link is its text", "Read [a page](" + "a/" * 20 + ").", False),
            ("a long span is one word", "Run `" + "a " * 30 + "b`.", False),
            ("120 words", "A b. " * 60, False), ("122 words", "A b. " * 61, True),
            ("items count apart", "- x\n" * 130, False),
            ("a cell of 25", "| " + "a " * 25 + "| b |", False),
            ("a cell of 26", "| b | " + "a " * 26 + "|", True),
            ("a cell of code", "| `" + "a " * 40 + "` | b |", False),
            ("100 columns", "Abc. " * 19 + "Abcde", False),
            ("101 columns", "Abc. " * 19 + "Abcdef", True),
            ("an address", "See [it](https://" + "a" * 90 + ").", False),
            ("code is not wrapped", "```\n" + "ab " * 50 + "\n```", False)]:
        text = text if "columns" in what else wrapped(text)
        expect(f"words: {what}", bool(list(words.reading_faults("p.md", text))) == bad)
    most = words.SHELVES["guide"][1]
    for count, bad in [(most, False), (most + 1, True)]:
        expect(f"words: {count} in the guide", bool(list(words.shelf_faults(
            {"README.md": 1, "docs/guide/a.md": count - 1}))) == bad)
    expect("words: marks are none", words.word_count("| a | - b |\n|---|") == 2)
    page = "one two\n<!-- made: x -->\n\n| three |\n\n<!-- end -->\n```sh\nfour\n```\nfive\n"
    expect("words: neither fences nor made parts", words.page_words(page) == 3)


def wrapped(text):
    """Lines of prose at most 80 columns long, so that only what is meant is at fault."""
    if text.startswith(("|", "```", "- ", "See")) or len(text) <= 100:
        return text
    return textwrap.fill(text, 80)


def mutant_lists_notice():
    if mutant_list.tomllib is None:
        return
    names = mutant_list.names_of_tests("TEST(A, B) {\nTEST_F(C,\n       D) {\n")
    expect("mutant_list: names of tests", names == {"A.B", "C.D"})
    entry = '[[mutant]]\nfile = "f"\nfind = "x"\nput = "y"\ntest = "unit_tests {0}"\nwhy = "w"\n'
    for test, text, bad in [
            ("A.B", "x", False), ("C.*:A.B", "ax", False), ("A.B", "xx", True), ("A.B", "", True),
            ("A.B", "y", True), ("A.C", "x", True), ("A.B:E.*", "x", True), ("A.B", None, True)]:
        mutants, faults = mutant_list.read_list(entry.format(test))
        expect("mutant_list: a list", len(mutants) == 1 and not faults)
        found = list(mutant_list.faults_of(mutants[0], text, names))
        expect(f"mutant_list: {test} in {text!r}", bool(found) == bad)
        expect("mutant_list: its line", all(":1: " in fault for fault in found))
    for broken in ("[[mutant]]", entry.replace("why", "reason"), entry + "[", entry + "[[mutant]]"):
        expect(f"mutant_list: {broken[-20:]!r}", len(mutant_list.read_list(broken)[1]) == 1)


def isa_symbols_notice():
    for line, bad in [
            ("0000000000000000 T axg::avx2_kernels()", False),
            ("0000000000000010 t traverse(int)", False),
            ("0000000000000000 W std::span<int>::data() const", True),
            ("0000000000000000 V vtable for x", True), ("0000000000000000 u x", True),
            ("0000000000000000 T axg::moved(int)", True), ("0000000000000000 r x", False)]:
        expect(f"isa_symbols: {line}", bool(list(isa_symbols.symbol_faults("u", line))) == bad)
    cmake = ("set(AXG_AVX512_OPTIONS -mavx512f -mfma\n -mprefer-vector-width=512 -O3)"
             "set(AXG_AVX2_OPTIONS -mavx2 -mfma)")
    case = "case LaneSet::{0}:\n return {0}_kernels() != nullptr && has(\"{1}\") && has(\"fma\");"
    good = case.format("avx512", "avx512f") + case.format("avx2", "avx2")
    expect("isa_symbols: all asked for", not list(isa_symbols.option_faults(cmake, good)))
    for missing in ("avx512f", "avx2"):
        faults = list(isa_symbols.option_faults(cmake, good.replace(f'"{missing}"', '"sse"')))
        expect(f"isa_symbols: {missing} is not asked for", len(faults) == 1)
    expect("isa_symbols: the check is gone", len(list(isa_symbols.option_faults("", ""))) == 2)


def deployed_symbols_notice():
    for line, found in [
            ("0000000000001000 T axg::lab::forget_dead_man(axg::BoardOptions&)",
             ["axg::lab::forget_dead_man"]),
            ("0000000000001000 T axg::free_seconds(axg::Machine const&)", []),
            ("0000000000001000 t axg::laboratory()", [])]:
        expect(f"deployed_symbols: {line}", deployed_symbols.laboratory_in(line) == found)
    for text, bad in [("--ablate", True), ("kJerkOfAnAblation", True), ("Wrong on purpose:", True),
                      ("bool forgets_jerk_ramp = false", True), ("forgets_drops_", False),
                      ("has_dead_man", True), ("the board's dead man", False),
                      ("forget_path_limits", True), ("tablature", False)]:
        expect(f"deployed_symbols: {text}", bool(deployed_symbols.words_in(text)) == bad)
    for text, bad in [("options.guard.supposes_arming = true;", True),
                      ("LiveOptions{.supposes_arming = is_trace}", True),
                      (".supposes_arming{true}", True), ("bool supposes_arming = false;", False),
                      ("supposes_arming_(options.supposes_arming) {", False),
                      ("options.supposes_arming == true", False)]:
        expect(f"deployed_symbols: {text}", deployed_symbols.supposes_in("a.cpp", text) == bad)
    expect("deployed_symbols: a trace's guard",
           not deployed_symbols.supposes_in(deployed_symbols.SUPPOSING, "supposes_arming = true"))


def figure_labels_notice():
    def svg(*places):
        return '<svg viewBox="0 0 600 100">' + "".join(
            f'<text style="font: 12px Arial; text-anchor: {a}" x="{x}" y="{y}" '
            f'transform="rotate(-0 {x} {y})">some words</text>' for x, y, a in places)
    for places, faults in [
            ([(10, 20, "start"), (10, 40, "start")], 0),
            ([(10, 20, "start"), (40, 22, "start")], 1),
            ([(10, 20, "end")], 1), ([(590, 20, "start")], 1), ([(300, 5, "middle")], 1),
            ([(10, 20, "start"), (200, 20, "end")], 0), ([], 1)]:
        found = list(figure_labels.faults_in("f.svg", svg(*places)))
        expect(f"figure_labels: {places}", len(found) == faults)


def rare(name, *labels):
    return {"name": name, "properties": [{"name": "LABELS", "value": ["rare", *labels]}]}


def changes_reach():
    """In a repository of four files: a header, who includes it, another room, and a script."""
    files = {"core/base/a.hpp": "", "core/guard/b.cpp": '#include "core/base/a.hpp"\n',
             "core/mesh/c.cpp": "", "tests/can_vm/d.py": ""}
    tests = [rare("base", "core.base"), rare("guard", "core.guard"), rare("mesh", "core.mesh"),
             rare("script", "files:tests/can_vm/*.py"), {"name": "usual", "properties": []}]
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        for file, text in files.items():
            (root / file).parent.mkdir(parents=True, exist_ok=True)
            (root / file).write_text(text)

        def git(*words):
            return subprocess.run(["git", "-C", root, "-c", "user.name=a", "-c", "user.email=a",
                                   *words], check=True, capture_output=True, text=True).stdout
        git("init", "-q")
        git("add", ".")
        git("commit", "-q", "-m", "a")
        head = git("rev-parse", "HEAD").strip()
        os.environ.pop("AXG_CHECKED_COMMIT", None)  # whoever runs this test may have named one
        record = root / changed.RECORD
        record.parent.mkdir(parents=True)
        record.write_text(f"run,commit\nday,{'0' * 40},\nnight,{head},2026-11-29,EPYC,tidy,5\n")
        git("add", ".")
        for file, left in [
                (None, ["base", "guard", "mesh", "script"]),
                ("core/base/a.hpp", ["mesh", "script"]),
                ("core/mesh/c.cpp", ["base", "guard", "script"]),
                ("tests/can_vm/d.py", ["base", "guard", "mesh"])]:
            if file:
                (root / file).write_text(files[file] + "// changed\n")
            found = list(changed.left_out(tests, changed.Change(root)))
            expect(f"changed: {file}: left out {found}", found == left)
            git("checkout", "-q", head, "--", *files)
        record.write_text("night," + "1" * 40 + ",")
        expect("changed: git does not know the commit, so everything has changed",
               not list(changed.left_out(tests, changed.Change(root))))


def step_tables_warn():
    lines = list(step_table.table([("a", 60), ("b", 2400)], {"a": 50}))
    expect("step_table: the sum and a warning", "2460" in lines[3] and "warning" in lines[4])
    lines = list(step_table.table([("a", 60)], {}))
    expect("step_table: no record, no warning", len(lines) == 3 and "-" in lines[1])


def main():
    changes_reach()
    step_tables_warn()
    figure_labels_notice()
    expect("blanking keeps lines",
           without_comments_and_strings('a /* x\ny */ "s" // c\nb').count("\n") == 2)
    layers_notice()
    banned_calls_notice()
    files_notice()
    contraction_flags_notice()
    shared_copies_notice()
    readme_blocks_are_found()
    readme_figures_notice()
    readme_example_notices()
    guide_blocks_name_user_and_mark()
    links_are_found()
    sections_and_tests_are_found()
    comments_notice()
    commits_notice()
    words_notice()
    mutant_lists_notice()
    isa_symbols_notice()
    deployed_symbols_notice()
    finish(FAULTS)


if __name__ == "__main__":
    sys.exit(main())
