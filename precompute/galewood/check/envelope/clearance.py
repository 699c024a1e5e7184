"""Clearance between a tree in gusts and lines or façades of a GeoJSON file."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from galewood.check.envelope.reach import SwayEnvelope
from galewood.measurements import is_projected, local_m
from galewood.util import Floats, shown_text

STEP_M = 0.25
"""Distance between the points of a line at which its clearance is looked at."""
MOST_POINTS = 200_000
LARGEST_ANGLE_DEG = 180.0
FARTHEST_LINE_M = 5000.0
"""A line farther than this is of no concern to a tree."""


@dataclass(frozen=True)
class Line:
    """A line or façade relative to the tree: points (n, 2) to the east and south, m, at a height, m.

    height_m None: the whole height of the tree.
    """

    name: str
    points_m: Floats
    height_m: float | None


@dataclass(frozen=True)
class Clearance:
    """Smallest distance between a line and the tree, m, at rest and in gusts; below 0: it is touched."""

    name: str
    rest_m: float
    median_m: float
    p90_m: float
    east_m: float
    north_m: float
    """Where it is smallest in gusts (90 %)."""


def read_lines(file: Path | str | bytes, place: tuple[float, float]) -> list[Line]:
    """The lines and polygons of a GeoJSON file about a tree at a place in its coordinates.

    Coordinates are longitudes and latitudes, as RFC 7946 has them, or metres if the file names a projected
    reference system or one of them cannot be an angle. The property ``height_m`` is the height of a line.
    Raises ValueError, also if all lines are kilometres away: then the coordinates are of another kind.
    """
    data = file if isinstance(file, bytes) else Path(file).read_bytes()
    try:
        document: Any = json.loads(data)
    except (ValueError, RecursionError):
        raise ValueError("the file of lines is not valid JSON") from None
    features = document.get("features") if isinstance(document, dict) else None
    if not isinstance(features, list):
        raise ValueError("expected a GeoJSON FeatureCollection of lines or polygons")
    found = [
        line for number, one in enumerate(cast("list[Any]", features), 1) for line in _lines(one, number)
    ]
    if not found:
        raise ValueError("the file has no LineString and no Polygon")
    largest = max(*(float(np.abs(line.points_m).max()) for line in found), *map(abs, place))
    metric = is_projected(cast("dict[str, Any]", document)) or largest > LARGEST_ANGLE_DEG
    lines = [_about(line, place, metric) for line in found]
    nearest_m = min(float(np.linalg.norm(_dense(line.points_m), axis=1).min()) for line in lines)
    if nearest_m > FARTHEST_LINE_M:
        read_as = "metres" if metric else "longitudes and latitudes"
        raise ValueError(
            f"the nearest line is {nearest_m / 1000:,.0f} km from the tree: its coordinates were read as "
            f"{read_as}. A file in metres names its projected reference system as crs"
        )
    return lines


def clearances(envelope: SwayEnvelope, lines: list[Line]) -> list[Clearance]:
    """The clearance of each line, the smallest first.

    The reach in a direction is that of the tree's outermost points in it, and between two directions as far
    as the convex outline with these reaches goes: no clearance is larger than that of the vertices followed.
    """
    levels = [envelope.rest_m, envelope.quantile_m(0.5), envelope.quantile_m(0.9)]
    found = [_clearance(envelope, line, levels) for line in lines]
    return sorted(found, key=lambda one: one.p90_m)


def _clearance(envelope: SwayEnvelope, line: Line, levels: list[Floats]) -> Clearance:
    points = _dense(line.points_m)
    distance = np.linalg.norm(points, axis=1)
    angle = np.degrees(np.arctan2(points[:, 1], points[:, 0])) % 360
    band = slice(None)
    if line.height_m is not None:
        k = int(np.clip(np.searchsorted(envelope.height_m, line.height_m) - 1, 0, len(envelope.rest_m) - 1))
        band = slice(max(k - 1, 0), k + 2)  # a line may meet what hangs down from the next band
    free = [distance - _reach_between(level[band].max(axis=0), angle) for level in levels]
    at = int(np.argmin(free[2]))
    return Clearance(
        line.name, float(free[0].min()), float(free[1].min()), float(free[2].min()),
        float(points[at, 0]), float(-points[at, 1]),
    )  # fmt: skip


def _reach_between(reach_m: Floats, angle_deg: Floats) -> Floats:
    """(n,) largest reach at angles (n,) of a convex outline with these reaches (d,) at equal angles.

    A support function h is sublinear: h(θ + a) sin s ≤ h(θ) sin(s − a) + h(θ + s) sin a for the step s.
    """
    step = 2 * np.pi / len(reach_m)
    first = np.floor(np.radians(angle_deg) / step).astype(int)
    after = np.radians(angle_deg) - first * step
    low, high = reach_m[first % len(reach_m)], reach_m[(first + 1) % len(reach_m)]
    return (low * np.sin(step - after) + high * np.sin(after)) / np.sin(step)


def _lines(feature: Any, number: int) -> Iterator[Line]:
    mapping: dict[str, Any] = feature if isinstance(feature, dict) else {}
    geometry: dict[str, Any] = mapping.get("geometry") or {}
    properties: dict[str, Any] = mapping.get("properties") or {}
    kind, coordinates = geometry.get("type"), geometry.get("coordinates")
    parts: list[Any] = {
        "LineString": [coordinates], "MultiLineString": coordinates, "Polygon": coordinates,
        "MultiPolygon": [ring for polygon in coordinates or [] for ring in polygon]
        if kind == "MultiPolygon" else [],
    }.get(str(kind)) or []  # fmt: skip
    name = shown_text(str(properties.get("name") or f"feature {number}"))
    height = properties.get("height_m")
    for part in parts:
        try:
            points = np.array([[float(point[0]), float(point[1])] for point in part])
            level = None if height is None else float(height)
        except (TypeError, ValueError, IndexError):
            raise ValueError(f"{name}: its coordinates or its height_m are no numbers") from None
        if len(points) < 2 or not np.isfinite(points).all():
            raise ValueError(f"{name}: a line needs two points")
        yield Line(name, points, level)


def _about(line: Line, place: tuple[float, float], metric: bool) -> Line:
    if metric:
        east, north = (line.points_m - np.array(place)).T
    else:
        east, north = np.array([local_m(lon, lat, place) for lon, lat in line.points_m]).T
    return Line(line.name, np.column_stack([east, -north]), line.height_m)


def _dense(points_m: Floats) -> Floats:
    """Points along the pieces of a line, 0.25 m apart or more for a very long one."""
    length = np.linalg.norm(np.diff(points_m, axis=0), axis=1)
    step = max(STEP_M, float(length.sum()) / MOST_POINTS)
    pieces = [
        start + np.linspace(0, 1, max(2, int(np.ceil(one / step)) + 1))[:, None] * (end - start)
        for start, end, one in zip(points_m[:-1], points_m[1:], length, strict=True)
    ]
    return np.concatenate(pieces)
