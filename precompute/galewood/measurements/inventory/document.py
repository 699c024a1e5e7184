"""The inventory document (spec/formats/inventory.md) back to an inventory."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any, TypeVar, cast

from galewood.constants import INVENTORY_VERSION
from galewood.measurements.inventory.errors import InventoryError
from galewood.measurements.inventory.report import (
    InventoryReport,
    figures_of,
    stems_per_ha,
    substitutes_of,
)
from galewood.measurements.inventory.species import BUILTIN_NAMES
from galewood.measurements.inventory.stems import (
    FARTHEST_M,
    HIGHEST_M,
    LOWEST_M,
    MOST_STEMS,
    THICKEST_M,
    Inventory,
    Stem,
)

MOST_NOTES = 50
Value = TypeVar("Value", float, str, bool)


def inventory_of_document(document: Mapping[str, Any]) -> Inventory:
    """The stems of a document, with its notes. InventoryError names what is wrong."""
    version, stems = document.get("version"), document.get("stems")
    if version != INVENTORY_VERSION:
        raise InventoryError(f"version: this reader knows version {INVENTORY_VERSION}, not {version!r}")
    if not isinstance(stems, list) or not stems:
        raise InventoryError("stems: expected at least one")
    listed = cast("list[object]", stems)
    if len(listed) > MOST_STEMS:
        raise InventoryError(f"stems: {len(listed)}; at most {MOST_STEMS} are read")
    read = tuple(_stem(one, f"stems[{k}]") for k, one in enumerate(listed))
    return Inventory(read, _report(read, _notes(document)), (None,) * len(read))


def _report(stems: tuple[Stem, ...], notes: tuple[str, ...]) -> InventoryReport:
    """The report of these stems; how their file was read is known from its notes only."""
    east, north = [stem.east_m for stem in stems], [stem.north_m for stem in stems]
    width_m, depth_m = max(east) - min(east), max(north) - min(north)
    report = InventoryReport(
        columns={},
        rows=len(stems),
        stems=len(stems),
        skipped=0,
        first_skipped=(),
        substitutes=substitutes_of([(stem.species, stem.height_m) for stem in stems]),
        width_m=width_m,
        depth_m=depth_m,
        lowest_m=min(stem.height_m for stem in stems),
        highest_m=max(stem.height_m for stem in stems),
        per_ha=stems_per_ha(len(stems), width_m, depth_m),
        estimated_heights=sum(stem.height_estimated for stem in stems),
        height_curves=(),
        figures={},
        notes=notes,
    )
    return replace(report, figures=figures_of(report))


def _stem(given: object, path: str) -> Stem:
    if not isinstance(given, dict):
        raise InventoryError(f"{path}: expected an object")
    stem = cast("dict[str, Any]", given)
    missing = [field.name for field in fields(Stem) if field.name not in stem]
    if missing:
        raise InventoryError(
            f"{path}.{missing[0]} is missing: write the document again with `galewood convert`"
        )
    dbh_cm = stem["dbh_cm"]
    builtin = _of_type(stem, "builtin", str, path)
    if builtin not in BUILTIN_NAMES:
        raise InventoryError(f"{path}.builtin: expected one of {', '.join(BUILTIN_NAMES)}")
    return Stem(
        int(_number(stem, "line", path, 0, 1e9)),
        _number(stem, "east_m", path, -FARTHEST_M, FARTHEST_M),
        _number(stem, "north_m", path, -FARTHEST_M, FARTHEST_M),
        _of_type(stem, "species", str, path),
        builtin,
        _number(stem, "height_m", path, LOWEST_M, HIGHEST_M),
        _of_type(stem, "slender", bool, path),
        None if dbh_cm is None else _number(stem, "dbh_cm", path, 1e-3, 100 * THICKEST_M),
        _of_type(stem, "height_estimated", bool, path),
    )


def _of_type(stem: dict[str, Any], name: str, kind: type[Value], path: str) -> Value:
    if not isinstance(stem[name], kind):
        raise InventoryError(f"{path}.{name}: expected {'a text' if kind is str else 'true or false'}")
    return stem[name]


def _number(stem: dict[str, Any], name: str, path: str, low: float, high: float) -> float:
    value = stem[name]
    # integers of JSON may be too large for a float
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e300:
        raise InventoryError(f"{path}.{name}: expected a number")
    if not low <= value <= high:
        raise InventoryError(f"{path}.{name}: {value:g} is not between {low:g} and {high:g}")
    return float(value)


def _notes(document: Mapping[str, Any]) -> tuple[str, ...]:
    report = document.get("report")
    notes = cast("dict[str, Any]", report).get("notes") if isinstance(report, dict) else None
    listed = cast("list[object]", notes) if isinstance(notes, list) else []
    return tuple(str(note) for note in listed[:MOST_NOTES])
