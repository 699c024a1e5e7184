"""The design wind speed, limited so that the tree is not bent beyond the validity of its model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.motion.wind import dynamic_pressure
from galewood.pipeline.sampling.recording import Body

MAX_SWAY_SHARE = 0.2
"""Relative to the height, under the steady design wind."""
SETTLE_S = 5.0
ROUND_COUNT = 5


@dataclass(frozen=True)
class DesignWind:
    """The strongest sampled wind and its steady sway relative to the height."""

    speed_m_s: float
    sway_share: float
    asked_speed_m_s: float


def design_wind(body: Body, speed_m_s: float, height_m: float, dt_s: float, exponent: float) -> DesignWind:
    """The requested speed, reduced until its steady sway in the worse of two directions is acceptable.

    ``exponent`` is the streamlined exponent of the body.
    """
    asked = speed_m_s
    sway = _sway_share(body, speed_m_s, exponent, height_m, dt_s)
    for _ in range(ROUND_COUNT):
        if sway <= MAX_SWAY_SHARE:
            break
        lower = (0.95 * MAX_SWAY_SHARE / min(sway, 4.0)) ** (1.0 / exponent)
        speed_m_s *= max(lower, 0.3)
        sway = _sway_share(body, speed_m_s, exponent, height_m, dt_s)
    return DesignWind(speed_m_s, sway, asked)


def _sway_share(body: Body, speed_m_s: float, exponent: float, height_m: float, dt_s: float) -> float:
    pressure_pa = float(dynamic_pressure(speed_m_s, exponent))
    sides = (np.array([pressure_pa, 0.0]), np.array([0.0, pressure_pa]))
    return max(_steady_sway_m(body, side, round(SETTLE_S / dt_s)) for side in sides) / height_m


def _steady_sway_m(body: Body, pressure_pa: np.ndarray, frames: int) -> float:
    """Largest vertex displacement, averaged over the second half of a steady wind to remove oscillation."""
    body.reset()
    total = np.zeros_like(body.u)
    try:
        for frame in range(frames):
            body.step(pressure_pa * min(1.0, 2.0 * (frame + 1) / frames))
            if 2 * frame >= frames:
                total += body.u
    except FloatingPointError:
        return np.inf
    return float(np.linalg.norm(total, axis=1).max()) / (frames - frames // 2)
