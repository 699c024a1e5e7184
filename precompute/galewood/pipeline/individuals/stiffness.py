"""Beams against finite elements: by how much the wood of each mode must be stiffer for the same frequency."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from galewood.solid.fem import remaining_share
from galewood.solid.model import BeamModel
from galewood.util import Floats

STIFFNESS_RANGE = (0.05, 20.0)
HALVING_COUNT = 60


def loaded_hz(model: BeamModel, factors: Floats) -> Floats:
    """(k,) frequencies of the beams under their weight, with the wood of each mode so many times as stiff."""
    loads = (model.load_factors / factors).tolist()
    return model.weightless_hz * np.sqrt(factors * np.array([remaining_share(load) for load in loads]))


def stiffness_factors(model: BeamModel, frequencies_hz: Sequence[float]) -> Floats:
    """(n,) factors of the stiffness with which the first modes of the beams have these frequencies.

    The weight takes a smaller share of a stiffer mode, so the factors are sought with it (by halving).
    """
    count = min(len(frequencies_hz), len(model.weightless_hz))
    wanted = np.asarray(frequencies_hz[:count], np.float64)
    low, high = (np.full(len(model.weightless_hz), bound) for bound in STIFFNESS_RANGE)
    for _ in range(HALVING_COUNT):
        middle = np.sqrt(low * high)
        below = loaded_hz(model, middle)[:count] < wanted
        low[:count] = np.where(below, middle[:count], low[:count])
        high[:count] = np.where(below, high[:count], middle[:count])
    return np.sqrt(low * high)[:count]


def of_all_modes(factors: Floats, count: int) -> Floats:
    """(count,) the factors of the first modes; all further ones have the geometric mean of the last half."""
    further = float(np.exp(np.log(factors[len(factors) // 2 :]).mean()))
    return np.concatenate([factors, np.full(max(count - len(factors), 0), further)])[:count]
