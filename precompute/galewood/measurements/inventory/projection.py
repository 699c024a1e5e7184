"""Longitude and latitude to metres about a point."""

from __future__ import annotations

import math

EQUATOR_M, WGS84_FLATTENING = 6_378_137.0, 1.0 / 298.257223563
"""The ellipsoid of WGS 84."""
_E2 = WGS84_FLATTENING * (2.0 - WGS84_FLATTENING)


def local_m(lon_deg: float, lat_deg: float, origin: tuple[float, float]) -> tuple[float, float]:
    """Metres to the east and to the north of an origin (longitude, latitude, °).

    The ellipsoid is replaced by its radii of curvature at the origin; across a few kilometres the error is
    below 0.1 %.
    """
    phi = math.radians(origin[1])
    w2 = 1.0 - _E2 * math.sin(phi) * math.sin(phi)
    prime_vertical = EQUATOR_M / math.sqrt(w2)
    meridian = EQUATOR_M * (1.0 - _E2) / (w2 * math.sqrt(w2))
    turn = (lon_deg - origin[0] + 540.0) % 360.0 - 180.0
    return (
        prime_vertical * math.cos(phi) * math.radians(turn),
        meridian * math.radians(lat_deg - origin[1]),
    )
