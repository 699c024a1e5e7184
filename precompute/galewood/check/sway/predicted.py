"""Frequency and damping that the finite-element model of a tree predicts for its sway in wind."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from galewood.check.sway.sway_mode import SwayMode, main_sway_mode
from galewood.motion.wind import dynamic_pressure
from galewood.solid.fem import FemModel, rayleigh_ratio
from galewood.util import Floats

WIND_QUANTILES = 9
"""Winds of a record at which the damping by drag is computed; it grows nearly in proportion to the wind."""


@dataclass(frozen=True)
class PredictedSway:
    """Main sway mode of a model in a wind; damping_ratio is that of the wood and of the drag together."""

    frequency_hz: float
    lowest_hz: float
    mass_share: float
    wood_damping_ratio: float
    drag_damping_ratio: float

    @property
    def damping_ratio(self) -> float:
        """Damping ratio of a small sway along the wind."""
        return self.wood_damping_ratio + self.drag_damping_ratio

    def figures(self) -> dict[str, Any]:
        """All figures; JSON-able."""
        return {**asdict(self), "damping_ratio": self.damping_ratio}


def predicted_sway(model: FemModel, wind_m_s: Floats | None = None) -> PredictedSway:
    """What the model predicts for a small sway along the wind, whose speeds at the top are given (n,).

    Drag damps in proportion to the wind: its damping is the mean over the winds; without any it is zero.
    """
    mode = main_sway_mode(model)
    omega = 2 * np.pi * mode.frequency_hz
    return PredictedSway(
        mode.frequency_hz,
        mode.lowest_hz,
        mode.mass_share,
        rayleigh_ratio(model.alpha, model.beta, omega),
        _drag_damping(model, mode, wind_m_s, omega),
    )


def _drag_damping(model: FemModel, mode: SwayMode, wind_m_s: Floats | None, omega: float) -> float:
    """Σ φᵀ C φ / (2 ω), with the derivative C of the drag by the velocity and φ of modal mass 1."""
    speeds = np.zeros(0) if wind_m_s is None else wind_m_s[np.isfinite(wind_m_s)]
    if not len(speeds):
        return 0.0
    drag, still = model.drag(), np.zeros_like(model.nodes_m)
    found = list[float]()
    for speed in np.quantile(speeds, (np.arange(WIND_QUANTILES) + 0.5) / WIND_QUANTILES):
        pressure = float(dynamic_pressure(speed, model.streamlined_exponent)) * np.array(mode.direction)
        per_node = drag.at(still, pressure).damping.reshape(-1, 3, 3)
        found.append(float(np.einsum("ni,nij,nj->", mode.shape, per_node, mode.shape)) / (2 * omega))
    return float(np.mean(found))
