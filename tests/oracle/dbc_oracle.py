#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Random frames of random DBC files, and of real ones, mean the same to our reader and to cantools.

usage: dbc_oracle.py PROGRAM [DBC...]     AXG_COUNT files, AXG_SEED; skipped without cantools
"""
import math
import os
import random
import subprocess
import sys
import tempfile

SKIPPED = 77
EXTENDED = 1 << 31
LENGTHS = list(range(1, 9)) + [12, 16, 20, 24, 32, 48, 64]


def bits_of(start, length, little):
    """The bits of a signal as a DBC file numbers them."""
    bits = []
    bit = start
    for _ in range(length):
        bits.append(bit)
        bit = bit + 1 if little else (bit + 15 if bit % 8 == 0 else bit - 1)
    return bits


def random_signal(chance, size, taken):
    """(start, length, little, kind) on free bits, or None."""
    for _ in range(30):
        kind = chance.choice(["int"] * 4 + ["float", "double"])
        length = {"int": chance.randint(1, 53), "float": 32, "double": 64}[kind]
        little = chance.random() < 0.5
        start = chance.randrange(8 * size)
        bits = bits_of(start, length, little)
        if max(bits) < 8 * size and not taken.intersection(bits):
            taken.update(bits)
            return start, length, little, kind
    return None


def line_of(chance, name, turn, signal):
    start, length, little, kind = signal
    factor = chance.choice([1, 0.1, 1e-4, -0.25, chance.uniform(-5, 5) or 1])
    offset = chance.choice([0, 0, -40, chance.uniform(-100, 100)])
    sign = "-" if kind != "int" or chance.random() < 0.5 else "+"
    return (f" SG_ {name} {turn}: {start}|{length}@{int(little)}{sign} "
            f"({factor!r},{offset!r}) [0|0] \"\" Guard\n")


def ranges_of(chance, values):
    """Some of the values as SG_MUL_VAL_ writes them, and one of them."""
    chosen = sorted(chance.sample(values, chance.randint(1, len(values))))
    pairs = [[value, value] for value in chosen]
    if chance.random() < 0.5:  # as few ranges as there can be
        joined = []
        for value in chosen:
            if joined and joined[-1][1] + 1 == value:
                joined[-1][1] = value
            else:
                joined.append([value, value])
        pairs = joined
    return ", ".join(f"{least}-{most}" for least, most in pairs), chance.choice(chosen)


def extended_signals(chance, can_id, size):
    """The signals of a message with one or two M, and multiplexors within pages; types; pages."""
    taken, multiplexors, lines, types, pages = set(), [], "", "", ""
    for number in range(chance.randint(2, 4)):
        # No more ranges than a selector holds: 4 of 3 bits, 2 of 2, and one of 1.
        length, little = chance.randint(1, 3 if number == 0 else 2), chance.random() < 0.5
        free = [start for start in range(8 * size)
                if not taken.intersection(bits_of(start, length, little)) and
                max(bits_of(start, length, little)) < 8 * size]
        if not free:
            break
        start = chance.choice(free)
        taken.update(bits_of(start, length, little))
        name, turn = f"Mux{number}", "M"
        if multiplexors and (number > 1 or chance.random() < 0.6):
            other, values = chance.choice(multiplexors[:2])
            text, value = ranges_of(chance, values)
            turn = f"m{value}M"
            pages += f"SG_MUL_VAL_ {can_id} {name} {other} {text};\n"
        sign, bits = ("-", length - 1) if length > 1 and chance.random() < 0.3 else ("+", length)
        multiplexors.append((name, list(range(2 ** bits))))
        lines += (f" SG_ {name} {turn} : {start}|{length}@{int(little)}{sign} "
                  f"(1,0) [0|0] \"\" Guard\n")
    for number in range(chance.randint(1, 6)):
        signal = random_signal(chance, size, taken)
        if signal is None:
            continue
        name, turn = f"S{number}", ""
        if chance.random() < 0.8:
            other, values = chance.choice(multiplexors)
            text, value = ranges_of(chance, values)
            turn = f"m{value} "
            pages += f"SG_MUL_VAL_ {can_id} {name} {other} {text};\n"
        lines += line_of(chance, name, turn, signal)
        if signal[3] != "int":
            types += f"SIG_VALTYPE_ {can_id} {name} : {1 + (signal[3] == 'double')};\n"
    return lines, types, pages


def random_dbc(chance):
    """The text of a DBC file, and the length of each message by its id as the file writes it: bit
    31 marks 29 bits, and two messages have one number in both kinds."""
    text = 'VERSION ""\n\nNS_ :\n\tCM_\n\nBS_:\n\nBU_: Board Guard\n\n'
    types = values = ""
    lengths = {}
    standard = chance.sample(range(1, 2048), 4)
    extended = [standard[0], *chance.sample(range(2048, 1 << 29), 3)]
    for number, can_id in enumerate(standard + [EXTENDED | one for one in extended]):
        size = chance.choice(LENGTHS)
        lengths[can_id] = size
        text += f"BO_ {can_id} M{number}: {size} Board\n"
        if chance.random() < 0.3:
            lines, more_types, more_values = extended_signals(chance, can_id, size)
            text += lines + "\n"
            types += more_types
            values += more_values
            continue
        common = set()
        selector = None
        if chance.random() < 0.4:
            width = chance.randint(1, min(8, 8 * size))
            start = chance.randrange(8 * size - width + 1)
            common.update(bits_of(start, width, True))
            selector = width
            text += f" SG_ Page M : {start}|{width}@1+ (1,0) [0|0] \"\" Guard\n"
        pages = [""] if selector is None else [""] + [
            f"m{page} " for page in chance.sample(range(2 ** selector),
                                                  min(3, 2 ** selector))]
        for page, turn in enumerate(pages):
            taken = common if turn == "" else set(common)
            for i in range(chance.randint(0 if turn == "" else 1, 4)):
                signal = random_signal(chance, size, taken)
                if signal is not None:
                    name = f"S{page}_{i}"
                    text += line_of(chance, name, turn, signal)
                    if signal[3] != "int":
                        types += f"SIG_VALTYPE_ {can_id} {name} : {1 + (signal[3] == 'double')};\n"
        text += "\n"
    return text + types + values, lengths


def ours(program, path, frames):
    given = "".join(f"{can_id} {data.hex()}\n" for can_id, data in frames)
    said = subprocess.run([program, path], input=given, capture_output=True, text=True, check=False)
    if said.returncode != 0:
        raise SystemExit(f"{path}: {said.stderr}")
    answers = []
    for line in said.stdout.splitlines():
        name, value = line.split(" ")
        if name == "frame":
            answers.append({})
        else:
            answers[-1][name] = float.fromhex(value)
    return answers


def cantools_if_there():
    """The module; None, and said why the test is skipped: it is not installed."""
    try:
        import cantools
    except ImportError:
        print("skipped: no python module cantools "
              "(pip install --require-hashes -r tests/oracle/requirements.txt)")
        return None
    return cantools


def wire_id(message):
    return message.frame_id | (EXTENDED if message.is_extended_frame else 0)


def same(one, other):
    if math.isnan(one) or math.isnan(other):
        return math.isnan(one) and math.isnan(other)
    return one == other or abs(one - other) <= 1e-12 * max(abs(one), abs(other))


def on_a_page(chance, message, data):
    """The frame, each of its multiplexors with the value of some page: chance meets few."""
    data = bytearray(data)
    for signal in message.signals:
        values = sorted({value for other in message.signals
                         if other.multiplexer_signal == signal.name
                         for value in other.multiplexer_ids or []})
        if not values:
            continue
        value, little = chance.choice(values), signal.byte_order == "little_endian"
        bits = bits_of(signal.start, signal.length, little)
        for weight, bit in enumerate(bits if little else reversed(bits)):
            data[bit // 8] &= ~(1 << bit % 8)
            data[bit // 8] |= (value >> weight & 1) << bit % 8
    return bytes(data)


def compare(program, path, database, lengths, chance):
    """How many values were compared."""
    messages = {wire_id(message): message for message in database.messages}
    frames = [(can_id, chance.randbytes(size))
              for can_id, size in lengths.items() for _ in range(20)]
    frames += [(can_id, on_a_page(chance, messages[can_id], data)) for can_id, data in frames]
    compared = 0
    for (can_id, data), answer in zip(frames, ours(program, path, frames), strict=True):
        try:
            wanted = messages[can_id].decode(data, decode_choices=False)
        except Exception as error:  # a page that the file does not have: nothing of it is decoded
            if "multiplexer" not in str(error).lower():
                raise
            continue
        for name, value in wanted.items():
            if name not in answer:
                raise SystemExit(f"{path}: {can_id} {name}: not read by us")
            if not same(float(value), answer[name]):
                raise SystemExit(f"{path}: {can_id} {name} of {data.hex()}: "
                                 f"{answer[name]!r}, cantools says {value!r}")
            compared += 1
        if set(answer) != set(wanted):
            raise SystemExit(f"{path}: {can_id}: we read {set(answer) - set(wanted)} besides")
    return compared


def main():
    cantools = cantools_if_there()
    if cantools is None:
        return SKIPPED
    program, files = sys.argv[1], sys.argv[2:]
    if not os.path.exists(program):
        print(f"skipped: no {program}")
        return SKIPPED
    seed = int(os.environ.get("AXG_SEED", "402"))
    count = int(os.environ.get("AXG_COUNT", "60"))
    print(f"seed {seed} (AXG_SEED overrides it), {count} files")
    chance = random.Random(seed)
    compared = 0
    with tempfile.TemporaryDirectory() as folder:
        for number in range(count):
            text, lengths = random_dbc(chance)
            path = os.path.join(folder, f"{number}.dbc")
            with open(path, "w", encoding="ascii") as file:
                file.write(text)
            database = cantools.database.load_string(text, "dbc")
            compared += compare(program, path, database, lengths, chance)
        for path in files:
            database = cantools.database.load_file(path, "dbc", strict=False)
            lengths = {wire_id(message): message.length for message in database.messages
                       if message.length > 0}
            more = compare(program, path, database, lengths, chance)
            print(f"{os.path.basename(path)}: {more} values agree")
            compared += more
    print(f"{compared} values agree")
    return 0 if compared > 0 or count == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
