"""Which column of an inventory holds what, and in which unit."""

from __future__ import annotations

import re
from dataclasses import dataclass

from galewood.measurements.inventory.errors import InventoryError
from galewood.util import HEADER_WITHIN, Row

_NAMES = {
    "x": r"x|x (m|coord[a-z]*)|coord[a-z]* x|pos x|x pos|east|easting|utm x|utm e(ast)?|rechtswert|ostwert",
    "y": r"y|y (m|coord[a-z]*)|coord[a-z]* y|pos y|y pos|north|northing|utm y|utm n(orth)?|hochwert|nordwert",
    "lon": r"lon|long|lng|longitude|laenge|laengengrad|(decimal|wgs84) lon(gitude)?",
    "lat": r"lat|latitude|breite|breitengrad|(decimal|wgs84) lat(itude)?",
    "genus": r"genus|gattung",
    "species": r"species|(tree )?species( name| latin| code)?|scientific ?name|latin ?name|botanical ?name"
    r"|common ?name|baumart|art|artname|art (deutsch|latein|botanisch)|botanischer name|taxon|spp|sp|tree",
    "height": r"height|tree height|total height|h|ht|hoehe|baumhoehe",
    "dbh": r"dbh|bhd|diameter|d130|d13|d1 3|d|trunk diameter|stem diameter|stammdurchmesser|durchmesser",
    "girth": r"gbh|cbh|girth|circumference|trunk circumference|umfang|stammumfang",
}
_UNIT_WORD = r"(?: (?:mm|cm|dm|m|ft|feet|in|inch|inches|meters?|metres?|deg))?"
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
    "no column names were found. Needed are 'x' and 'y' (m) or 'lon' and 'lat', and 'height' (m) "
    "or 'dbh' (cm); 'species' is useful"
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


def find_header(rows: list[Row]) -> tuple[Columns, int]:
    """The columns and the index of the row after their names. InventoryError."""
    for k, row in enumerate(rows[:HEADER_WITHIN]):
        columns = columns_of(row)
        if columns is not None:
            return columns, k + 1
    raise InventoryError(NEEDED_COLUMNS)


def is_inventory(rows: list[Row]) -> bool:
    """Whether a table, or its beginning, has the columns of an inventory."""
    return any(columns_of(row) is not None for row in rows[:HEADER_WITHIN])


def columns_of(row: Row) -> Columns | None:
    """The columns that a row of names describes; None if it is no such row."""
    plain = [plain_name(cell) for cell in row.cells]
    index: dict[str, int] = {}
    for what, pattern in _PATTERNS.items():
        found = next((k for k, name in enumerate(plain) if pattern.fullmatch(name)), -1)
        if found >= 0:
            index[what] = found
    placed = ("x" in index and "y" in index) or ("lon" in index and "lat" in index)
    if not placed or not {"height", "dbh", "girth"} & set(index):
        return None
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
