"""From the file of a logger, or from arrays, to the motion of a tree at equal intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice, pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from galewood.measurements.anemometer.samples import FASTEST_M_S
from galewood.measurements.array_values import numbers_of, seconds_of
from galewood.measurements.clock import Clock, is_number, spread_times, usual_interval_s
from galewood.measurements.column_names import SPEED_UNITS
from galewood.measurements.errors import MeasurementError, at
from galewood.measurements.motion_record.columns import (
    MOST_AXES,
    UNITS,
    MotionColumns,
    Quantity,
    motion_columns,
    with_units,
)
from galewood.measurements.motion_record.gravity import GRAVITY_UNITS, levelled
from galewood.measurements.motion_record.plausible import gravity_doubt, unit_doubts
from galewood.measurements.times import date_time_s
from galewood.util import HEADER_WITHIN, Floats, Row, decoded, number_of, rows_of

MOST_ROWS = 5_000_000
UNIT_ROWS = 3
FEWEST_SAMPLES = 256
RATES_HZ = (0.8, 1000.0)
"""Slower records hold no sway of a tree; faster ones have another unit of time."""
BRIDGED_S, BRIDGED_INTERVALS = 1.0, 3.0
"""Longer gaps, in s and in intervals, end a piece; the longest piece is used."""
UNREADABLE_SHARE = 0.05
"""Cells that cannot be read count as missing up to this share."""
MOST_NAMED = 12
NO_HEADER = (
    "no columns of a record of motion were found. Name them 'time (s)' and 'strain_x', 'tilt_x', 'acc_x' or "
    "'sway_x' (also _y), or say which they are with --columns"
)


@dataclass(frozen=True)
class MotionRecord:
    """The motion of a tree at equal intervals.

    values (n, a) along one or two horizontal axes, in the first unit of ``UNITS[quantity]`` if the file
    stated one; wind_m_s (n,), NaN where it is missing. ``columns``: what each column was taken for.
    """

    rate_hz: float
    values: Floats
    quantity: Quantity
    unit: str
    wind_m_s: Floats | None = None
    columns: Mapping[str, str] | None = None
    row_count: int = 0
    missing_count: int = 0
    gap_count: int = 0
    notes: tuple[str, ...] = ()
    """What a reader should know of how the file was read."""

    @property
    def duration_s(self) -> float:
        """Length of the piece that is used, s."""
        return len(self.values) / self.rate_hz


def read_motion(
    file: Path | str | bytes, *, rate_hz: float | None = None, columns: Mapping[str, str] | None = None
) -> MotionRecord:
    """Read a table with a column of times and one or two of strain, tilt, acceleration or sway.

    ``rate_hz`` for a file without times. ``columns``: names of columns by what they have: time, axis1,
    axis2, wind. Raises MeasurementError.
    """
    data = file if isinstance(file, bytes) else Path(file).read_bytes()
    try:
        rows = list(islice(rows_of(decoded(data)), MOST_ROWS + 1))
        if len(rows) > MOST_ROWS:
            raise MeasurementError(f"more than {MOST_ROWS} rows; split the file")
        found, first = _header(rows, columns)
    except MeasurementError:
        raise
    except ValueError as error:
        raise MeasurementError(str(error)) from None
    below = [row for row in rows[first:] if not row.is_comment]
    found, skipped = _skip_units(found, below)
    below = below[skipped:]
    if not below:
        raise MeasurementError("there are no rows of numbers below the names of the columns")
    time_s = _times(found, below, rate_hz)
    values = np.column_stack([_numbers(found, below, axis) for axis in found.axes])
    wind = _numbers(found, below, found.wind) if found.wind >= 0 else None
    if wind is not None:
        wind = wind * SPEED_UNITS[found.wind_unit or "m/s"][0]
    motion = _level(found, values) if found.quantity == "acceleration" else _as_stated(found, values)
    record = motion_record(time_s, motion.values, quantity=found.quantity, unit=motion.unit, wind_m_s=wind)
    doubts = unit_doubts([found.names[axis] for axis in found.axes], found.units, found.quantity, values)
    return replace(record, columns=motion.meanings, notes=(*motion.notes, *doubts, *_notes(found)))


class _Motion(NamedTuple):
    """Values (n, 1 or 2) in the first unit of their quantity (empty: unknown), and what they are."""

    values: Floats
    unit: str
    meanings: dict[str, str]
    notes: tuple[str, ...] = ()


def _as_stated(columns: MotionColumns, values: Floats) -> _Motion:
    """The values of the columns in their stated units."""
    scale = [UNITS[columns.quantity][unit][0] if unit else 1.0 for unit in columns.units]
    stated = all(columns.units) and columns.quantity != "signal"
    unit = next(iter(UNITS[columns.quantity])) if stated else ""
    return _Motion(values * scale, unit, columns.meanings)


def _level(columns: MotionColumns, values: Floats) -> _Motion:
    """The level accelerations of a sensor that may hang any way; those of chosen columns as they are."""
    by_name = _as_stated(_with_axes(columns, columns.level_axes), values[:, list(columns.level_axes)])
    if columns.chosen or len(columns.axes) < MOST_AXES:
        return by_name
    whole = _as_stated(columns, values)
    found = levelled(whole.values, [whole.unit] if whole.unit else list(GRAVITY_UNITS))
    if found is None:
        doubt = gravity_doubt(columns.units, values)
        return by_name._replace(notes=(doubt,)) if doubt else by_name
    names, notes = [columns.names[axis] for axis in columns.axes], list[str]()
    meanings = dict(_with_axes(columns, found.kept).meanings)
    if found.vertical is None:
        notes.append(
            f"Gravity leans by {found.lean_deg:.0f}° from the nearest axis of the sensor; its axes were "
            "turned until two of them are level."
        )
        meanings |= {f"axis {k + 1}": f"level part of {', '.join(names)}" for k in range(MOST_AXES)}
    else:
        meanings["vertical"] = names[found.vertical]
        if set(found.kept) != set(columns.level_axes):
            notes.append(
                f"Gravity is along {names[found.vertical]!r}: this axis is taken as vertical, and the motion "
                f"is that of {' and '.join(names[axis] for axis in found.kept)}."
            )
    if not whole.unit:
        notes.append(f"The unit is not stated; it is taken as {found.unit}, in which gravity is right.")
    scale = 1.0 if whole.unit else UNITS["acceleration"][found.unit][0]
    return _Motion(scale * found.values, next(iter(UNITS["acceleration"])), meanings, tuple(notes))


def _with_axes(columns: MotionColumns, kept: Sequence[int]) -> MotionColumns:
    return replace(
        columns,
        axes=tuple(columns.axes[k] for k in kept),
        units=tuple(columns.units[k] for k in kept),
    )


def motion_record(
    time_s: npt.ArrayLike,
    values: npt.ArrayLike,
    *,
    quantity: Quantity = "signal",
    unit: str = "",
    wind_m_s: npt.ArrayLike | None = None,
) -> MotionRecord:
    """The record of times (n,), in s or datetime64, and values (n,) or (n, 2); NaN where one is missing.

    Samples are put in order and at equal intervals; short gaps are bridged, and the longest piece between
    long ones is used. Raises MeasurementError.
    """
    times = seconds_of(time_s)
    if quantity not in UNITS:
        raise MeasurementError(f"quantity must be one of {', '.join(UNITS)}, not {quantity!r}")
    table = np.asarray(values, np.float64)
    table = table[:, None] if table.ndim == 1 else table
    if table.ndim != 2 or len(table) != len(times) or not 1 <= table.shape[1] <= MOST_AXES:
        raise MeasurementError(f"expected one or two values for each of the {len(times)} times")
    wind = None if wind_m_s is None else numbers_of("wind_m_s", wind_m_s, len(times))
    if wind is not None:
        wind = np.where((wind >= 0) & (wind <= FASTEST_M_S), wind, np.nan)
    order = np.argsort(times, kind="stable")
    order = order[np.isfinite(times[order])]
    order = order[np.diff(times[order], prepend=-np.inf) > 0]
    valid = order[np.isfinite(table[order]).all(axis=1)]
    if len(valid) < FEWEST_SAMPLES:
        raise MeasurementError(
            f"only {len(valid)} samples have a time and a value; at least {FEWEST_SAMPLES} are needed"
        )
    interval_s = _even_interval_s(times[order])
    longest_s = max(BRIDGED_S, BRIDGED_INTERVALS * interval_s)
    cuts = np.flatnonzero(np.diff(times[valid]) > longest_s) + 1
    piece = max(np.split(valid, cuts), key=len)
    if len(piece) < FEWEST_SAMPLES:
        raise MeasurementError(
            f"the longest piece without a gap of more than {longest_s:.3g} s has only {len(piece)} samples; "
            f"at least {FEWEST_SAMPLES} are needed"
        )
    begin, end = times[piece[0]], times[piece[-1]]
    even = begin + interval_s * np.arange(math.floor((end - begin) / interval_s + 0.5) + 1)
    return MotionRecord(
        rate_hz=1.0 / interval_s,
        values=np.column_stack([np.interp(even, times[piece], axis) for axis in table[piece].T]),
        quantity=quantity,
        unit=unit,
        wind_m_s=None if wind is None else _even_wind(even, times[order], wind[order]),
        row_count=len(times),
        missing_count=len(times) - len(valid),
        gap_count=len(cuts),
    )


def _even_interval_s(times_s: Floats) -> float:
    interval_s = usual_interval_s(times_s.tolist())
    slowest, fastest = RATES_HZ
    if not slowest <= 1 / interval_s <= fastest:
        raise MeasurementError(
            f"the times give {1 / interval_s:.3g} samples a second; {slowest:g} to {fastest:g} are read. "
            "Their unit is taken from the column's name, such as time (ms) or time (d)"
        )
    return interval_s


def _even_wind(even_s: Floats, times_s: Floats, wind: Floats) -> Floats | None:
    """The wind at the times of the record; None if it has no samples. It may be sampled more slowly."""
    known = np.isfinite(wind)
    return np.interp(even_s, times_s[known], wind[known]) if known.sum() > 1 else None


def _header(rows: Sequence[Row], chosen: Mapping[str, str] | None) -> tuple[MotionColumns, int]:
    """The columns and the index of the row after their names: the first row that also has a time, if any."""
    wrong: ValueError | None = None
    found: list[tuple[MotionColumns, int]] = []
    for k, row in enumerate(rows[:HEADER_WITHIN]):
        if sum(is_number(cell) for cell in row.cells) > len(row.cells) / 2:
            break
        try:
            if columns := motion_columns(row, chosen):
                found.append((columns, k + 1))
        except ValueError as error:
            wrong = wrong or error
    if not found:
        raise MeasurementError(str(wrong) if wrong else NO_HEADER)
    return next((one for one in found if one[0].time >= 0), found[0])


def _notes(columns: MotionColumns) -> tuple[str, ...]:
    notes: list[str] = []
    if columns.unused:
        named = ", ".join(columns.unused[:MOST_NAMED])
        notes.append(f"Not used: {named}. Other columns are chosen with --columns.")
    if len(set(columns.units)) > 1:
        notes.append("The two axes have different units: their ratio and principal axes may be wrong.")
    return tuple(notes)


def _skip_units(columns: MotionColumns, rows: Sequence[Row]) -> tuple[MotionColumns, int]:
    """The columns with their units, and how many rows of units lie above the numbers."""
    for k, row in enumerate(rows[:UNIT_ROWS]):
        if is_number(row.cell(columns.axes[0])) or date_time_s(row.cell(columns.time)) is not None:
            return columns, k
        columns = with_units(columns, row)
    return columns, min(UNIT_ROWS, len(rows))


def _times(columns: MotionColumns, rows: Sequence[Row], rate_hz: float | None) -> Floats:
    """(n,) times, s; NaN where one cannot be read. MeasurementError if most cannot, or there are none."""
    if columns.time < 0:
        if rate_hz is None:
            names = ", ".join(map(repr, columns.names))
            raise MeasurementError(
                f"there is no column of times among {names}. Name it with --columns time=NAME, or give the "
                "samples per second with --rate-hz"
            )
        if not 0 < rate_hz < math.inf:
            raise MeasurementError("the samples per second must be a number above 0")
        return np.arange(len(rows)) / rate_hz
    if rate_hz is not None:
        name = columns.names[columns.time]
        raise MeasurementError(f"the samples per second are given, but the column {name!r} has times")
    clock = Clock(columns.time, columns.date, columns.time_unit, rows)
    found, wrong = list[float](), list[MeasurementError]()
    for row in rows:
        try:
            found.append(clock.time_s(row))
        except ValueError as error:
            found.append(math.nan)
            wrong.append(at(row.line, columns.names[columns.time], str(error)))
    _raise_if_many(wrong, len(rows))
    if all(b >= a for a, b in pairwise(found)):
        found = spread_times(found)
    return np.array(found)


def _numbers(columns: MotionColumns, rows: Sequence[Row], column: int) -> Floats:
    """(n,) numbers of a column; NaN where one is missing. MeasurementError if most cannot be read."""
    found, wrong = np.full(len(rows), np.nan), list[MeasurementError]()
    for k, row in enumerate(rows):
        try:
            found[k] = number_of(row.cell(column))
        except ValueError as error:
            wrong.append(at(row.line, columns.names[column], str(error)))
    _raise_if_many(wrong, len(rows))
    return found


def _raise_if_many(wrong: Sequence[MeasurementError], count: int) -> None:
    if len(wrong) > UNREADABLE_SHARE * count:
        raise wrong[0]
