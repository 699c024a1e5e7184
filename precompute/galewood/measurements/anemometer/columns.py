"""Which column of a table is time, speed, direction or a component, and in which unit."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace

from galewood.measurements.column_names import (
    DATE_NAME,
    SPEED_UNITS,
    TIME_NAME,
    TIME_UNITS,
    plain_name,
    unit_in,
    unit_of,
)
from galewood.util import Row

_SPEED = re.compile(
    r"(?:^| )(wind ?speed|wind ?spd|wspd|ws\d*|wind ?vel(?:ocity)?|wind ?geschw[a-z]*|geschwindigkeit|speed"
    r"|spd|ff|velocity)(?: |$)"
)
_DIRECTION = re.compile(
    r"(?:^| )(wind ?dir(?:ection)?|wdir|wd\d*|dir|direction|wind ?richtung|richtung|dd|azimuth|bearing"
    r"|wind ?from|wind ?heading|heading)(?: |$)"
)
_TOWARDS = re.compile(r"(?:^| )(to|towards?|heading|nach)(?: |$)")
_COMPONENT = r"({0}|{0}x|{0} ?wind|wind ?{0}|{0} ?comp(?:onent)?|{1})(?: (?:m/?s|m s|m s 1|mps|avg|mean))*"
_EAST, _NORTH = (
    re.compile(_COMPONENT.format("u", r"eastward[a-z ]*|east")),
    re.compile(_COMPONENT.format("v", r"northward[a-z ]*|north|uy")),
)
_OTHER = re.compile(
    r"(?:^| )(std|sd\d*|stdev|stddev|sigma|max|maximum|min|minimum|gusts?|boe|dev|qc|flag|quality|err|error"
    r"|var|variance)(?: |$)"
)
POINTS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")


@dataclass(frozen=True)
class Columns:
    """Indices of the columns (−1: none) and the units of their numbers."""

    names: tuple[str, ...]
    time: int
    date: int = -1
    speed: int = -1
    direction: int = -1
    east: int = -1
    north: int = -1
    speed_unit: str = ""
    """Empty: not stated."""
    time_unit: str = ""
    direction_unit: str = "deg"
    towards: bool = False
    """Whether the direction is where the wind blows to."""

    @property
    def first_value(self) -> int:
        """The first of the columns with a velocity."""
        return self.east if self.speed < 0 else self.speed

    @property
    def meanings(self) -> dict[str, str]:
        """What each column was taken for: its name, with the unit."""
        speed = self.speed_unit or "m/s"
        angle = f"{'rad' if self.direction_unit == 'rad' else '°'} {'towards' if self.towards else 'from'}"
        taken = {
            "date": (self.date, ""),
            "time": (self.time, self.time_unit),
            "speed": (self.speed, speed),
            "direction": (self.direction, angle),
            "u": (self.east, speed),
            "v": (self.north, speed),
        }
        return {
            what: f"{self.name(column)}: {unit}" if unit else self.name(column)
            for what, (column, unit) in taken.items()
            if column >= 0
        }

    def name(self, column: int) -> str:
        """Name of a column, or its number."""
        return (self.names[column] if column < len(self.names) else "") or str(column + 1)


def columns_of(row: Row) -> Columns | None:
    """The columns that a row of names describes; None if it is no such row."""
    names = tuple(cell.lstrip("#%! /").strip() for cell in row.cells)
    plain = [plain_name(name) for name in names]
    value = [not _OTHER.search(name) for name in plain]

    def first(pattern: re.Pattern[str], *, whole: bool = False) -> int:
        test = pattern.fullmatch if whole else pattern.search
        return next((k for k, name in enumerate(plain) if value[k] and test(name)), -1)

    time, date = first(TIME_NAME), first(DATE_NAME)
    speed, direction = first(_SPEED), first(_DIRECTION)
    east, north = first(_EAST, whole=True), first(_NORTH, whole=True)
    if time < 0:
        time, date = date, -1
    if speed < 0 and (east < 0 or north < 0):
        return None
    if time < 0 or time in (speed, east, north):
        return None
    if speed >= 0:
        east = north = -1
    found = Columns(names, time, date if date != time else -1, speed, direction, east, north)
    unit = unit_in(names[found.first_value], SPEED_UNITS)
    angle = names[direction] if direction >= 0 else ""
    return replace(
        found,
        speed_unit=unit,
        time_unit=unit_in(names[time], TIME_UNITS),
        direction_unit="rad" if re.search(r"[\[(]rad", angle.lower()) else "deg",
        towards=direction >= 0 and bool(_TOWARDS.search(plain[direction])),
    )


def with_units(columns: Columns, row: Row) -> Columns:
    """The columns with the units of a row of units, as far as it states any."""
    speed = unit_of(row.cell(columns.first_value), SPEED_UNITS)
    time = unit_of(row.cell(columns.time), TIME_UNITS)
    radians = columns.direction >= 0 and row.cell(columns.direction).lower().startswith("rad")
    return replace(
        columns,
        speed_unit=speed or columns.speed_unit,
        time_unit=time or columns.time_unit,
        direction_unit="rad" if radians else columns.direction_unit,
    )


def compass_deg(cell: str) -> float:
    """The angle of a point of the compass (N, NNE, …); ValueError for another text."""
    point = cell.upper().replace("O", "E")
    if point not in POINTS:
        raise ValueError(f"{cell[:40]!r} is not a number")
    return 360.0 / len(POINTS) * POINTS.index(point)


def to_radians(angle: float, unit: str) -> float:
    """An angle in radians."""
    return angle if unit == "rad" else math.radians(angle)
