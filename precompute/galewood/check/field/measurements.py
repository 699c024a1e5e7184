"""The table of measurements: one row per tree and season, with tolerant names of its columns."""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeVar

from galewood.options import MAX_HEIGHT_M, MIN_HEIGHT_M
from galewood.wood import SPECIES

Season = Literal["leaf", "bare"]
Setting = Literal["forest", "open", "conifer"]
Value = TypeVar("Value")

COLUMNS: dict[str, tuple[str, ...]] = {
    "tree": ("tree", "file", "filename", "name", "treename", "treeid", "id", "model", "qsm"),
    "frequency": ("frequency", "freq", "f", "f0", "f1", "measuredfrequency", "naturalfrequency",
                  "fundamentalfrequency", "swayfrequency", "measured"),
    "critical": ("criticalwind", "criticalwindspeed", "criticalgust", "breakingwind", "breaksat"),
    "damping": ("damping", "dampingratio", "measureddamping", "measureddampingratio", "zeta", "xi"),
    "season": ("season", "foliage", "leaves", "leaf", "leafstate"),
    "height": ("height", "treeheight", "h"),
    "dbh": ("dbh", "diameter", "d", "diameteratbreastheight"),
    "species": ("species", "wood", "woodspecies"),
    "setting": ("setting", "site", "growth", "stand", "grown"),
}  # fmt: skip
"""Accepted names of each column, without units, spaces, underscores and capitals."""
UNITS: dict[str, dict[str, float]] = {
    "frequency": {"": 1.0, "hz": 1.0},
    "critical": {"": 1.0, "ms": 1.0, "mps": 1.0, "kmh": 1 / 3.6},
    "damping": {"": 1.0, "percent": 0.01, "pct": 0.01},
    "height": {"": 1.0, "m": 1.0, "cm": 0.01},
    "dbh": {"": 1.0, "cm": 1.0, "m": 100.0, "mm": 0.1},
}
"""Accepted units after the name, and their value in Hz, 1, m and cm."""
RANGES = {
    "frequency": (0.01, 50.0),
    "critical": (0.5, 200.0),
    "strain": (0.0, 0.1),
    "damping": (0.0, 1.0),
    "height": (MIN_HEIGHT_M, MAX_HEIGHT_M),
    "dbh": (0.5, 1500.0),
}
"""Exclusive lower and inclusive upper limits in those units."""
STRAIN_NAME = re.compile(r"(micro)?strain(?:at)?(\d+(?:p\d+)?)(?:ms|mps)?(microstrain|ue)?")
"""Strain at breast height in a wind of a speed in m/s, such as strain_15 or microstrain at 7.5 m/s."""
SEASONS: dict[str, Season] = {
    "leaf": "leaf", "leaves": "leaf", "inleaf": "leaf", "leafon": "leaf", "summer": "leaf",
    "foliated": "leaf", "yes": "leaf",
    "bare": "bare", "leafless": "bare", "leafoff": "bare", "winter": "bare", "no": "bare",
}  # fmt: skip
SETTINGS: dict[str, Setting] = {
    "forest": "forest", "forestgrown": "forest", "wood": "forest", "woodland": "forest",
    "open": "open", "opengrown": "open", "park": "open", "urban": "open", "conifer": "conifer",
}  # fmt: skip
MISSING_VALUES = {"", "na", "nan", "n/a", "-", "none", "null"}


class FieldError(ValueError):
    """The folder or its table of measurements cannot be used; the message says what to do."""


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """One row of the table. `line` is its line in the file, for messages.

    strains: pairs of a wind at the top, m/s, and the bending strain at breast height in it; critical_m_s: the
    gust that breaks the stem. At least one of these and the frequency is measured.
    """

    line: int
    tree: str
    frequency_hz: float | None = None
    strains: tuple[tuple[float, float], ...] = ()
    critical_m_s: float | None = None
    damping_ratio: float | None = None
    season: Season = "leaf"
    height_m: float | None = None
    dbh_cm: float | None = None
    species: str | None = None
    setting: Setting | None = None


def read_measurements(path: Path) -> list[Measurement]:
    """Read the table. Raises FieldError that lists every problem with its line."""
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError:
        raise FieldError(f"{path.name} is not a text file in UTF-8") from None
    header, rows = _rows(text)
    columns = _columns(path.name, header)
    found: list[Measurement] = []
    problems: list[str] = []
    for line, row in rows:
        try:
            found.append(_measurement(line, columns, row))
        except FieldError as error:
            problems.append(f"line {line}: {error}")
    problems += _repeated(found)
    if problems:
        raise FieldError(f"{path.name}: " + "; ".join(problems))
    if not found:
        raise FieldError(f"{path.name} has no measurements below its header")
    return found


def is_table(path: Path) -> bool:
    """Whether a file is a CSV table with columns for the tree and for what was measured on it."""
    try:
        header, _ = _rows(path.read_bytes()[:20_000].decode("utf-8-sig", "replace"))
        _columns(path.name, header)
    except FieldError:
        return False
    return True


def _rows(text: str) -> tuple[list[str], Iterator[tuple[int, list[str]]]]:
    """The header, and (line, cells) of the rows that are not empty."""
    lines = text.splitlines()
    first = next((k for k, line in enumerate(lines) if line.strip() and not line.startswith("#")), None)
    if first is None:
        raise FieldError("the table is empty")
    delimiter = max(",;\t", key=lines[first].count)
    reader = csv.reader(io.StringIO("\n".join(lines[first:])), delimiter=delimiter, skipinitialspace=True)
    header = next(reader)

    def rest() -> Iterator[tuple[int, list[str]]]:
        for row in reader:
            cells = [cell.strip() for cell in row]
            if delimiter == ";":
                cells = [re.sub(r"^(-?\d+),(\d+)$", r"\1.\2", cell) for cell in cells]
            if any(cells) and not cells[0].startswith("#"):
                yield first + reader.line_num, cells

    return header, rest()


def _columns(file: str, header: list[str]) -> dict[str, tuple[int, float]]:
    """Index and unit of each known column. Raises FieldError."""
    found: dict[str, tuple[int, float]] = {}
    for index, name in enumerate(header):
        known = _known(name)
        if known and known[0] not in found:
            found[known[0]] = (index, known[1])
    names = ", ".join(repr(name.strip()) for name in header)
    if "tree" not in found:
        raise FieldError(f"{file} has no column 'tree'; its columns are {names}")
    if not any(is_measured(column) for column in found):
        raise FieldError(
            f"{file} has no column 'frequency_hz', 'strain_15' or 'critical_wind_m_s'; its columns are "
            f"{names}"
        )
    return found


def is_measured(column: str) -> bool:
    """Whether a column holds what trees are compared by."""
    return column in ("frequency", "critical") or column.startswith("strain_")


def _known(name: str) -> tuple[str, float] | None:
    pointed = re.sub(r"(\d)[.,](\d)", r"\1p\2", name.lower())
    plain = re.sub(r"[^a-z0-9]", "", pointed.replace("%", "percent"))
    for column, names in COLUMNS.items():
        for unit, value in UNITS.get(column, {"": 1.0}).items():
            if any(plain == accepted + unit for accepted in names):
                return column, value
    if strain := STRAIN_NAME.fullmatch(plain):
        micro = strain.group(1) or strain.group(3)
        return f"strain_{strain.group(2).replace('p', '.')}", 1e-6 if micro else 1.0
    return None


def _measurement(line: int, columns: dict[str, tuple[int, float]], row: list[str]) -> Measurement:
    def cell(column: str) -> str | None:
        index = columns[column][0] if column in columns else len(row)
        text = row[index] if index < len(row) else ""
        return None if text.lower() in MISSING_VALUES else text

    def number(column: str) -> float | None:
        text = cell(column)
        return None if text is None else _number(column, text, columns[column][1])

    tree = row[columns["tree"][0]]
    if not tree:
        raise FieldError("the tree has no name")
    measured = {
        column: value for column in columns if is_measured(column) and (value := number(column)) is not None
    }
    if not measured:
        what = "frequency" if "frequency" in columns else "measurement"
        raise FieldError(f"{tree} has no {what}")
    species = cell("species")
    if species is not None and species.lower() not in SPECIES:
        raise FieldError(f"unknown species {species!r}; known: {', '.join(sorted(SPECIES))}")
    return Measurement(
        line=line,
        tree=tree,
        frequency_hz=measured.get("frequency"),
        strains=tuple(
            (float(column[7:]), v) for column, v in measured.items() if column.startswith("strain_")
        ),
        critical_m_s=measured.get("critical"),
        damping_ratio=number("damping"),
        season=_choice("season", cell("season"), SEASONS) or "leaf",
        height_m=number("height"),
        dbh_cm=number("dbh"),
        species=species.lower() if species else None,
        setting=_choice("setting", cell("setting"), SETTINGS),
    )


def _number(column: str, text: str, unit: float) -> float:
    try:
        value = float(text) * unit
    except ValueError:
        raise FieldError(f"{column} {text!r} is not a number") from None
    low, high = RANGES["strain" if column.startswith("strain_") else column]
    if not low < value <= high and column.startswith("strain_"):
        raise FieldError(f"{column} {text} is outside {low:g} to {high:g}; micro{column} is in millionths")
    if not low < value <= high:
        raise FieldError(f"{column} {text} is outside {low:g} to {high:g} {_unit(column)}".rstrip())
    return value


def _unit(column: str) -> str:
    return {"frequency": "Hz", "height": "m", "dbh": "cm", "critical": "m/s"}.get(column, "")


def _choice(column: str, text: str | None, known: dict[str, Value]) -> Value | None:
    if text is None:
        return None
    plain = re.sub(r"[^a-z]", "", text.lower())
    if plain not in known:
        choices = " or ".join(sorted({str(value) for value in known.values()}))
        raise FieldError(f"{column} {text!r} is unknown; use {choices}")
    return known[plain]


def _repeated(found: list[Measurement]) -> list[str]:
    seen: dict[tuple[str, str], int] = {}
    problems: list[str] = []
    for row in found:
        key = (row.tree.lower(), row.season)
        if key in seen:
            problems.append(f"line {row.line}: {row.tree} ({row.season}) is already on line {seen[key]}")
        seen.setdefault(key, row.line)
    return problems
