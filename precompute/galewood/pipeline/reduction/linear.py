"""The modal model that needs no simulation: natural modes, their damping and wind loads, linear pose.

It is exact for small sway. What it leaves out is what the other model is fitted to: the change of stiffness,
damping and wind load with the sway, and the curved paths of branches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from galewood.motion.modal import ModalTensors, force_terms, shape_terms
from galewood.pipeline.reduction.drag_points import drag_points
from galewood.pipeline.reduction.modal_runs import ModalRun, sampled_range, sway_coordinates, typical_speed
from galewood.pipeline.reduction.oscillators import (
    CrownWind,
    Oscillators,
    felt_wind,
    leading_oscillators,
    propagators,
    response,
)
from galewood.pipeline.reduction.pod import Subspace, spanned_by
from galewood.pipeline.reduction.tensors import modal_tensors
from galewood.pipeline.reduction.training import STANDARD_SIZE
from galewood.pipeline.sampling import SampleWind
from galewood.solid.fem import FemSettings
from galewood.util import Floats


@dataclass(frozen=True)
class LinearMotion:
    """A linear modal model, its output modes, and its motion under the given winds."""

    modal: ModalTensors
    subspace: Subspace
    q: list[Floats]
    """(T + 1, r) output modes under each wind."""


def linear_motion(
    body: Oscillators, mass_kg: Floats, winds: Sequence[SampleWind], settings: FemSettings
) -> LinearMotion:
    """The linear model of a body, and its motion under some winds.

    ``mass_kg`` (n,) are the masses of the vertices of the shapes.
    """
    size, dt_s = STANDARD_SIZE, settings.dt_s
    own = leading_oscillators(body, settings, size.natural, size.dynamic)
    subspace = spanned_by(own.shapes, mass_kg)
    step = propagators(own.omega, np.diag(own.damping), settings)
    felt = [felt_wind(wind.pressure_pa, wind.gusts, own.places.place_m, dt_s) for wind in winds]
    runs = [_linear_run(own, step, subspace.scale, wind, dt_s) for wind in felt]
    sway = sway_coordinates(own, runs)
    limits = sampled_range(sway, runs, 0)
    d = len(own.omega)
    none = np.zeros((force_terms(0), d)), np.zeros((d + 2 + shape_terms(0), 0))
    drag = drag_points(own, typical_speed(runs))
    modal = modal_tensors(
        own, step, drag, sway=sway, force=none[0], shown=subspace.scale, pose=none[1], limits=limits
    )
    return LinearMotion(modal, subspace, [run.q for run in runs])


def _linear_run(own: Oscillators, step: Floats, shown: Floats, wind: CrownWind, dt_s: float) -> ModalRun:
    force = own.force(wind)
    e = np.concatenate([response(row, force[:, k : k + 1]) for k, row in enumerate(step)], axis=1)
    return ModalRun(wind, e, np.gradient(e, dt_s, axis=0), e * shown)
