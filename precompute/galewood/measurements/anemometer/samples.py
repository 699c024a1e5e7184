"""The samples of a table: times and velocities, as they stand in the file."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import islice

from galewood.measurements.anemometer.columns import (
    Columns,
    columns_of,
    compass_deg,
    to_radians,
    with_units,
)
from galewood.measurements.clock import Clock, is_number
from galewood.measurements.column_names import SPEED_UNITS
from galewood.measurements.errors import MeasurementError, at
from galewood.measurements.times import date_time_s
from galewood.util import HEADER_WITHIN, Row, number_of

UNIT_ROWS = 3
MOST_ROWS = 2_000_000
FASTEST_M_S = 75.0
"""Faster values count as missing: no mast survives them, and loggers write 99.9 or 999 for a fault."""
UNREADABLE_SHARE = 0.05
"""If cells of a larger share of the rows cannot be read, a column is not what its name says: an error."""
NO_HEADER = (
    "no column names were found. Name a column 'time' and 'speed' with 'direction' (or 'u' and 'v'), with "
    "units, for example: time (s);speed (m/s);direction (deg)"
)


@dataclass
class Samples:
    """Times (s) and velocities (m/s, to the east and to the north; NaN if missing), in the file's order."""

    columns: Columns
    time_s: list[float] = field(default_factory=list[float])
    east_m_s: list[float] = field(default_factory=list[float])
    north_m_s: list[float] = field(default_factory=list[float])
    implausible: int = 0
    """Values beyond FASTEST_M_S."""
    unreadable: list[MeasurementError] = field(default_factory=list[MeasurementError])
    """What is wrong with rows that count as missing because a cell cannot be read."""


def samples_of(rows: Iterable[Row]) -> Samples:
    """Read the rows of a table. MeasurementError with line and column."""
    kept = list(islice(rows, MOST_ROWS + 1))
    if len(kept) > MOST_ROWS:
        raise MeasurementError(f"more than {MOST_ROWS} rows; split the file")
    header = _header(kept)
    if header is None:
        raise MeasurementError(NO_HEADER)
    columns, first = header
    data = [row for row in kept[first:] if not row.is_comment]
    columns, skipped = _skip_units(columns, data)
    data = data[skipped:]
    if not data:
        raise MeasurementError("there are no rows of numbers below the names of the columns")
    clock = Clock(columns.time, columns.date, columns.time_unit, data)
    samples = Samples(replace(columns, time_unit=clock.unit))
    for row in data:
        try:
            time_s, velocity = _time_s(clock, columns, row), _velocity(samples, columns, row)
        except MeasurementError as error:
            samples.unreadable.append(error)
            time_s, velocity = math.nan, (math.nan, math.nan)
        samples.time_s.append(time_s)
        samples.east_m_s.append(velocity[0])
        samples.north_m_s.append(velocity[1])
    if len(samples.unreadable) > UNREADABLE_SHARE * len(data):
        raise samples.unreadable[0]
    return samples


def is_measurement(rows: list[Row]) -> bool:
    """Whether a table, or its beginning, has the columns of an anemometer's record."""
    return _header(rows) is not None


def _header(rows: list[Row]) -> tuple[Columns, int] | None:
    """The columns and the index of the row after their names; None if it is no such table."""
    for k, row in enumerate(rows[:HEADER_WITHIN]):
        if columns := columns_of(row):
            return columns, k + 1
    first = next((k for k, row in enumerate(rows) if not row.is_comment), 0)
    cells = rows[first].cells if rows else ()
    if len(cells) == 3 and all(is_number(cell) for cell in cells[1:]):
        return Columns(("time", "speed", "direction"), 0, speed=1, direction=2), first
    return None


def _skip_units(columns: Columns, rows: list[Row]) -> tuple[Columns, int]:
    """The columns with their units, and how many rows of units and statistics lie above the numbers."""
    for k, row in enumerate(rows[:UNIT_ROWS]):
        if is_number(row.cell(columns.first_value)):
            return columns, k
        if is_number(row.cell(columns.time)) or date_time_s(row.cell(columns.time)) is not None:
            return columns, k
        columns = with_units(columns, row)
    return columns, min(UNIT_ROWS, len(rows))


def _time_s(clock: Clock, columns: Columns, row: Row) -> float:
    try:
        return clock.time_s(row)
    except ValueError as error:
        raise at(row.line, columns.name(columns.time), str(error)) from None


def _velocity(samples: Samples, columns: Columns, row: Row) -> tuple[float, float]:
    """Velocity to the east and north, m/s; NaN if it is missing or implausible, which is counted."""
    factor = SPEED_UNITS[columns.speed_unit or "m/s"][0]
    if columns.speed < 0:
        east, north = (_value(columns, row, k) * factor for k in (columns.east, columns.north))
    else:
        speed = _value(columns, row, columns.speed) * factor
        if speed < 0.0:
            name = columns.name(columns.speed)
            raise at(row.line, name, "a wind speed cannot be negative; components are columns 'u' and 'v'")
        east, north = _components(speed, columns, row)
    if math.hypot(east, north) > FASTEST_M_S:
        samples.implausible += 1
        return math.nan, math.nan
    return east, north


def _components(speed: float, columns: Columns, row: Row) -> tuple[float, float]:
    """Components to the east and north; without a column of directions the wind comes from the west."""
    if columns.direction < 0:
        return speed, 0.0
    angle = to_radians(_direction(columns, row), columns.direction_unit)
    if speed == 0.0 and math.isnan(angle):
        angle = 0.0  # vanes have no direction in still air
    sign = 1.0 if columns.towards else -1.0
    return sign * speed * math.sin(angle), sign * speed * math.cos(angle)


def _direction(columns: Columns, row: Row) -> float:
    cell = row.cell(columns.direction)
    if cell.isalpha() and len(cell) <= 3 and cell.lower() not in ("nan", "na", "inf"):
        try:
            return compass_deg(cell)
        except ValueError as error:
            raise at(row.line, columns.name(columns.direction), str(error)) from None
    return _value(columns, row, columns.direction)


def _value(columns: Columns, row: Row, column: int) -> float:
    try:
        return number_of(row.cell(column))
    except ValueError as error:
        raise at(row.line, columns.name(column), str(error)) from None
