"""How deep an FBX file is nested: its records, text or binary, and its models by their connections."""

from __future__ import annotations

import re
import struct

import numpy as np

from galewood.formats.graph_depth import MAX_DEPTH, problem_of
from galewood.util import MeshError

MAX_RECORDS = 2_000_000  # of a binary file
COMMENT_PATTERN = re.compile(rb'("[^"]*")|;[^\r\n]*')
TEXT_PATTERN = re.compile(rb'"[^"]*"')
MODEL_PATTERN = re.compile(rb"\bModel[\s\0]*:[\s\0]*(\d+)")
CONNECTION_PATTERN = re.compile(
    rb'\bC[\s\0]*:[\s\0]*"([^"]*)"[\s\0]*,[\s\0]*(\d+)[\s\0]*,[\s\0]*(\d+)'
)  # of what, to what
PROPERTY_CONNECTION = b"OP"  # a connection with a property of an object, not with the object
OPENING_BRACE, CLOSING_BRACE = b"{}"
BINARY_HEADER = b"Kaydara FBX Binary  \0"
BINARY_HEADER_BYTES = 27
LONG_VERSION = 7500  # from this one on, numbers of records have 64 bits
TOO_DEEP = f"are nested deeper than {MAX_DEPTH} levels"


def problem_of_fbx(data: bytes) -> str | None:
    """The end of a sentence that says why the file is not read; None if it can be. ValueError if damaged."""
    read = _Binary(data) if data.startswith(BINARY_HEADER) else _Text(data)
    if read.depth > MAX_DEPTH:
        return TOO_DEEP
    number = {model: k for k, model in enumerate(dict.fromkeys(read.models))}
    below: list[list[int]] = [[] for _ in number]
    for what, to in read.links:
        if what in number and to in number:
            below[number[to]].append(number[what])
    return problem_of(below)


class _Text:
    """Nesting, ids of models and connections (of what, to what) of a text file."""

    def __init__(self, data: bytes) -> None:
        code = COMMENT_PATTERN.sub(rb"\1", data)
        self.models = [int(found[1]) for found in MODEL_PATTERN.finditer(code)]
        self.links = [
            (int(found[2]), int(found[3]))
            for found in CONNECTION_PATTERN.finditer(code)
            if found[1] != PROPERTY_CONNECTION
        ]
        characters = np.frombuffer(TEXT_PATTERN.sub(b"", code), dtype=np.uint8)
        braces = characters[(characters == OPENING_BRACE) | (characters == CLOSING_BRACE)]
        level = np.cumsum(np.where(braces == OPENING_BRACE, 1, -1), dtype=np.int64)
        lowest = np.minimum(np.minimum.accumulate(level), 0) if level.size else level
        self.depth = int((level - lowest).max(initial=0))


class _Binary:
    """The same of a binary file, whose records follow one another with their own ends."""

    def __init__(self, data: bytes) -> None:
        self.models: list[int] = []
        self.links: list[tuple[int, int]] = []
        self.depth = 0
        (version,) = struct.unpack_from("<I", data.ljust(BINARY_HEADER_BYTES, b"\0"), 23)
        head = struct.Struct("<QQQB" if version >= LONG_VERSION else "<IIIB")
        at, ends = BINARY_HEADER_BYTES, list[int]()
        for _ in range(MAX_RECORDS):
            while ends and at >= ends[-1] - head.size:  # the children of a record end with an empty one
                at = ends.pop()
            if at + head.size > len(data):
                return
            end, _, properties_bytes, name_bytes = head.unpack_from(data, at)
            if end == 0 and not ends:
                return
            name_at = at + head.size
            properties_at = name_at + name_bytes
            at = properties_at + properties_bytes
            if not at <= end <= (ends[-1] if ends else len(data)):
                raise ValueError("the end of a record is wrong")
            self._take(data[name_at:properties_at], data, properties_at)
            if at < end:
                ends.append(end)
                self.depth = max(self.depth, len(ends))
            if self.depth > MAX_DEPTH:
                return
        raise MeshError(
            "too-many-records",
            "too-large",
            f"The FBX file has more than {MAX_RECORDS} records.",
            "Export the tree alone, without animation.",
        )

    def _take(self, name: bytes, data: bytes, at: int) -> None:
        if name == b"Model" and data[at : at + 1] == b"L":
            self.models.append(int.from_bytes(data[at + 1 : at + 9], "little"))
        elif name == b"C" and data[at : at + 1] == b"S":
            size = int.from_bytes(data[at + 1 : at + 5], "little")
            kind, ids = data[at + 5 : at + 5 + size], data[at + 5 + size : at + 23 + size]
            if kind != PROPERTY_CONNECTION and ids[:1] == b"L" and ids[9:10] == b"L":
                self.links.append((int.from_bytes(ids[1:9], "little"), int.from_bytes(ids[10:], "little")))
