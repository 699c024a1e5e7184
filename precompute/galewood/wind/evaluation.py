"""The wind: a speed and a heading at a place and a time, from a small document and a seed.

docs/formats/wind.md is the specification; web/src/wind.ts is the same arithmetic in TypeScript and golden
vectors hold the two together. Gusts travel with the wind, so neighbours move alike but not in unison. The
models are in ``precompute.wind_models``; whoever plays a forest keeps a ``WindField``.
"""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.util import Floats
from galewood.wind.document import Wave, Wind, WindError, parse_wind
from galewood.wind.field import WindField
from galewood.wind.models.hashing import phase_rad
from galewood.wind.presets import PRESETS, paper_wind
from galewood.wind.pressure import (
    AIR_DENSITY_KG_M3,
    STREAMLINED_EXPONENT,
    STREAMLINING_SPEED_M_S,
    coverage,
    dynamic_pressure,
    height_factor,
    limit_pressure,
    sampled_peak_pa,
    to_tree_frame,
)
from galewood.wind.transition import WindState, change_wind, parse_state, parse_wind_or_state, steady

__all__ = [
    "AIR_DENSITY_KG_M3",
    "PRESETS",
    "STREAMLINED_EXPONENT",
    "STREAMLINING_SPEED_M_S",
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
    "sampled_peak_pa",
    "steady",
    "to_tree_frame",
    "wind_pressure",
    "wind_speed",
]

_last = threading.local()


def _field(wind: Wind) -> WindField:
    """One field a thread: a wind is usually asked for many moments in a row."""
    field: WindField | None = getattr(_last, "field", None)
    if field is None:
        field = _last.field = WindField(wind)
    if field.state.wind != wind:
        field.state = steady(wind)
    return field


def wind_speed(wind: Wind, x_m: npt.ArrayLike, z_m: npt.ArrayLike, time_s: float) -> tuple[Floats, Floats]:
    """Speed (m/s, ≥ 0) and heading (rad, blown towards) at each place, at the reference height."""
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
) -> None:
    """Write the pressure vector (Pa, world x and z) at each place; exactly 0 where the wind is still."""
    _field(wind).pressure(x_m, z_m, float(time_s), out_x_pa, out_z_pa)
