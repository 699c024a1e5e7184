"""The samples of a table: times and velocities, as they stand in the file."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import islice

from galewood.measurements.anemometer.columns import (
    SPEED_UNITS,
    TIME_UNITS,
    Columns,
    columns_of,
    compass_deg,
    to_radians,
    with_units,
)
from galewood.measurements.anemometer.errors import MeasurementError, at
from galewood.measurements.anemometer.times import DAY_S, date_time_s, is_clock, is_compact, is_month_first
from galewood.util import HEADER_WITHIN, Row, number_of

UNIT_ROWS = 3
MOST_ROWS = 2_000_000
FASTEST_M_S = 75.0
"""Faster values count as missing: no mast survives them, and loggers write 99.9 or 999 for a fault."""
EPOCH_MS = 1e11
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
    clock = _Clock(columns, data)
    samples = Samples(replace(columns, time_unit=clock.unit))
    for row in data:
        try:
            time_s, velocity = clock.time_s(row), _velocity(samples, columns, row)
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
    if len(cells) == 3 and all(_is_number(cell) for cell in cells[1:]):
        return Columns(("time", "speed", "direction"), 0, speed=1, direction=2), first
    return None


def _is_number(cell: str) -> bool:
    try:
        return not math.isnan(number_of(cell))
    except ValueError:
        return False


def _skip_units(columns: Columns, rows: list[Row]) -> tuple[Columns, int]:
    """The columns with their units, and how many rows of units and statistics lie above the numbers."""
    for k, row in enumerate(rows[:UNIT_ROWS]):
        if _is_number(row.cell(columns.first_value)):
            return columns, k
        if _is_number(row.cell(columns.time)) or date_time_s(row.cell(columns.time)) is not None:
            return columns, k
        columns = with_units(columns, row)
    return columns, min(UNIT_ROWS, len(rows))


class _Clock:
    """Reads the times of the rows."""

    def __init__(self, columns: Columns, rows: list[Row]) -> None:
        self._columns = columns
        texts = [row.cell(columns.time) for row in rows]
        self._dated = columns.date >= 0 and is_clock(texts[0])
        dates = [row.cell(columns.date) for row in rows] if self._dated else texts
        compact = not columns.time_unit and all(is_compact(text) for text in texts if text)
        self._numbers = _is_number(texts[0]) and not compact
        self._month_first = True if self._numbers else is_month_first(dates)
        self._daily = not self._dated and is_clock(texts[0])
        self._days_s, self._last_s = 0.0, -math.inf
        huge = self._numbers and number_of(texts[0]) > EPOCH_MS
        self.unit = (columns.time_unit or ("ms" if huge else "s")) if self._numbers else ""

    def time_s(self, row: Row) -> float:
        """Seconds; NaN if the time is missing."""
        text = row.cell(self._columns.time)
        name = self._columns.name(self._columns.time)
        if self._numbers:
            try:
                return number_of(text) * TIME_UNITS[self.unit][0]
            except ValueError as error:
                raise at(row.line, name, f"{error}, as the times above it are") from None
        if self._dated:
            text = f"{row.cell(self._columns.date)} {text}"
        if not text.strip():
            return math.nan
        time_s = date_time_s(text, month_first=self._month_first)
        if time_s is None:
            raise at(row.line, name, f"{text[:40]!r} is not a time such as 2024-05-31T12:00:00.5 or 12.5")
        return self._past_midnight(time_s) if self._daily else time_s

    def _past_midnight(self, time_s: float) -> float:
        if time_s < self._last_s - DAY_S / 2:
            self._days_s += DAY_S
        self._last_s = time_s
        return time_s + self._days_s


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
