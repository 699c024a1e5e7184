"""Strength of the training winds: the speed at which the linear model, with drag, sways as far as required.

The range of a table is thus a sway, not a wind speed: a stiff tree is trained in storms, a slender one in
moderate winds. The prediction is within a few per cent of the sway that the finite elements then reach.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from galewood.pipeline.reduction.linear import linear_motion
from galewood.pipeline.reduction.oscillators import Oscillators
from galewood.pipeline.reduction.training_error import simulated_q
from galewood.pipeline.sampling import (
    GUST_WIND_COUNT,
    STRONGEST_M_S,
    WIND_COUNT,
    SampleWind,
    WindShape,
    gust_shapes,
    training_shapes,
)
from galewood.solid.fem import FemSettings
from galewood.util import Floats

WEAKEST_M_S = 0.5
HALVING_COUNT = 10
FAR_VERTICES = 64
"""Vertices that sway farthest; the sway of a wind is that of the farthest of them."""


def training_winds(
    body: Oscillators, mass_kg: Floats, height_m: float, settings: FemSettings, seed: int
) -> list[SampleWind]:
    """The training winds of a body, whose vertices have the masses (n,) kg."""
    first_hz = float(body.omega[0]) / (2 * np.pi)
    exponent = body.exposure.streamlined_exponent
    shapes = training_shapes(first_hz, settings.dt_s, exponent, seed=seed, count=WIND_COUNT)
    if body.places.count:
        shapes += gust_shapes(settings.dt_s, exponent, seed=seed, count=GUST_WIND_COUNT)
    speeds = speeds_for(shapes, body, mass_kg, height_m, settings)
    return [shape.at(speed) for shape, speed in zip(shapes, speeds.tolist(), strict=True)]


def speeds_for(
    shapes: Sequence[WindShape], body: Oscillators, mass_kg: Floats, height_m: float, settings: FemSettings
) -> Floats:
    """(k,) peak speed, m/s, at which each wind causes its sway; rounded, so that runs can be found again."""
    motion = linear_motion(body, mass_kg, [shape.at(STRONGEST_M_S / 4) for shape in shapes], settings)
    basis = _farthest(motion.subspace.basis.reshape(-1, 3, motion.subspace.modes))
    low, high = np.full(len(shapes), WEAKEST_M_S), np.full(len(shapes), STRONGEST_M_S)
    for _ in range(HALVING_COUNT):
        middle = np.sqrt(low * high)
        tried = list(zip(shapes, middle.tolist(), strict=True))
        most_m = np.array([shape.most_sway_share(speed) * height_m for shape, speed in tried])
        winds = [(shape.pressure_pa(speed), shape.gusts) for shape, speed in tried]
        sways = np.array([_sway_m(basis, q) for q in simulated_q(motion.modal, winds, settings.dt_s)])
        low, high = np.where(sways <= most_m, middle, low), np.where(sways > most_m, middle, high)
    return np.asarray(np.round(np.sqrt(low * high), 2), np.float64)


def _farthest(basis: Floats) -> Floats:
    reach = np.square(basis[:, :, :2]).sum(axis=(1, 2))
    return basis[np.argsort(-reach, kind="stable")[:FAR_VERTICES]]


def _sway_m(basis: Floats, q: Floats) -> float:
    squared = np.square(q @ basis.reshape(-1, basis.shape[2]).T).reshape(len(q), -1, 3)
    # a sum over the last axis of length 3 would take several times as long
    return float(np.sqrt((squared[..., 0] + squared[..., 1] + squared[..., 2]).max()))
