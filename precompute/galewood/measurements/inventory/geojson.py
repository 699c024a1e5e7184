"""Points of a GeoJSON file (RFC 7946) as rows, so that they are read like a table."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any, cast

from galewood.measurements.inventory.errors import InventoryError
from galewood.util import Row, shown_text


def json_object(text: str) -> Mapping[str, Any]:
    """The JSON object that a file holds. InventoryError."""
    try:
        return _mapping(json.loads(text))
    except (ValueError, RecursionError):
        raise InventoryError("the file is not valid JSON") from None


def rows_of_geojson(document: Mapping[str, Any]) -> list[Row]:
    """A row of names, then one row per feature, whose line is its number. InventoryError."""
    features = document.get("features")
    if not isinstance(features, list):
        raise InventoryError("expected a GeoJSON FeatureCollection of points")
    listed = [_mapping(feature) for feature in cast("list[object]", features)]
    names: dict[str, None] = {}
    for feature in listed:
        names.update(dict.fromkeys(_mapping(feature.get("properties"))))
    # names of places among the properties must not come before the geometry
    kept = [name for name in names if name.lower() not in ("x", "y", "lon", "lat")]
    places = ("x", "y") if is_projected(document) else ("lon", "lat")
    rows = [Row(0, (*places, *map(shown_text, kept)))]
    for number, feature in enumerate(listed, 1):
        properties = _mapping(feature.get("properties"))
        rows.append(Row(number, (*_point(feature), *(_text(properties.get(name)) for name in kept))))
    return rows


def _mapping(value: object) -> Mapping[str, Any]:
    return cast("Mapping[str, Any]", value) if isinstance(value, Mapping) else {}


def is_projected(document: Mapping[str, Any]) -> bool:
    """Whether coordinates of a GeoJSON file are metres: an old file names a projected reference system."""
    name = str(_mapping(_mapping(document.get("crs")).get("properties")).get("name", ""))
    return bool(name) and not name.endswith(("CRS84", ":4326", ":4258"))


def _point(feature: Mapping[str, Any]) -> tuple[str, str]:
    geometry = _mapping(feature.get("geometry"))
    place = geometry.get("coordinates")
    if geometry.get("type") == "MultiPoint" and isinstance(place, list) and place:
        place = cast("list[object]", place)[0]
    elif geometry.get("type") != "Point":
        return "", ""
    values = cast("list[object]", place) if isinstance(place, list) else []
    return (_text(values[0]), _text(values[1])) if len(values) >= 2 else ("", "")


def _text(value: object) -> str:
    """A value as the clean text of a cell; numbers without an exponent where they have none."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return ""
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return shown_text(str(value).strip())
