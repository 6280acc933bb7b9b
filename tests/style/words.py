#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How many words each shelf of pages has, and how they read: docs/style.md has the rules.

A shelf's words are those of its pages, tables included, but neither fences nor the parts that a
program makes. Sentences are counted in prose only: no headings, tables, fences or formulas. A code
span is one word. Words that the glossary replaces (its "Not: ...") are looked for outside code, and
in the sentences that programs print.
"""
import fnmatch
import pathlib
import re
import sys

from sources import finish, read_text, tracked_files

# Pages, most words of all of them: a limit against growth. The first four sum to 54,128.
SHELVES = {
    "guide": (["README.md", "docs/guide/*"], 10_760),
    "theory": (["docs/theory/*"], 14_097),
    "reference": (["docs/reference/*"], 20_481),
    "measurements and decisions": (["docs/measurements/*", "docs/decisions/*"], 8_790),
    "rules": (["CONTRIBUTING.md", "docs/glossary.md", "docs/style.md"], 3_760),
}
PARAGRAPH_WORDS_MAX = 120
CELL_WORDS_MAX = 25
LINE_COLUMNS_MAX = 100
SENTENCE_WORDS_MEAN_MAX = 20
SENTENCE_WORDS_MAX = 40
UNBROKEN_COLUMNS = 60  # a longer word, such for example an address, may end beyond the line's limit
GLOSSARY = "docs/glossary.md"
NAMES_OLD_WORDS = {GLOSSARY, "docs/decisions/renames.md", "docs/style.md", "CHANGELOG.md"}
# Words that the glossary replaces in one sense, and that have others.
OTHER_SENSES = {
    "answer", "ask", "bench", "box", "clipped", "dive", "echo", "hd.hpp", "hints", "leave out",
    "level", "look inside", "plan", "progress", "question", "ready", "refine", "revolve", "room",
    "solids", "turned", "walk", "say_", "tell_", "_words"}
# Never in what a program prints, whatever a page may say.
MESSAGE_WORDS = {
    "got", "wanted", "nobody", "so many", "to look at", "pictures", "questions", "says", "asked",
    "besides", "their share", "its share", "no place for", "without a word", "frames of ours"}
PRINTS = re.compile(r"^(?:config|core|firmware_if|hil_replay)/.+\.(?:cpp|hpp)$")
# Not yet in these words: kernels, and the figures of the laboratory.
OLD_MESSAGES = re.compile(r"^(?:core/worst_case/|hil_replay/lab/(?:chart/|bench/paper_)|"
                          r"hil_replay/gcode/gcode_words\.cpp)")
OPTION_NAMES = re.compile(r"--[a-z-]+")
CPP_TOKEN = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"\((.*?)\)"|"((?:[^"\\\n]|\\.)*)"|\'(?:[^\'\\\n]|\\.)+\'', re.S)
FENCE = re.compile(r"^( *)(`{3,}|~{3,}).*?^\1\2`*\s*$", re.S | re.M)
MADE = re.compile(r"^<!-- made: .*?^<!-- end -->$", re.S | re.M)
COMMENT = re.compile(r"<!--.*?-->", re.S)
SPAN = re.compile(r"(`+).+?\1", re.S)
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
ITEM = re.compile(r"^\s*(?:[-*+]|\d+\.)\s+")
# A sentence of a proof may begin with a variable: one small letter.
SENTENCE_END = re.compile(r"(?<=[.!?])[\"')\]*_]*\s+(?=[\"'(\[*_|]*(?:[A-Z0-9]|[a-z](?![a-z])))")


def without_code(text):
    """The same lines, with fences and comments empty."""
    def blank(match):
        return "\n" * match.group().count("\n")
    return COMMENT.sub(blank, FENCE.sub(blank, text))


def plain(text):
    """Links as their texts, a code span as one word."""
    text = SPAN.sub("Code", text)
    return LINK.sub(r"\1", LINK.sub(r"\1", text)).replace("**", "")


def blocks_of(text):
    """(line, prose) of each paragraph and each item of a list."""
    block, start, indented = [], 0, False
    for number, line in enumerate(without_code(text).split("\n") + [""], 1):
        is_prose = line.strip() and not re.match(r"\s*([|#>]|---|\$\$)", line)
        formula = re.match(r" {4,}\S", line) and not block and not indented
        if block and (not is_prose or ITEM.match(line)):
            yield start, plain(" ".join(block))
            block = []
        if ITEM.match(line):
            indented = True
        elif line.strip() and not line.startswith(" "):
            indented = False
        if is_prose and not formula:
            start = start if block else number
            block.append(ITEM.sub("", line).strip())


def word_count(text):
    """Bars and marks of Markdown, and the signs of a formula, are no words."""
    return sum(1 for word in text.split() if re.search(r"\w", word))


def page_words(text):
    return word_count(COMMENT.sub("", FENCE.sub("", MADE.sub("", text))))


def sentences_of(prose):
    return [part for part in SENTENCE_END.split(prose) if re.search(r"[A-Za-z]{2}", part)]


def cells_of(line):
    line = SPAN.sub("code", line.strip()).replace(r"\|", "/")
    return [plain(cell) for cell in line.strip("|").split("|")]


def old_words(glossary):
    """What the glossary replaces, as far as a word has no other sense."""
    found = set()
    for match in re.finditer(r"\*Not:\s+(.*?)\.\*", glossary, re.S):
        found |= {" ".join(word.split()).strip("`") for word in match.group(1).split(",")}
    return {word for word in found if word.lower() not in OTHER_SENSES}


def reading_faults(name, text):
    for number, line in enumerate(without_code(text).split("\n"), 1):
        if line.lstrip().startswith("|"):
            for cell in cells_of(line):
                if word_count(cell) > CELL_WORDS_MAX:
                    yield f"{name}:{number}: a cell of {word_count(cell)} words, " \
                          f"wanted at most {CELL_WORDS_MAX}: {cell.strip()[:40]}..."
        elif len(line) > LINE_COLUMNS_MAX and not re.match(r"\s*\[?!\[", line) and \
                max(map(len, line.split())) <= UNBROKEN_COLUMNS:
            yield f"{name}:{number}: {len(line)} columns, wanted at most {LINE_COLUMNS_MAX}"
    lengths = []
    for number, prose in blocks_of(text):
        if word_count(prose) > PARAGRAPH_WORDS_MAX:
            yield f"{name}:{number}: a paragraph of {word_count(prose)} words, " \
                  f"wanted at most {PARAGRAPH_WORDS_MAX}"
        own = [word_count(sentence) for sentence in sentences_of(prose)]
        if max(own, default=0) > SENTENCE_WORDS_MAX:
            yield f"{name}:{number}: a sentence of {max(own)} words, " \
                  f"wanted at most {SENTENCE_WORDS_MAX}"
        lengths += own
    if lengths and sum(lengths) > SENTENCE_WORDS_MEAN_MAX * len(lengths):
        yield f"{name}: {sum(lengths) / len(lengths):.1f} words a sentence on average, " \
              f"wanted at most {SENTENCE_WORDS_MEAN_MAX}"


def word_faults(name, text, words):
    lines = SPAN.sub("code", without_code(text)).split("\n")
    for number, line in enumerate(lines, 1):
        for word in words:
            if re.search(rf"\b{re.escape(word)}\b", line, re.I):
                yield f"{name}:{number}: \"{word}\" is not our word: {GLOSSARY} has the right one"


def literals_of(source):
    """(line, text) of each string literal of a C++ source; adjacent ones are one."""
    found, end = [], 0
    for match in CPP_TOKEN.finditer(source):
        text = match.group(1) or match.group(2)
        if text is not None:
            if found and not source[end:match.start()].strip():
                found[-1][1] += text
            else:
                found.append([source.count("\n", 0, match.start()) + 1, text])
            end = match.end()
    return found


def message_faults(name, source, words):
    """Sentences alone: one word by itself is a key or a name, which stays."""
    for line, text in literals_of(source):
        text = OPTION_NAMES.sub("", text)
        for word in words if " " in text.strip() else ():
            if re.search(rf"\b{re.escape(word)}\b", text, re.I):
                yield f"{name}:{line}: \"{word}\" in a message: {GLOSSARY} has the right word"


def shelf_faults(counts):
    """counts: words of each page."""
    for shelf, (patterns, most) in SHELVES.items():
        count = sum(words for name, words in counts.items()
                    if any(fnmatch.fnmatch(name, pattern) for pattern in patterns))
        if count > most:
            yield f"{shelf}: {count} words, wanted at most {most}: say it once, or in a table"


def is_on_a_shelf(name):
    patterns = [pattern for own, _ in SHELVES.values() for pattern in own]
    return name.endswith(".md") and any(fnmatch.fnmatch(name, pattern) for pattern in patterns)


def main():
    root = pathlib.Path(sys.argv[1])
    texts = {name: read_text(root, name) for name in tracked_files(root)
             if is_on_a_shelf(name) or name == "CHANGELOG.md"}
    words = old_words(texts[GLOSSARY])
    faults = list(shelf_faults({name: page_words(text) for name, text in texts.items()}))
    for name, text in texts.items():
        faults += reading_faults(name, text)
        faults += [] if name in NAMES_OLD_WORDS else word_faults(name, text, words)
    for name in tracked_files(root):
        if PRINTS.match(name) and not OLD_MESSAGES.match(name):
            faults += message_faults(name, read_text(root, name), words | MESSAGE_WORDS)
    finish(faults)


if __name__ == "__main__":
    main()
