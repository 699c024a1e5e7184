"""From the rows of an inventory to trees."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import median

from galewood.measurements.inventory.columns import LENGTHS_M, Columns, find_header
from galewood.measurements.inventory.document import inventory_of_document
from galewood.measurements.inventory.errors import InventoryError
from galewood.measurements.inventory.geojson import json_object, rows_of_geojson
from galewood.measurements.inventory.heights import HeightCurve, assumed_height_m, fitted_curves
from galewood.measurements.inventory.projection import local_m
from galewood.measurements.inventory.report import (
    MOST_LISTED,
    InventoryReport,
    Skipped,
    figures_of,
    notes_of,
    stems_per_ha,
    substitutes_of,
)
from galewood.measurements.inventory.species import match_species
from galewood.measurements.inventory.stems import (
    FARTHEST_M,
    HIGHEST_M,
    LOWEST_M,
    MOST_STEMS,
    THICKEST_M,
    Inventory,
    Stem,
)
from galewood.util import Row, decoded, number_of, rows_of

LARGEST_BYTES = 32 * 1024**2
SLENDER_HEIGHT_PER_DIAMETER = 65.0
"""Above it a tree has grown in a stand; assumed."""
DENSE_PER_HA = 200.0
"""Trees without a measured height or diameter are slender in denser stands; assumed."""


@dataclass(frozen=True)
class _Raw:
    """A readable row: place in the file's coordinates, height and diameter (m; NaN: unknown)."""

    line: int
    x: float
    y: float
    species: str
    height_m: float
    dbh_m: float
    lon_lat_deg: tuple[float, float] | None


def read_inventory(file: Path | str | bytes, *, columns: Mapping[str, str] | None = None) -> Inventory:
    """Read stems from a CSV or a GeoJSON file, or an inventory document. InventoryError if none can be read.

    ``columns``: names of columns of the file by what they hold (x, y, lon, lat, genus, species, height, dbh,
    girth), where they are not recognised.
    """
    data = file if isinstance(file, bytes) else Path(file).read_bytes()
    if len(data) > LARGEST_BYTES:
        raise InventoryError(f"the file is larger than {LARGEST_BYTES // 1024**2} MB")
    text = decoded(data)
    if text.lstrip().startswith("{"):
        document = json_object(text)
        if "stems" in document:
            return inventory_of_document(document)
        return _inventory(rows_of_geojson(document), "feature", columns or {})
    try:
        return _inventory(list(rows_of(text)), "line", columns or {})
    except InventoryError:
        raise
    except ValueError as error:
        raise InventoryError(str(error)) from None


def _inventory(rows: list[Row], counted: str, chosen: Mapping[str, str]) -> Inventory:
    columns, first = find_header(rows, chosen)
    units = _units(columns, rows[first:])
    raws: list[_Raw] = []
    skipped: list[Skipped] = []
    data = [row for row in rows[first:] if not row.is_comment]
    for row in data:
        try:
            raws.append(_raw(columns, units, row))
        except ValueError as error:
            skipped.append(Skipped(row.line, str(error)))
    if not raws:
        why = f" ({counted} {skipped[0].line}: {skipped[0].reason})" if skipped else ""
        raise InventoryError(f"no row describes a tree{why}")
    placed, far = _placed(raws, columns.geographic)
    skipped += far
    skipped.sort(key=lambda one: one.line)
    return _reported(placed, skipped, columns, units, len(data), counted)


def _units(columns: Columns, rows: list[Row]) -> dict[str, str]:
    """The unit of each length: as stated, else m for heights, and for diameters what fits their median."""
    units = {"height": columns.units.get("height") or "m"}
    for what, usual_m in (("dbh", 0.3), ("girth", 1.0)):
        if what not in columns.index:
            continue
        stated = columns.units[what]
        values = sorted(value for row in rows if (value := _or_nan(columns.cell(row, what))) > 0.0)
        typical = values[len(values) // 2] if values else 100.0 * usual_m
        # a typical diameter is 0.3 m, 30 cm or 300 mm: the nearest by ratio
        fits = {unit: abs(math.log(typical * LENGTHS_M[unit] / usual_m)) for unit in ("cm", "mm", "m")}
        units[what] = stated or min(fits, key=lambda unit: fits[unit])
    if not columns.geographic:
        units["x"] = columns.units.get("x") or "m"
    return units


def _or_nan(cell: str) -> float:
    try:
        return number_of(cell)
    except ValueError:
        return math.nan


def _raw(columns: Columns, units: dict[str, str], row: Row) -> _Raw:
    """The tree of a row. ValueError with the reason if there is none."""
    x, y = _place(columns, units, row)
    height_m = _length(columns, units, row, "height")
    dbh_m = _length(columns, units, row, "dbh")
    if math.isnan(dbh_m):
        dbh_m = _length(columns, units, row, "girth") / math.pi
    if math.isnan(height_m) and math.isnan(dbh_m):
        raise ValueError("neither height nor diameter")
    if not math.isnan(height_m) and not LOWEST_M <= height_m <= HIGHEST_M:
        raise ValueError(f"a height of {height_m:.1f} m is not between {LOWEST_M:g} and {HIGHEST_M:g} m")
    if not math.isnan(dbh_m) and not 0.0 < dbh_m <= THICKEST_M:
        raise ValueError(f"a diameter of {dbh_m:.2f} m is not between 0 and {THICKEST_M:g} m")
    species, genus = columns.cell(row, "species"), columns.cell(row, "genus")
    lon_lat_deg = (x, y) if columns.geographic else None
    return _Raw(row.line, x, y, f"{genus} {species}".strip(), height_m, dbh_m, lon_lat_deg)


def _place(columns: Columns, units: dict[str, str], row: Row) -> tuple[float, float]:
    names = ("lon", "lat") if columns.geographic else ("x", "y")
    x, y = (_number(columns, row, name) for name in names)
    if math.isnan(x) or math.isnan(y):
        raise ValueError("no coordinates")
    if columns.geographic:
        if not (-180.0 <= x <= 180.0 and -89.0 <= y <= 89.0):
            raise ValueError(f"longitude {x:.4f} and latitude {y:.4f} are out of range")
        return x, y
    return x * LENGTHS_M[units["x"]], y * LENGTHS_M[units["x"]]


def _length(columns: Columns, units: dict[str, str], row: Row, what: str) -> float:
    return _number(columns, row, what) * LENGTHS_M[units[what]] if what in columns.index else math.nan


def _number(columns: Columns, row: Row, what: str) -> float:
    try:
        return number_of(columns.cell(row, what))
    except ValueError as error:
        raise ValueError(f"{columns.names[what]}: {error}") from None


def _placed(raws: list[_Raw], geographic: bool) -> tuple[list[_Raw], list[Skipped]]:
    """Trees in metres about the middle of the plot, and those that are too far away or too many."""
    if geographic:
        # counted from the first stem, as the date line may lie between them
        turns = [(raw.x - raws[0].x + 540.0) % 360.0 - 180.0 for raw in raws]
        origin = (raws[0].x + median(turns), median(raw.y for raw in raws))
        local = [local_m(raw.x, raw.y, origin) for raw in raws]
    else:
        local = [(raw.x, raw.y) for raw in raws]
    middle = (median(x for x, _ in local), median(y for _, y in local))
    offsets = [(x - middle[0], y - middle[1]) for x, y in local]
    distances = [math.sqrt(x * x + y * y) for x, y in offsets]
    order = sorted(range(len(raws)), key=lambda k: distances[k])
    near = {k for k in order[:MOST_STEMS] if distances[k] <= FARTHEST_M}
    skipped = [
        Skipped(
            raws[k].line,
            f"{distances[k]:.0f} m from the centre; at most {FARTHEST_M:.0f} m are shown"
            if distances[k] > FARTHEST_M
            else f"beyond the {MOST_STEMS} stems nearest to the centre",
        )
        for k in range(len(raws))
        if k not in near
    ]
    kept = [k for k in range(len(raws)) if k in near]
    if not kept:
        raise InventoryError(f"all stems are more than {FARTHEST_M:.0f} m from their centre")
    xs, ys = [offsets[k][0] for k in kept], [offsets[k][1] for k in kept]
    x0, y0 = 0.5 * (min(xs) + max(xs)), 0.5 * (min(ys) + max(ys))
    placed = [replace(raws[k], x=offsets[k][0] - x0, y=offsets[k][1] - y0) for k in kept]
    return placed, skipped


def _stem(raw: _Raw, per_ha: float, curves: Mapping[str, HeightCurve]) -> Stem:
    formless = _is_formless(raw)
    height_m = _estimated_m(raw, curves) if math.isnan(raw.height_m) else raw.height_m
    slender = per_ha > DENSE_PER_HA if formless else height_m / raw.dbh_m > SLENDER_HEIGHT_PER_DIAMETER
    builtin = match_species(raw.species, height_m).builtin
    dbh_cm = None if math.isnan(raw.dbh_m) else 100 * raw.dbh_m
    estimated = math.isnan(raw.height_m)
    return Stem(raw.line, raw.x, raw.y, raw.species, builtin, height_m, slender, dbh_cm, estimated)


def _estimated_m(raw: _Raw, curves: Mapping[str, HeightCurve]) -> float:
    """The height by the curve of the species, else of the stand, else by the assumed one."""
    curve = curves.get(raw.species) or curves.get("")
    return min(curve.height_m(raw.dbh_m) if curve else assumed_height_m(raw.dbh_m), HIGHEST_M)


def _is_formless(raw: _Raw) -> bool:
    """Whether height or diameter is missing, which decide whether the tree is slender."""
    return math.isnan(raw.height_m) or math.isnan(raw.dbh_m)


def _reported(
    placed: list[_Raw],
    skipped: list[Skipped],
    columns: Columns,
    units: dict[str, str],
    rows: int,
    counted: str,
) -> Inventory:
    east, north = [raw.x for raw in placed], [raw.y for raw in placed]
    width_m, depth_m = max(east) - min(east), max(north) - min(north)
    per_ha = stems_per_ha(len(placed), width_m, depth_m)
    curves = fitted_curves((one.species, one.dbh_m, one.height_m) for one in placed if not _is_formless(one))
    stems = tuple(_stem(raw, per_ha, curves) for raw in placed)
    estimated = [raw.species for raw in placed if math.isnan(raw.height_m)]
    used = {name if name in curves else "" for name in estimated}
    meanings = {
        what: f"{name}: {unit}" if (unit := units.get("x" if what == "y" else what)) else name
        for what, name in columns.names.items()
    }
    report = InventoryReport(
        columns=meanings,
        rows=rows,
        stems=len(stems),
        skipped=len(skipped),
        first_skipped=tuple(skipped[:MOST_LISTED]),
        substitutes=substitutes_of([(stem.species, stem.height_m) for stem in stems]),
        width_m=width_m,
        depth_m=depth_m,
        lowest_m=min(stem.height_m for stem in stems),
        highest_m=max(stem.height_m for stem in stems),
        per_ha=per_ha,
        estimated_heights=len(estimated),
        height_curves=tuple(curve for name, curve in curves.items() if name in used),
        figures={},
        notes=(),
    )
    formless = sum(map(_is_formless, placed))
    notes = notes_of(report, columns, units, formless, counted)
    places = tuple(raw.lon_lat_deg for raw in placed)
    return Inventory(stems, replace(report, figures=figures_of(report), notes=notes), places)
