#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The keys of the machine file as the tables of docs/reference/machine-file.md, from the schema.
    tests/tools/key_tables.py SCHEMA PAGE            prints the page with its tables made anew
    tests/tools/key_tables.py SCHEMA PAGE --write    writes it
"""
import json
import pathlib
import sys

from made_parts import table, with_parts

# Definitions with a table of their own; every other one is part of the table that refers to it.
OWN_TABLE = ("axis", "linear_axis", "rotary_axis", "mesh", "shape", "section", "body", "tool",
             "pair", "exclusion", "signal", "drive", "can")
LARGE = {"can": ["ids"]}  # parts of a table that have one of their own
IDENTIFIER_MAXIMA = (0x7FE, 0x7FF, 0x1FFFFFFF, 0x3FFFFFFF)
SIMPLE = {"integer": "integer", "number": "number", "string": "text", "boolean": "switch"}


def number(value):
    return f"{value:,}" if abs(value) >= 10000 else str(value)


def decimal(value):
    """With a point, which an integer has not."""
    return f"{float(value):,}" if abs(value) >= 10000 else str(float(value))


def hexadecimal(rule):
    return f"0x{rule['minimum']:03X} to 0x{rule['maximum']:03X}"


class Schema:
    def __init__(self, whole):
        self.whole = whole

    def definition(self, rule):
        """(name, rule) of what a rule refers to."""
        if "$ref" not in rule:
            return "", rule
        name = rule["$ref"].rsplit("/", 1)[1]
        return name, self.whole["definitions"][name]

    def value(self, rule):
        """What may stand behind a key."""
        name, rule = self.definition(rule)
        if name in OWN_TABLE:
            return f"[{name}](#keys-of-{name.replace('_', '-')})"
        if "enum" in rule:
            return ", ".join(f"`{word}`" for word in rule["enum"])
        if "oneOf" in rule and "type" not in rule:
            return " or ".join(self.value(choice) for choice in rule["oneOf"])
        kind = rule["type"]
        if kind == "array":
            return self.list_value(rule)
        if kind == "object":
            inner = rule.get("patternProperties")
            return "map of " + self.value(next(iter(inner.values()))) if inner else "map"
        if rule.get("maximum") in IDENTIFIER_MAXIMA or "Data ID" in rule.get("description", ""):
            return hexadecimal(rule)
        if "minimum" in rule:
            shown = number if kind == "integer" else decimal
            return f"{shown(rule['minimum'])} to {shown(rule['maximum'])}"
        return SIMPLE[kind]

    def list_value(self, rule):
        low, high = rule.get("minItems", 0), rule.get("maxItems")
        count = f"{low}" if low == high else f"{low} to {high}" if high else f"{low} or more"
        item = rule["items"]
        if isinstance(item, list):
            return f"{count} of: " + ", ".join(self.value(one) for one in item)
        return f"{count} of: {self.value(item)}"

    def rows(self, rule, prefix="", skipped=()):
        """A row of each key of an object, and of those within it without a table of their own."""
        for key, value in rule.get("properties", {}).items():
            if key in skipped:
                continue
            name, inner = self.definition(value)
            need = ", required" if key in rule.get("required", []) else ""
            meaning = value.get("description") or inner.get("description", "")
            yield [f"`{prefix}{key}`", self.value(value) + need, meaning]
            if name not in OWN_TABLE:
                yield from self.rows_within(inner, f"{prefix}{key}")

    def rows_within(self, rule, prefix):
        if "oneOf" in rule:
            for choice in rule["oneOf"]:
                yield from self.rows_within(self.definition(choice)[1], prefix)
        elif rule.get("type") == "object":
            yield from self.rows(rule, prefix + ".")
            for inner in rule.get("patternProperties", {}).values():
                name, inner = self.definition(inner)
                if name not in OWN_TABLE:
                    yield from self.rows_within(inner, prefix + ".NAME")
        elif rule.get("type") == "array" and isinstance(rule["items"], dict):
            name, inner = self.definition(rule["items"])
            if name not in OWN_TABLE:
                yield from self.rows_within(inner, prefix + "[]")


def distinct(rows):
    seen = {}
    for row in rows:
        seen.setdefault(row[0], row)
    return list(seen.values())


def parts_of(whole):
    schema = Schema(whole)
    head = ["Key", "Value", "Meaning"]
    made = {}
    sections = {name: rule for name, rule in whole["properties"].items()
                if rule.get("type") == "object" and "properties" in rule}
    top = dict(whole, properties={key: rule for key, rule in whole["properties"].items()
                                  if key not in sections})
    made["the top level"] = table(head, distinct(
        [row for row in schema.rows(top) if "." not in row[0] and "[" not in row[0]] +
        [[f"`{name}`", f"[map](#keys-of-{name.replace('_', '-')})", rule["description"]]
         for name, rule in sections.items()]))
    for name, rule in sections.items():
        made[name] = table(head, distinct(schema.rows(rule)))
    for name, rule in whole["properties"].items():  # a word, or a map with a table of its own
        for choice in rule.get("oneOf", []):
            if "properties" in choice:
                made[name] = table(head, distinct(schema.rows(choice)))
    shape = whole["definitions"]["shape"]["properties"]
    for name in OWN_TABLE:
        rule = whole["definitions"][name]
        if "properties" not in rule:
            continue
        skipped = set(shape) if name == "section" else set(LARGE.get(name, []))
        skipped |= {"a", "b"} if name == "exclusion" else set()  # as of a pair
        made[name] = table(head, distinct(schema.rows(rule, skipped=skipped)))
        for part in LARGE.get(name, []):
            made[f"{name}.{part}"] = table(head, distinct(
                schema.rows(rule["properties"][part])))
    return made


def main():
    whole = json.loads(pathlib.Path(sys.argv[1]).read_text(encoding="utf-8"))
    page = pathlib.Path(sys.argv[2])
    text = with_parts(page.read_text(encoding="utf-8"), parts_of(whole))
    if "--write" in sys.argv[3:]:
        page.write_text(text, encoding="utf-8")
    else:
        sys.stdout.write(text)


if __name__ == "__main__":
    main()
