"""The gust frame: along and across the wind, in length scales, moving with the air."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
from typing import NamedTuple

import numba

from galewood.constants import TURBULENCE_PER_GUSTINESS
from galewood.motion.wind.document import Wind


class View(NamedTuple):
    """Parameters that map positions to the gust frame, as plain numbers that compiled kernels can take."""

    cos: float
    sin: float
    cos_per_m: float
    """Cosine of the heading over the length scale, 1/m."""
    sin_per_m: float
    travel: float
    """Distance travelled by the air, in length scales."""
    mean_m_s: float
    along_m_s: float
    """Standard deviation of the speed along the wind."""
    across_m_s: float
    cells_along: float
    """Grid cells per length scale."""
    cells_across: float
    slant: float
    """Lateral drift of the gusts, so that the periodic pattern does not return to the same tree."""


def view_of(
    wind: Wind,
    travel: float,
    lateral_share: float,
    *,
    cells_along: float = 1.0,
    cells_across: float = 1.0,
    slant: float = 0.0,
) -> View:
    """The view of a wind after the air has travelled the given number of length scales."""
    heading = math.radians(wind.direction_deg)
    c, s = math.cos(heading), math.sin(heading)
    along_m_s = wind.mean_speed_m_s * TURBULENCE_PER_GUSTINESS * wind.gustiness
    return View(
        c,
        s,
        c / wind.length_scale_m,
        s / wind.length_scale_m,
        travel,
        wind.mean_speed_m_s,
        along_m_s,
        along_m_s * lateral_share,
        cells_along,
        cells_across,
        slant,
    )


@numba.njit(cache=True, nogil=True)
def write_velocity(view, i, along, across, out_x, out_z):  # pragma: no cover  (compiled)
    """Write the velocity (m/s, world x and z) for unit-variance fluctuations along and across the wind."""
    u = view.mean_m_s + view.along_m_s * along
    v = view.across_m_s * across
    out_x[i] = u * view.cos - v * view.sin
    out_z[i] = u * view.sin + v * view.cos
