"""Gust fronts: single gusts that start at a place and travel with the wind, beside those of a document.

Specified in spec/formats/wind.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from galewood.constants import (
    FRONT_DEPTH_M,
    FRONT_GUST_SHARE,
    FRONT_LEAST_GUST_M_S,
    FRONT_LEAST_TRAVEL_M_S,
    FRONT_LIMITS,
    FRONT_RANGE_M,
    FRONT_RISE_S,
    FRONT_SPREAD,
    FRONT_TRAVEL_SHARE,
    FRONT_WIDTH_M,
    MOST_FRONTS,
)
from galewood.motion.wind.document import WindError

if TYPE_CHECKING:
    from galewood.util import Floats


@dataclass(frozen=True)
class Front:
    """A gust front that started at a time and place, with the mean wind of that moment."""

    since_s: float
    x_m: float
    z_m: float
    direction_deg: float
    mean_speed_m_s: float

    def document(self) -> dict[str, object]:
        """The JSON object that ``parse_front`` accepts."""
        return asdict(self)


def parse_fronts(value: object) -> tuple[Front, ...]:
    """Parse the fronts of a wind's state. Raises WindError with the invalid field."""
    if not isinstance(value, list) or len(cast(list[object], value)) > MOST_FRONTS:
        raise WindError("wind_state.fronts", f"expected a list of at most {MOST_FRONTS} fronts")
    return tuple(_parse_front(one, k) for k, one in enumerate(cast(list[object], value)))


def _parse_front(value: object, index: int) -> Front:
    path = f"wind_state.fronts[{index}]"
    if not isinstance(value, Mapping):
        raise WindError(path, "expected an object")
    document = cast(Mapping[str, Any], value)
    numbers: dict[str, float] = {}
    for name, (low, high) in FRONT_LIMITS.items():
        number = document.get(name)
        if isinstance(number, bool) or not isinstance(number, int | float) or not low <= number <= high:
            raise WindError(f"{path}.{name}", f"expected a number in {low:g}..{high:g}")
        numbers[name] = float(number)
    if len(document) > len(fields(Front)):
        raise WindError(path, "unknown field")
    return Front(**numbers)


def add_fronts(
    fronts: tuple[Front, ...], x_m: Floats, z_m: Floats, time_s: float, out_x: Floats, out_z: Floats
) -> None:
    """Add the velocity (m/s, world x and z) of the fronts at each position (m)."""
    for front in fronts:
        _add_front(front, x_m, z_m, time_s - front.since_s, out_x, out_z)


def _add_front(front: Front, x_m: Floats, z_m: Floats, age_s: float, out_x: Floats, out_z: Floats) -> None:
    travelled_m = age_s * max(FRONT_LEAST_TRAVEL_M_S, FRONT_TRAVEL_SHARE * front.mean_speed_m_s)
    if age_s <= 0.0 or travelled_m >= FRONT_RANGE_M:
        return
    heading = math.radians(front.direction_deg)
    cos, sin = math.cos(heading), math.sin(heading)
    along = ((x_m - front.x_m) * cos + (z_m - front.z_m) * sin - travelled_m) / FRONT_DEPTH_M
    half_width_m = FRONT_WIDTH_M + FRONT_SPREAD * travelled_m
    across = ((z_m - front.z_m) * cos - (x_m - front.x_m) * sin) / half_width_m
    rise = min(age_s / FRONT_RISE_S, 1.0)
    left = 1.0 - travelled_m / FRONT_RANGE_M
    gust_m_s = (FRONT_LEAST_GUST_M_S + FRONT_GUST_SHARE * front.mean_speed_m_s) * rise * left
    speed = gust_m_s * _bump(along) * _bump(across)
    out_x += speed * cos
    out_z += speed * sin


def _bump(s: Floats) -> Floats:
    """(1 − s²)² for |s| < 1, otherwise 0."""
    rest = np.maximum(1.0 - s * s, 0.0)
    return rest * rest
