"""Text tables with separators: delimiter, rows with their lines, and numbers as loggers write them."""

from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass

from galewood.util.text import shown_text

DELIMITERS = ("\t", ";", ",")
LOOKED_AT = 50
"""Lines from which the delimiter is found."""
HEADER_WITHIN = 100
"""Rows among which the names of the columns are looked for."""
COMMENTS = ("#", "%", "!", "//")
MISSING_VALUES = frozenset(
    ("", "nan", "na", "n/a", "#n/a", "n.a.", "k.a.", "null", "none", "nodata", "missing", "m", "inf", "-inf")
)
SENTINELS = frozenset((-999.0, -9999.0, -99999.0, 7999.0, -7999.0))
"""Numbers that loggers write for a missing value."""
LONGEST_CELL = 10_000
_PLACEHOLDER = re.compile(r"[-–—*/?._]+")
"""Marks without a digit, such as --- or ////, that stand for a missing value."""
_NUMBER = re.compile(r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?")


@dataclass(frozen=True)
class Row:
    """The clean cells of one row, without blanks around them, and the line of the file where it begins."""

    line: int
    cells: tuple[str, ...]

    def cell(self, column: int) -> str:
        """A cell; empty if the row is too short or the column is negative."""
        return self.cells[column] if 0 <= column < len(self.cells) else ""

    @property
    def is_comment(self) -> bool:
        """Whether it begins with a mark of a comment."""
        return self.cells[0].startswith(COMMENTS)


def decoded(data: bytes) -> str:
    """Text of a file: UTF-8, UTF-16 with its mark, or else Windows-1252; line ends become newlines."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        text = data.decode("utf-16", errors="replace")
    else:
        try:
            text = data.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = data.decode("cp1252", errors="replace")
    return text.replace("\r\n", "\n").replace("\r", "\n")


def delimiter_of(text: str) -> str:
    """Tab, semicolon or comma: the first that at least half of the first lines contain; else a comma."""
    lines = [line for line in text[:100_000].split("\n") if line.strip()][:LOOKED_AT]
    for delimiter in DELIMITERS:
        if 2 * sum(delimiter in line for line in lines) >= max(len(lines), 1):
            return delimiter
    return ","


def rows_of(text: str) -> Iterator[Row]:
    """The rows that are not empty. ValueError with the line of a cell that is far too long."""
    csv.field_size_limit(max(csv.field_size_limit(), LONGEST_CELL))
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=delimiter_of(text))
    line = 1
    try:
        for cells in reader:
            row = Row(line, tuple(shown_text(cell.strip()) for cell in cells))
            line = reader.line_num + 1
            if any(row.cells):
                yield row
    except csv.Error as error:
        raise ValueError(f"line {line}: {error}") from None


def number_of(cell: str) -> float:
    """The number in a cell, with a point or a comma; NaN if the value is missing. ValueError."""
    if cell.lower() in MISSING_VALUES or _PLACEHOLDER.fullmatch(cell):
        return math.nan
    if not _NUMBER.fullmatch(cell):
        raise ValueError(f"{cell[:40]!r} is not a number")
    number = float(cell.replace(",", "."))
    return math.nan if number in SENTINELS else number
