"""Superposed cosine gust waves (paper, Sec. 6)."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba
import numpy as np

from galewood.constants import COSINE_HEADING_HZ, COSINE_HEADING_PHASE
from galewood.motion.wind.document import Wind
from galewood.motion.wind.models.hashing import phase_turns
from galewood.util import Floats


class CosineGusts:
    """The gust waves of one seed."""

    def __init__(self, wind: Wind) -> None:
        """Precompute the waves: columns frequency (Hz), share, wavenumber ratio, phase (turns)."""
        waves = [
            (
                w.frequency_hz,
                w.share,
                w.across,
                phase_turns(wind.seed, k) if w.phase_turns < 0.0 else w.phase_turns,
            )
            for k, w in enumerate(wind.waves)
        ]
        self._waves = np.array(waves)
        self._heading_phase = phase_turns(wind.seed, COSINE_HEADING_PHASE)

    def velocity(
        self, wind: Wind, time_s: float, x_m: Floats, z_m: Floats, out_x: Floats, out_z: Floats
    ) -> None:
        """Write the velocity (m/s, world x and z) at each position (m)."""
        swing_turns = wind.gustiness * wind.heading_swing_deg / 360.0
        wind_now = (wind.mean_speed_m_s, wind.gustiness, wind.direction_deg / 360.0, swing_turns)
        _sample(
            self._waves,
            self._heading_phase,
            wind_now,
            wind.convection_speed_m_s,
            time_s,
            x_m,
            z_m,
            out_x,
            out_z,
        )


@numba.njit(cache=True, nogil=True)
def cos_turns(turns):  # pragma: no cover  (compiled)
    """cos(2π turns) to 1e-15; faster than the library function and bit-identical in both languages."""
    y = math.pi * (turns - math.floor(turns + 0.5))
    z = y * y
    s = 1.0 / 121645100408832000.0
    s = 1.0 / 355687428096000.0 - z * s
    s = 1.0 / 1307674368000.0 - z * s
    s = 1.0 / 6227020800.0 - z * s
    s = 1.0 / 39916800.0 - z * s
    s = 1.0 / 362880.0 - z * s
    s = 1.0 / 5040.0 - z * s
    s = 1.0 / 120.0 - z * s
    s = 1.0 / 6.0 - z * s
    s = y - y * z * s
    return 1.0 - 2.0 * s * s


@numba.njit(cache=True, nogil=True)
def _sample(waves, heading_phase, wind, convection_m_s, time_s, x_m, z_m, out_x, out_z):  # pragma: no cover
    mean_m_s, gustiness, heading_turns, swing_turns = wind
    c, s = cos_turns(heading_turns), cos_turns(heading_turns - 0.25)
    for i in range(len(x_m)):
        age_s = time_s - (c * x_m[i] + s * z_m[i]) / convection_m_s
        across_s = (c * z_m[i] - s * x_m[i]) / convection_m_s
        ripple = 0.0
        for k in range(len(waves)):
            hz, share, across, phase = waves[k, 0], waves[k, 1], waves[k, 2], waves[k, 3]
            ripple += share * cos_turns(hz * (age_s + across * across_s) + phase)
        speed = mean_m_s * max(0.0, 1.0 + gustiness * ripple)
        swing = cos_turns(COSINE_HEADING_HZ * (age_s + 0.5 * across_s) + heading_phase)
        heading = heading_turns + swing_turns * swing
        out_x[i] = speed * cos_turns(heading)
        out_z[i] = speed * cos_turns(heading - 0.25)
