"""Wind speed and heading at given positions and times, from a small document and a seed.

Specified in spec/formats/wind.md; golden test vectors keep Python and TypeScript in step. Gusts are advected
by the wind, so neighbouring trees move similarly but not in unison. Code that evaluates many frames of one
forest should keep a ``WindField``.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.motion.wind.document import Wave, Wind, WindError, parse_wind
from galewood.motion.wind.field import WindField
from galewood.motion.wind.models.hashing import phase_rad
from galewood.motion.wind.presets import PRESETS, paper_wind
from galewood.motion.wind.pressure import (
    coverage,
    dynamic_pressure,
    height_factor,
    limit_pressure,
    to_tree_frame,
)
from galewood.motion.wind.transition import WindState, change_wind, parse_state, parse_wind_or_state, steady
from galewood.util import Floats

__all__ = [
    "PRESETS",
    "Wave",
    "Wind",
    "WindError",
    "WindField",
    "WindState",
    "change_wind",
    "coverage",
    "dynamic_pressure",
    "height_factor",
    "limit_pressure",
    "paper_wind",
    "parse_state",
    "parse_wind",
    "parse_wind_or_state",
    "phase_rad",
    "steady",
    "to_tree_frame",
    "wind_pressure",
    "wind_speed",
]

_last = threading.local()


def _field(wind: Wind) -> WindField:
    """One cached field per thread, since a wind is usually evaluated at many consecutive times."""
    field: WindField | None = getattr(_last, "field", None)
    if field is None:
        field = _last.field = WindField(wind)
    if field.state.wind != wind:
        field.state = steady(wind)
    return field


def wind_speed(wind: Wind, x_m: npt.ArrayLike, z_m: npt.ArrayLike, time_s: float) -> tuple[Floats, Floats]:
    """Speed (m/s, ≥ 0) and heading (rad, the direction of flow) at each position, at the reference height."""
    x, z = np.broadcast_arrays(np.asarray(x_m, np.float64), np.asarray(z_m, np.float64))
    velocity = np.zeros((2, x.size))
    flat_x, flat_z = np.ascontiguousarray(x.ravel()), np.ascontiguousarray(z.ravel())
    _field(wind).velocity(flat_x, flat_z, float(time_s), velocity[0], velocity[1])
    speed, heading = np.hypot(velocity[0], velocity[1]), np.arctan2(velocity[1], velocity[0])
    return speed.reshape(x.shape), heading.reshape(x.shape)


def wind_pressure(
    wind: Wind,
    x_m: npt.ArrayLike,
    z_m: npt.ArrayLike,
    time_s: float,
    out_x_pa: npt.NDArray[Any],
    out_z_pa: npt.NDArray[Any],
    exponent: float,
) -> None:
    """Write the pressure vector (Pa, world x and z) at each position; exactly 0 in still air.

    ``exponent`` is the streamlined exponent of the trees (``dynamic_pressure``).
    """
    _field(wind).pressure(x_m, z_m, float(time_s), out_x_pa, out_z_pa, exponent)
