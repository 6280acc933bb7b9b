#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws rooms.svg, the module map, from what each room's CMakeLists.txt links."""
import pathlib
import sys

from drawing import GREY, MID, PALE, PAPER, Drawing

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/style"))
from layers import linked_rooms, reachable  # noqa: E402

# The lists of the laboratory's rooms are a band of their own; c_interface lists no rooms.
BANDS = ["core", "config", "cuda", "firmware_if", "hil_replay", "hil_replay/lab"]
LINKED_BY_HAND = {"firmware_if/c_interface": {"firmware_if/live"}}
COLUMN, BOX, ROW, HEAD = 84, 70, 27, 24


def links():
    graph = {}
    for path in sorted(ROOT.glob("*/**/CMakeLists.txt")):
        room = path.parent.relative_to(ROOT).as_posix()
        if room.startswith(tuple(f"{band}/" for band in BANDS)):
            text = path.read_text(encoding="utf-8")
            if "axg_room(" in text or room in LINKED_BY_HAND:
                graph[room] = linked_rooms(text) | LINKED_BY_HAND.get(room, set())
    return graph


def without_detours(graph):
    """Only the links that no other link reaches."""
    return {room: {other for other in others
                   if not any(other in reachable(graph, between)
                              for between in others - {other})}
            for room, others in graph.items()}


def band_of(room):
    return room.rpartition("/")[0]


def column_of(room, graph):
    inside = [other for other in graph[room] if band_of(other) == band_of(room)]
    return 1 + max((column_of(other, graph) for other in inside), default=-1)


def place(rooms, graph, top):
    """Left upper corner of each room: columns by depth, rows near the rooms that it links."""
    columns = {}
    for room in rooms:
        columns.setdefault(column_of(room, graph), []).append(room)
    most, at = max(len(names) for names in columns.values()), {}
    for column in sorted(columns):
        def wanted(room):
            rows = [at[other][1] for other in graph[room] if other in at]
            return (sum(rows) / len(rows) if rows else 0, room)
        names = sorted(columns[column], key=wanted)
        shift = (most - len(names)) * ROW / 2
        for row, room in enumerate(names):
            at[room] = (14 + column * COLUMN, top + shift + row * ROW)
    return at, most


def main():
    graph = without_detours(links())
    figure = Drawing("Module map: the rooms of each house and the rooms they link", 0)
    figure.text(8, 18, "A room may include every room that its arrows reach", 13, bold=True)
    y = 28
    for band in BANDS:
        rooms = [room for room in graph if band_of(room) == band]
        at, most = place(rooms, graph, y + HEAD)
        outside = sorted({other for room in rooms for other in graph[room]
                          if band_of(other) != band})
        outside = [other for other in outside
                   if not any(other in reachable(graph, more) for more in outside)]
        figure.box(6, y, 588, HEAD + most * ROW + 2, PAPER)
        figure.text(14, y + 16, f"{band}/", 12, bold=True)
        figure.text(120, y + 16, "links " + ", ".join(outside) if outside else
                    "links nothing of the project", 11, fill=GREY)
        for room, (x, top) in at.items():
            for other in sorted(graph[room]):
                if other in at:
                    figure.line((x, top + 10), (at[other][0] + BOX, at[other][1] + 10), head=True)
        for room, (x, top) in at.items():
            figure.label(x, top, BOX, 20, room.rpartition("/")[2],
                         MID if band == "core" else PALE, 11)
        y += HEAD + most * ROW + 10
    figure.height = y
    figure.save(__file__)


if __name__ == "__main__":
    main()
