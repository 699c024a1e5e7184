"""Fits the stiffness and the damping of a tree's wood to a record of its own motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from galewood.check.sway.analysis import SwayAnalysis
from galewood.check.sway.predicted import PredictedSway, predicted_sway
from galewood.solid.fem import FemModel
from galewood.wood import Wood

FREQUENCY_TOLERANCE = 2e-3
MOST_MODELS = 6
LARGEST_STEP = 4.0
"""Largest change of the modulus from one model to the next."""
YOUNG_LIMITS_PA = (1e8, 5e10)
DAMPING_LIMITS = (0.002, 0.5)


@dataclass(frozen=True)
class Calibration:
    """Wood that gives the frequency and the damping of a record, and what was predicted without and with it.

    reached: whether the frequency agrees within 0.2 %.
    """

    wood: Wood
    given: Wood
    before: PredictedSway
    after: PredictedSway
    reached: bool
    record_damping_ratio: float

    def figures(self) -> dict[str, Any]:
        """What changed, and both predictions; JSON-able."""
        return {
            "young_longitudinal_pa": self.wood.young_longitudinal_pa,
            "young_factor": self.wood.young_longitudinal_pa / self.given.young_longitudinal_pa,
            "wood_damping_ratio": self.wood.damping_ratio,
            "given_wood_damping_ratio": self.given.damping_ratio,
            "without": self.before.figures(),
            "with": self.after.figures(),
            "reached": self.reached,
            "record_damping_ratio": self.record_damping_ratio,
        }


def calibrated(
    analysis: SwayAnalysis,
    wood: Wood,
    model_of: Callable[[Wood], FemModel],
    on_progress: Callable[[float], None] = lambda share: None,
) -> Calibration:
    """Fit E to the frequency along the first principal axis, and the wood's damping to what drag leaves.

    ``model_of`` builds the tree's model with a wood; it is called up to six times. Without a measured wind
    all of the damping is taken for the wood's. Raises ValueError if the record has no resonance.
    """
    resonance = analysis.along.resonance
    if resonance is None:
        raise ValueError("; ".join(analysis.along.notes) or "the record has no resonance")
    wind = analysis.record.wind_m_s
    measured_hz = resonance.frequency_hz
    tried: list[tuple[float, float]] = []
    now, before = wood, None
    while True:
        found = predicted_sway(model_of(now), wind)
        before = before or found
        tried.append((now.young_longitudinal_pa, found.frequency_hz))
        on_progress(len(tried) / (MOST_MODELS + 1))
        reached = abs(found.frequency_hz / measured_hz - 1) <= FREQUENCY_TOLERANCE
        if reached or len(tried) == MOST_MODELS:
            break
        now = replace(now, young_longitudinal_pa=_next_young_pa(tried, measured_hz))
    low, high = DAMPING_LIMITS
    # the ratio of the wood holds at the first frequency; other modes follow from Rayleigh's rule
    at_mode = found.wood_damping_ratio / now.damping_ratio
    ratio = float(np.clip((resonance.damping_ratio - found.drag_damping_ratio) / at_mode, low, high))
    after = replace(found, wood_damping_ratio=ratio * at_mode)
    return Calibration(
        replace(now, damping_ratio=ratio), wood, before, after, reached, resonance.damping_ratio
    )


def _next_young_pa(tried: list[tuple[float, float]], measured_hz: float) -> float:
    """The modulus at which the square of the frequency, a line in it, reaches the measured one."""
    young, frequency = tried[-1]
    if len(tried) == 1 or tried[-2][0] == young:
        wanted = young * (measured_hz / frequency) ** 2
    else:
        earlier, earlier_hz = tried[-2]
        slope = (frequency**2 - earlier_hz**2) / (young - earlier)
        wanted = young + (measured_hz**2 - frequency**2) / slope if slope > 0 else young * 1.1
    return float(np.clip(np.clip(wanted, young / LARGEST_STEP, young * LARGEST_STEP), *YOUNG_LIMITS_PA))
