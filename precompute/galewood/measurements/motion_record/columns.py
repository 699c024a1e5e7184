"""Which columns of a table have the motion of a tree, what was measured, and in which unit."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from galewood.measurements.column_names import (
    DATE_NAME,
    SPEED_UNITS,
    TIME_NAME,
    TIME_UNITS,
    Units,
    plain_name,
    unit_in,
    unit_of,
)
from galewood.util import Row

Quantity = Literal["strain", "tilt", "acceleration", "sway", "signal"]
UNITS: dict[Quantity, Units] = {
    "strain": {
        "1": (1.0, r"m/m|1|-"),
        "µε": (1e-6, r"µ(ε|e|s|strain|m/m)|u(e|s|strain|m/m)|μ(ε|e|strain|m/m)|micro(strain)?s?"),
        "‰": (1e-3, r"‰|mm/m"),
        "%": (1e-2, r"%|percent"),
    },
    "tilt": {
        "deg": (1.0, r"deg(rees?)?|°|grad"),
        "rad": (57.29577951308232, r"rad(ians?)?"),
        "mrad": (0.05729577951308232, r"mrad"),
    },
    "acceleration": {
        "m/s²": (1.0, r"m/?s2|m/?s-2|m/s/s|m/s²|ms2|m/s\*\*2"),
        "g": (9.80665, r"g|gn"),
        "mg": (9.80665e-3, r"mg"),
    },
    "sway": {"m": (1.0, r"m|met(er|re)s?"), "cm": (1e-2, r"cm"), "mm": (1e-3, r"mm")},
    "signal": {"": (1.0, r"$^")},
}
"""Units of each quantity, and their values in the first one, in which it is reported."""
Named = Literal["strain", "tilt", "acceleration", "sway"]
WORDS: dict[Named, str] = {
    "strain": r"(?:micro|u)?strain|strn|dehnung|gauge|sg|dms",
    "tilt": r"tilt|incl(?:in(?:ation|ometer)?)?|neigung|roll|pitch|angle|winkel",
    "acceleration": r"acc(?:el(?:eration)?)?|beschl(?:eunigung)?|a(?=[xyz]$)",
    "sway": r"sway|displ?(?:acement)?|deflection|auslenkung|position|pos|motion",
}
_AXIS = r"x|y|z|1|2|3|n|e|north|east|ns|ew|nord|ost|radial|tangential|along|across|vertical|up|vert"
_BARE_AXIS = re.compile(
    r"(?:ch(?:annel)? ?|axis ?|sensor ?)?(x|y|1|2|n|e|north|east|ns|ew|along|across)"
    r"(?: (?:mv|v|volts?|counts?|raw|mm|cm|m|deg|degrees|rad|mrad|g|mg|microstrain|ustrain))?"
)
_VERTICAL = frozenset(("z", "3", "vertical", "up", "vert"))
_WIND = re.compile(
    r"(?:^| )(wind ?speed|wind ?spd|wspd|ws\d*|wind ?vel(?:ocity)?|wind ?geschw[a-z]*|wind|u)(?: |$)"
)
_NO_SPEED = re.compile(r"(?:^| )(dir\w*|richtung|from|to|heading|deg(?:rees)?|gusts?)(?: |$)")
_STATISTIC = re.compile(r"(?:^| )(std|stdev|sigma|max|maximum|min|minimum|flag|quality|error)(?: |$)|^temp")
MOST_AXES = 2
CHOSEN_NAMES = ("time", "axis1", "axis2", "wind")


@dataclass(frozen=True)
class MotionColumns:
    """Indices of the columns of a record (−1: none), and the unit of each axis.

    An accelerometer has up to three axes, of which one may be vertical, whatever its name says.
    """

    names: tuple[str, ...]
    time: int
    date: int
    time_unit: str
    axes: tuple[int, ...]
    units: tuple[str, ...]
    """Empty: not stated."""
    quantity: Quantity
    wind: int
    wind_unit: str
    unused: tuple[str, ...]
    """Names of other columns with motion: of other trees, sensors or directions."""
    chosen: bool = False
    """Whether the axes were chosen, rather than found by their names."""

    @property
    def level_axes(self) -> tuple[int, ...]:
        """Indices of those of the axes that are level by their names or were chosen, at most two."""
        if self.chosen:
            return tuple(range(len(self.axes)))
        plain = [plain_name(self.names[axis]) for axis in self.axes]
        level = [k for k, name in enumerate(plain) if _of_quantity_axis(self.quantity, name) not in _VERTICAL]
        return tuple(level or range(len(plain)))[:MOST_AXES]

    @property
    def meanings(self) -> dict[str, str]:
        """What each column was taken for: its name, with the unit."""
        found = {f"axis {k + 1}": _named(self.names[axis], unit)
                 for k, (axis, unit) in enumerate(zip(self.axes, self.units, strict=True))}  # fmt: skip
        others = {"date": self.date, "time": self.time, "wind": self.wind}
        return found | {what: self.names[column] for what, column in others.items() if column >= 0}


def motion_columns(row: Row, chosen: Mapping[str, str] | None = None) -> MotionColumns | None:
    """The columns that a row of names describes; None if none of them has motion.

    ``chosen``: names of columns by what they have: time, axis1, axis2, wind. ValueError if one is not there.
    """
    names = tuple(cell.lstrip("#%! /").strip() for cell in row.cells)
    plain = [plain_name(name.replace("µ", "u").replace("μ", "u")) for name in names]
    if unknown := set(chosen or {}) - set(CHOSEN_NAMES):
        raise ValueError(f"columns are given as {', '.join(CHOSEN_NAMES)}, not as {min(unknown)!r}")
    given = {what: _index(names, name) for what, name in (chosen or {}).items()}
    time, date = _first(TIME_NAME, plain), _first(DATE_NAME, plain)
    if time < 0:
        time, date = date, -1
    time = given.get("time", time)
    quantity, axes = _axes(plain, names, time)
    if picked := [given[name] for name in ("axis1", "axis2") if name in given]:
        axes = tuple(picked)
        quantity = _quantity_of(plain[axes[0]])
    if not axes:
        return None
    if len(set(axes)) < len(axes):
        raise ValueError("axis1 and axis2 are the same column")
    wind = given.get("wind", _wind(plain, (time, *axes)))
    motion = [k for k, name in enumerate(plain) if k not in (time, wind, *axes) and _has_motion(name)]
    return MotionColumns(
        names,
        time,
        -1 if date == time else date,
        unit_in(names[time], TIME_UNITS) if time >= 0 else "",
        axes,
        tuple(_unit(names[axis], quantity) for axis in axes),
        quantity,
        wind,
        unit_in(names[wind], SPEED_UNITS) if wind >= 0 else "",
        tuple(names[k] for k in motion),
        bool(picked),
    )


def with_units(columns: MotionColumns, row: Row) -> MotionColumns:
    """The columns with the units of a row of units, as far as it states any."""
    units = tuple(
        unit_of(row.cell(axis), UNITS[columns.quantity]) or unit
        for axis, unit in zip(columns.axes, columns.units, strict=True)
    )
    time_unit = unit_of(row.cell(columns.time), TIME_UNITS) or columns.time_unit
    wind_unit = unit_of(row.cell(columns.wind), SPEED_UNITS) or columns.wind_unit
    return replace(columns, units=units, time_unit=time_unit, wind_unit=wind_unit)


def _wind(plain: Sequence[str], taken: Sequence[int]) -> int:
    """The column of wind speeds; one that names a speed before one that is only called wind. −1: none."""
    named = [k for k, name in enumerate(plain) if k not in taken and _WIND.search(name)]
    found = [k for k in named if not _NO_SPEED.search(plain[k]) and not _STATISTIC.search(plain[k])]
    return min(found, key=lambda k: "sp" not in plain[k], default=-1)


def _has_motion(name: str) -> bool:
    return not _STATISTIC.search(name) and (
        _quantity_of(name) != "signal" or bool(_BARE_AXIS.fullmatch(name))
    )


def _axes(plain: Sequence[str], names: Sequence[str], time: int) -> tuple[Quantity, tuple[int, ...]]:
    """The quantity with most axes, and its columns.

    At most two, and none whose name is vertical; but all three of an accelerometer, which may hang any way.
    """
    best: tuple[Quantity, tuple[int, ...]] = ("signal", ())
    for quantity in WORDS:
        found = [(k, axis) for k, name in enumerate(plain) if k != time and not _STATISTIC.search(name)
                 if (axis := _of_quantity(quantity, name)) is not None]  # fmt: skip
        level = [k for k, axis in found if axis not in _VERTICAL] or [k for k, _ in found]
        if len(level[:MOST_AXES]) > len(best[1]):
            whole = tuple(k for k, _ in found[:3])
            of_sensor = quantity == "acceleration" and len({axis for _, axis in found[:3]}) == 3
            best = quantity, whole if of_sensor else tuple(level[:MOST_AXES])
    if not best[1]:
        bare = [k for k, name in enumerate(plain) if k != time and _BARE_AXIS.fullmatch(name)]
        stated: list[Quantity] = [one for one in WORDS if any(unit_in(names[k], UNITS[one]) for k in bare)]
        quantity: Quantity = stated[0] if len(stated) == 1 else "signal"
        best = quantity, tuple(bare[:MOST_AXES])
    others = tuple(k for k in range(len(plain)) if k != time)
    if not best[1] and time >= 0 and len(others) <= MOST_AXES:
        return "signal", others  # nothing else can be meant
    return best


def _quantity_of(name: str) -> Quantity:
    for one in WORDS:
        if _of_quantity(one, name) is not None:
            return one
    return "signal"


def _of_quantity(quantity: Named, name: str) -> str | None:
    """The axis that a plain name states (empty: none) if it is of this quantity; otherwise None."""
    without_unit = re.sub(r" (?:m s2|m s 2|deg|rad|mm|cm|m|g|ms2)$", "", name)
    word = WORDS[quantity]
    for pattern in (rf"(?:.* )?(?:{word}) ?({_AXIS})?(?: .*)?", rf"(?:.* )?({_AXIS}) (?:{word})(?: .*)?"):
        if found := re.fullmatch(pattern, without_unit):
            return found.group(1) or ""
    return None


def _of_quantity_axis(quantity: Quantity, name: str) -> str | None:
    return None if quantity == "signal" else _of_quantity(quantity, name)


def _unit(name: str, quantity: Quantity) -> str:
    plain_text = "µε" if quantity == "strain" and re.search(r"(?:micro|u|µ|μ)strain", name.lower()) else ""
    return plain_text or unit_in(name, UNITS[quantity])


def _named(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit and unit not in name else name


def _first(pattern: re.Pattern[str], plain: Sequence[str]) -> int:
    return next((k for k, name in enumerate(plain) if pattern.search(name)), -1)


def _index(names: Sequence[str], name: str) -> int:
    for wanted, known in ((name, names), (name.lower(), [one.lower() for one in names])):
        if wanted.strip() in known:
            return list(known).index(wanted.strip())
    raise ValueError(f"there is no column {name!r}; the columns are {', '.join(map(repr, names))}")
