"""How deep the cells and structs of a MATLAB 5 file are nested.

The reader of scipy follows them by recursion in compiled code, so that its stack overflows and the process
dies. Within a variable it ignores the declared sizes of matrices, and so does this.
Source: MAT-File Format, MathWorks.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator

from galewood.formats.limits import MAX_BYTES
from galewood.util import MeshError

MAX_DEPTH = 64
HEADER_BYTES = 128
FLAGS_BYTES = 16  # with their tag, which scipy does not look at
TAG_BYTES = 8
SMALL_BYTES = 4  # at most, of an element within its tag
INT32_BYTES = 4
MI_MATRIX, MI_COMPRESSED = 14, 15  # types of elements
MX_CELL, MX_STRUCT, MX_OBJECT, MX_CHAR, MX_SPARSE = 1, 2, 3, 4, 5  # classes of matrices
MX_FUNCTION, MX_OPAQUE = 16, 17
NUMERIC_CLASSES = range(MX_CHAR, MX_FUNCTION)
COMPLEX_FLAG = 1 << 11


def is_too_deep(data: bytes) -> bool:
    """Whether a file is nested deeper than MAX_DEPTH. ValueError, struct.error or zlib.error if damaged."""
    order = "<" if data[126:128] == b"IM" else ">"
    return any(_Variable(content, order).is_too_deep() for content in _variables(data, order))


def _variables(data: bytes, order: str) -> Iterator[memoryview]:
    """The variables with their tags, unpacked. MeshError if they are too large."""
    at, room, whole = HEADER_BYTES, MAX_BYTES, memoryview(data)
    while at + TAG_BYTES <= len(data):
        kind, size = struct.unpack_from(f"{order}II", data, at)
        end = at + TAG_BYTES + size
        if kind == MI_COMPRESSED:
            content = zlib.decompressobj().decompress(whole[at + TAG_BYTES : end], room + 1)
            room -= len(content)
            if room < 0:
                raise MeshError(
                    "decoded-too-large",
                    "too-large",
                    f"The compressed data expand to more than {MAX_BYTES >> 20} MB.",
                    "Save the variable QSM alone.",
                )
            yield memoryview(content)
        else:
            yield whole[at:end]
        at = end


class _Variable:
    """A matrix with its tag, read in the order in which scipy reads it."""

    def __init__(self, data: memoryview, order: str) -> None:
        self._data = data
        self._order = order
        self._at = 0

    def is_too_deep(self) -> bool:
        """Whether matrices are nested deeper than MAX_DEPTH."""
        left = [1]  # matrices that are still to be read, on each level
        while left:
            if left[-1] == 0:
                left.pop()
                continue
            left[-1] -= 1
            if inner := self._matrix():
                left.append(inner)
            if len(left) > MAX_DEPTH:
                return True
        return False

    def _matrix(self) -> int:
        """Read a matrix up to those inside it, whose number is returned."""
        kind, size = self._tag()
        if kind != MI_MATRIX:
            raise ValueError("not a matrix")
        if size == 0:
            return 0
        (flags,) = struct.unpack_from(f"{self._order}I", self._data, self._at + TAG_BYTES)
        self._at += FLAGS_BYTES
        array_class = flags & 0xFF
        if array_class == MX_OPAQUE:
            self._skip(3)  # names of the system, the class and the variable
            return 1
        dimensions = self._element()
        self._skip(1)  # the name
        if array_class in NUMERIC_CLASSES:
            is_complex = bool(flags & COMPLEX_FLAG) and array_class != MX_CHAR
            self._skip((3 if array_class == MX_SPARSE else 1) + is_complex)
            return 0
        if array_class == MX_FUNCTION:
            return 1
        if array_class not in (MX_CELL, MX_STRUCT, MX_OBJECT):
            raise ValueError("a matrix of an unknown class")
        count = math.prod(struct.unpack(f"{self._order}{len(dimensions) // INT32_BYTES}i", dimensions))
        return max(count, 0) * (1 if array_class == MX_CELL else self._fields(array_class))

    def _fields(self, array_class: int) -> int:
        """The number of fields of a struct or an object."""
        if array_class == MX_OBJECT:
            self._skip(1)  # the name of its class
        length = self._element()
        names = self._element()
        (width,) = struct.unpack_from(f"{self._order}i", length)
        return len(names) // width if width > 0 else 0

    def _skip(self, count: int) -> None:
        for _ in range(count):
            self._element()

    def _tag(self) -> tuple[int, int]:
        kind, size = struct.unpack_from(f"{self._order}II", self._data, self._at)
        self._at += TAG_BYTES
        return kind, size

    def _element(self) -> memoryview:
        """The content of the next element; small ones are in their tag."""
        kind, size = self._tag()
        if small := kind >> 16:
            if small > SMALL_BYTES:
                raise ValueError("a small element is too large")
            return self._data[self._at - SMALL_BYTES : self._at - SMALL_BYTES + small]
        content = self._data[self._at : self._at + size]
        if len(content) < size:
            raise ValueError("truncated")
        self._at += size + -size % 8
        return content
