#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Comments in the words of the field: per room, how often they use a verb that only this project
gives its meaning, and how many of their sentences open without a subject.

comments.py SOURCE_DIR [ROOM]: with ROOM, lists the sentences of it that count."""
import pathlib
import re
import sys

from sources import TOKEN, finish, is_cpp, read_text, tracked_files

FOLDERS = ("core/", "cuda/", "config/", "firmware_if/", "hil_replay/")
VERBS_MAX, OPENERS_MAX = 5.0, 2.0  # per 1,000 words, percent of the sentences
VERBS = re.compile(
    r"\b(?:says?|said|saying|tells?|told|telling|asks?|asked|asking|knows?|knew|known|knowing|"
    r"stands?|stood|standing|lies?|lay|lain|lying|keeps?|kept|keeping|hears?|heard|hearing|"
    r"takes?|took|taken|taking|wants?|wanted|wanting|(?:comes?|came|coming) to)\b", re.I)
TERMS = re.compile(r"\bknown[- ]answers?\b|@\w+(?:\s+\w+)?", re.I)  # of the field, of Doxygen
OPENERS = re.compile(r"^(?:What|Whoever|Whatever|Whose|Who|Of|Where|Wherever|That|None|Nothing)\b")
SENTENCE = re.compile(r"(?<=[.:;?!])\s+(?=[A-Z])")
NOT_PROSE = re.compile(r"/[/*]+\s*(?:SPDX-|NOLINT|clang-format|ctest-labels)")


def sentences_of(text):
    """Comments one below the other are one text."""
    blocks, end = [], -1
    for match in TOKEN.finditer(text):
        piece = match.group()
        if not piece.startswith(("//", "/*")) or NOT_PROSE.match(piece):
            continue
        words = re.sub(r"^(?:/\*+|//[/!<]*)|\*/$", "", piece).strip()
        words = TERMS.sub("", re.sub(r"\n\s*\*? ?", " ", words))
        if blocks and re.fullmatch(r"\n[ \t]*", text[end:match.start()]):
            blocks[-1] += " " + words
        else:
            blocks.append(words)
        end = match.end()
    return [sentence for block in blocks for sentence in SENTENCE.split(block.strip()) if sentence]


def faults_of(room, sentences):
    words = sum(len(re.findall(r"[A-Za-z][A-Za-z'-]*", sentence)) for sentence in sentences)
    verbs = 1000 * sum(len(VERBS.findall(sentence)) for sentence in sentences) / max(words, 1)
    openers = 100 * sum(bool(OPENERS.match(each)) for each in sentences) / max(len(sentences), 1)
    for found, most, what in ((verbs, VERBS_MAX, "private verbs per 1,000 words"),
                              (openers, OPENERS_MAX, "% of sentences open without a subject")):
        if found > most:
            yield (f"{room}: comments: {found:.1f} {what}, wanted at most {most:.1f} "
                   f"(tests/style/comments.py . {room} lists them)")


def main():
    root = pathlib.Path(sys.argv[1])
    rooms = {}
    for name in tracked_files(root):
        if is_cpp(name) and name.startswith(FOLDERS):
            rooms.setdefault(str(pathlib.PurePath(name).parent), {})[name] = (
                sentences_of(read_text(root, name)))
    if len(sys.argv) > 2:
        for name, sentences in rooms.get(sys.argv[2], {}).items():
            for sentence in sentences:
                if VERBS.search(sentence) or OPENERS.match(sentence):
                    print(f"{name}: {sentence}")
        return
    finish([fault for room, files in sorted(rooms.items())
            for fault in faults_of(room, [each for found in files.values() for each in found])])


if __name__ == "__main__":
    main()
