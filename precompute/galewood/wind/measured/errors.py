"""The error of a measurement that cannot be read."""

from __future__ import annotations


class MeasurementError(ValueError):
    """A file that is no usable measurement: what is wrong, where, and what to do."""


def at(line: int, column: str, what: str) -> MeasurementError:
    """The error at a line and a column."""
    return MeasurementError(f"line {line}, column {column!r}: {what}")
