"""Which column of an inventory holds what, and in which unit."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from galewood.measurements.inventory.errors import InventoryError
from galewood.util import HEADER_WITHIN, Row

_NAMES = {
    "x": r"x|x (m|coord[a-z]*)|coord[a-z]* x|pos x|x pos|e|east|easting|ost|rechts|rechtswert|ostwert",
    "y": r"y|y (m|coord[a-z]*)|coord[a-z]* y|pos y|y pos|n|north|northing|nord|hoch|hochwert|nordwert",
    "lon": r"lon|long|lng|longitude|laenge|laengengrad|decimal lon(gitude)?",
    "lat": r"lat|latitude|breite|breitengrad|decimal lat(itude)?",
    "genus": r"genus|gattung",
    "species": r"species|(tree )?species( name| latin| code)?|scientific ?name|latin ?name|botanical ?name"
    r"|common ?name|baumart|ba|art|artname|art (deutsch|latein|botanisch)|botanischer name|taxon|spp|sp|tree",
    "height": r"height|tree height|total height|h|ht|hoehe|baumhoehe",
    "dbh": r"dbh|bhd|diameter|d130|d13|d1 3|d|trunk diameter|stem diameter|stammdurchmesser|durchmesser",
    "girth": r"gbh|cbh|girth|circumference|trunk circumference|umfang|stammumfang",
}
_GRID = re.compile(r"\b(utm|gk|gauss krueger|etrs|epsg|wgs|lv|osgb|zone|coord[a-z]*)( ?\d+[a-z]?)*\b")
"""Reference systems and zones in names of coordinates, which say nothing about the axis: UTM-Ost, X_UTM32."""
_UNIT_WORD = r"(?: (?:mm|cm|dm|m|ft|feet|in|inch|inches|meters?|metres?|deg))?"
PLACES = ("x", "y", "lon", "lat")
MOST_NAMES = 12
"""Columns that an error lists."""
_PATTERNS = {what: re.compile(f"(?:{names}){_UNIT_WORD}") for what, names in _NAMES.items()}
LENGTHS_M = {
    "mm": 0.001,
    "cm": 0.01,
    "dm": 0.1,
    "m": 1.0,
    "ft": 0.3048,
    "in": 0.0254,
}
_SYNONYMS = {
    "feet": "ft",
    "inch": "in",
    "inches": "in",
    "meter": "m",
    "meters": "m",
    "metre": "m",
    "metres": "m",
}
NEEDED_COLUMNS = (
    "Needed are 'x' and 'y' (m) or 'lon' and 'lat', and 'height' (m) or 'dbh' (cm); 'species' is useful"
)


@dataclass(frozen=True)
class Columns:
    """Index of each column by what it holds, its name, and its unit as far as it is stated."""

    index: dict[str, int]
    names: dict[str, str]
    units: dict[str, str]

    def cell(self, row: Row, what: str) -> str:
        """The cell of a row; empty without such a column."""
        return row.cell(self.index.get(what, -1))

    @property
    def geographic(self) -> bool:
        """Whether places are longitudes and latitudes."""
        return "x" not in self.index or "y" not in self.index


def find_header(rows: list[Row], chosen: Mapping[str, str]) -> tuple[Columns, int]:
    """The columns and the index of the row after their names. InventoryError, with what was recognised.

    ``chosen``: names of columns by what they hold, instead of those that would be recognised.
    """
    if unknown := sorted(set(chosen) - set(_PATTERNS)):
        raise InventoryError(f"no column holds {unknown[0]!r}: choose from {', '.join(_PATTERNS)}")
    for k, row in enumerate(rows[:HEADER_WITHIN]):
        index = _recognised(row, chosen)
        if _is_enough(index):
            return _columns(row, index), k + 1
    for name in chosen.values():
        if not any(name in row.cells for row in rows[:HEADER_WITHIN]):
            raise InventoryError(
                f"there is no column {name[:40]!r}; the first row is {_quoted(_first(rows))}"
            )
    found = recognised_columns(rows, chosen)
    raise InventoryError(
        f"columns are missing. Recognised: {found}. {NEEDED_COLUMNS}"
        if found
        else f"no column names were found. {NEEDED_COLUMNS}"
    )


def recognised_columns(rows: list[Row], chosen: Mapping[str, str]) -> str:
    """What is recognised in the row with the most names of columns, and what is not, for an error."""
    found = [(_recognised(row, chosen), row) for row in rows[:HEADER_WITHIN]]
    index, row = max(found, key=lambda one: len(one[0]), default=({}, None))
    if row is None or not index:
        return ""
    taken = ", ".join(f"{row.cells[k]!r} as {what}" for what, k in index.items())
    others = [cell for k, cell in enumerate(row.cells) if cell and k not in index.values()]
    return f"{taken}; not recognised: {_quoted(others)}" if others else taken


def _first(rows: list[Row]) -> Sequence[str]:
    return next((row.cells for row in rows if not row.is_comment), ())


def _quoted(names: Sequence[str]) -> str:
    return ", ".join(repr(name[:40]) for name in names[:MOST_NAMES]) + (", …" if names[MOST_NAMES:] else "")


def is_inventory(rows: list[Row]) -> bool:
    """Whether a table, or its beginning, has the columns of an inventory."""
    return any(_is_enough(_recognised(row, {})) for row in rows[:HEADER_WITHIN])


def _recognised(row: Row, chosen: Mapping[str, str]) -> dict[str, int]:
    """The index of each column by what it holds, as far as a row of names tells."""
    index: dict[str, int] = {}
    for what, pattern in _PATTERNS.items():
        if what in chosen:
            found = next((k for k, cell in enumerate(row.cells) if cell == chosen[what]), -1)
        else:
            found = next((k for k, name in enumerate(row.cells) if _names(what, pattern, name)), -1)
        if found >= 0:
            index[what] = found
    return index


def _names(what: str, pattern: re.Pattern[str], name: str) -> bool:
    """Whether the name of a column says that it holds this."""
    if what not in PLACES:
        return pattern.fullmatch(plain_name(name)) is not None
    whole = plain_name(re.sub(r"[\[\]()]", " ", name))
    axis = " ".join(_GRID.sub(" ", whole).split())
    # the letters alone, as in E and N, are directions only beside the name of a grid
    return pattern.fullmatch(axis) is not None and (axis != whole or axis not in ("e", "n"))


def _is_enough(index: dict[str, int]) -> bool:
    """Whether there are places and sizes."""
    placed = ("x" in index and "y" in index) or ("lon" in index and "lat" in index)
    return placed and bool({"height", "dbh", "girth"} & set(index))


def _columns(row: Row, index: dict[str, int]) -> Columns:
    names = {what: row.cells[k] for what, k in index.items()}
    return Columns(index, names, {what: _unit_of(name) for what, name in names.items()})


def plain_name(cell: str) -> str:
    """A name in lower case, without brackets, umlauts written out, words separated by single blanks."""
    text = re.sub(r"[\[(].*?[\])]", " ", cell.lower().lstrip("#"))
    for letter, written in {"ä": "ae", "ö": "oe", "ü": "ue"}.items():
        text = text.replace(letter, written)
    return re.sub(r"[^a-z0-9]+", " ", text).strip()


def _unit_of(name: str) -> str:
    """The unit in the brackets of a name, or its last word; empty if it states none."""
    bracket = re.search(r"[\[(](.*?)[\])]", name)
    words = plain_name(name).split(" ")
    word = bracket.group(1).strip().lower() if bracket else (words[-1] if len(words) > 1 else "")
    unit = _SYNONYMS.get(word, word)
    return unit if unit in LENGTHS_M else ""
