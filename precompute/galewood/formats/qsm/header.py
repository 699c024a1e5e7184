"""The layout of a text table of cylinders: its separator, and which column holds what.

Columns are recognised by their names, in any case and order. In TreeQSM's text files, one name stands for the
three columns of a point or direction; those of older versions have no names, but the columns of its matrix.
"""

from __future__ import annotations

import csv
import re
from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from dataclasses import dataclass

import numpy as np

SEPARATORS = ",;\t"
BLANKS = " "
COMMENTS = ("#", "%", "sep=")
TRIPLES = {"startpoint": "start", "endpoint": "end", "axisdirection": "axis"}
"""Names that stand for three columns."""
MATRIX_COLUMNS = (
    "radius", "length", "startx", "starty", "startz", "axisx", "axisy", "axisz", "parent", "extension",
)  # fmt: skip
"""The first columns of a table without names."""
UNIT_TOLERANCE = 0.01
"""Largest deviation from 1 of the length of a direction; tells such a table from other numbers."""


def _vector(point: str, *more: str) -> dict[str, tuple[str, ...]]:
    """The names of the three columns of a vector; ``more`` are patterns of other programs."""
    return {
        f"{point}{axis}": (f"{point}{axis}", f"{point}{number}", *(name.format(axis) for name in more))
        for number, axis in enumerate("xyz", start=1)
    }


COLUMNS = {
    "id": ("id", "cylid", "cylinderid"),
    "parent": ("parentid", "parent", "parentcylid", "parentcyl"),
    "extension": ("extensionid", "extension", "extensioncyl"),
    "branch": ("branchid", "axisid", "branch"),
    "radius": ("radius", "radiuscyl", "cylradius", "radiusm"),
    "length": ("length", "lengthcyl", "cyllength", "lengthm"),
    **_vector("start", "{}coord", "{}start"),
    **_vector("end", "{}end"),
    **_vector("axis", "{}vector"),
}
"""Names of each column, in lower case and without anything but letters and digits."""


@dataclass(frozen=True)
class Layout:
    """Position of each known column, the separator (a blank: white space), the first line of numbers."""

    columns: dict[str, int]
    separator: str
    first_line: int


def decoded(data: bytes) -> str:
    """The text of a file in UTF-8, UTF-16 with its mark, or else Latin-1, which decodes every byte."""
    encoding = "utf-16" if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)) else "utf-8-sig"
    try:
        return data.decode(encoding)
    except UnicodeDecodeError:
        return data.decode("latin-1")


def layout_of(lines: list[str]) -> Layout:
    """The layout of a table; without columns if it has none that are known."""
    at = next((k for k, line in enumerate(lines) if not _is_comment(line)), len(lines))
    line = lines[at] if at < len(lines) else ""
    separator = max(SEPARATORS, key=line.count)
    if separator not in line:
        separator = BLANKS
    try:
        fields = split(line, separator)
    except csv.Error:
        return Layout({}, separator, at + 1)
    if _is_matrix(fields):
        return Layout({name: k for k, name in enumerate(MATRIX_COLUMNS)}, separator, at)
    return Layout(_named(fields), separator, at + 1)


def split(line: str, separator: str) -> list[str]:
    """The fields of a line. Raises csv.Error."""
    return line.split() if separator == BLANKS else next(csv.reader([line], delimiter=separator), [])


def number(field: str) -> float:
    """The number in a field, with a decimal point or comma; not a number if empty. Raises ValueError."""
    text = field.strip().strip('"')
    return float("nan") if text in ("", "NA", "NaN", "nan") else float(text.replace(",", "."))


def _is_comment(line: str) -> bool:
    return not line.strip() or line.strip().strip('"').lower().startswith(COMMENTS)


def _is_matrix(fields: list[str]) -> bool:
    if len(fields) < len(MATRIX_COLUMNS):
        return False
    try:
        values = [number(field) for field in fields[: len(MATRIX_COLUMNS)]]
    except ValueError:
        return False
    return abs(float(np.linalg.norm(values[5:8])) - 1) < UNIT_TOLERANCE


def _named(header: list[str]) -> dict[str, int]:
    """Position of each known column; the first of its names that occurs counts."""
    plain: list[str] = []
    for name in header:
        short = re.sub(r"[^a-z0-9]", "", name.lower())
        plain += [f"{TRIPLES[short]}{axis}" for axis in "xyz"] if short in TRIPLES else [short]
    return {
        column: plain.index(next(name for name in names if name in plain))
        for column, names in COLUMNS.items()
        if any(name in plain for name in names)
    }
