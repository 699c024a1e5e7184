"""The error of a measurement that cannot be read."""

from __future__ import annotations

from galewood.util import shown_message


class MeasurementError(ValueError):
    """A file that is no usable measurement: what is wrong, where, and what to do."""

    def __init__(self, message: str) -> None:
        super().__init__(shown_message(message))


def at(line: int, column: str, what: str) -> MeasurementError:
    """The error at a line and a column."""
    return MeasurementError(f"line {line}, column {column!r}: {what}")
