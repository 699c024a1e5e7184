"""Fits the modal model to training runs (FEM): its nonlinear force and its pose.

The force is fitted twice. First by linear least squares: each term, evaluated along the reference solution,
drives its oscillator, and the sum of the responses must equal the error of the linear step. That is exact for
terms that do not change the motion they are evaluated on. From there the simulated motion itself is fitted
(``galewood.pipeline.reduction.output_error``). The last terms are the gusts at the places of the crown; their
coefficients correct the loads of the places.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from galewood.motion.modal import (
    ModalTensors,
    add_drag,
    coupled_of,
    drag_tensors,
    force_terms,
    mean_gust,
    shape_terms,
    write_force_terms,
    write_pose_terms,
)
from galewood.pipeline.reduction.drag_points import DragPoints, drag_points
from galewood.pipeline.reduction.modal_runs import (
    ModalRun,
    RunLike,
    modal_run,
    run_weights,
    sampled_range,
    sway_coordinates,
    typical_speed,
)
from galewood.pipeline.reduction.oscillators import Oscillators, propagators, response
from galewood.pipeline.reduction.output_error import FIT_ITERATIONS, fitted_force
from galewood.pipeline.reduction.pod import Subspace
from galewood.pipeline.reduction.tensors import modal_tensors, single
from galewood.solid.fem import FemSettings
from galewood.util import Floats

START_RIDGES = (0.3, 0.02, 1e-4)
"""Ridge parameters of the first fits, relative to the mean square of each term.

Terms that are alike along the runs get large coefficients of opposite sign if it is small, which can be
unstable elsewhere; a large one misses part of the force. The second fit starts from the better one.
"""
POSE_RIDGE = 1e-6


def fit_modal_model(
    ritz: Oscillators,
    mass_kg: Floats,
    runs: Sequence[RunLike],
    subspace: Subspace,
    settings: FemSettings,
    *,
    coupled: int = 4,
    iterations: int = FIT_ITERATIONS,
) -> ModalTensors:
    """Fit the modal model to the oscillators of a tree (``leading_oscillators``) and its runs.

    The output modes are those of ``subspace``, which begins with the shapes of the oscillators. ``coupled``
    coordinates after the first two (at most all) interact with the sway. ``iterations``: of ``fitted_force``.
    """
    modal = [modal_run(run, ritz, mass_kg, subspace, settings.dt_s) for run in runs]
    step = propagators(ritz.omega, np.diag(ritz.damping), settings)
    sway = sway_coordinates(ritz, modal)
    limits = sampled_range(sway, modal, min(coupled, len(ritz.omega) - 2))
    weights = run_weights(sway, modal)
    drag = drag_points(ritz, typical_speed(modal))
    linear, mean = _Linear(step, ritz, drag), mean_gust(drag.point, drag.place)
    tables = [force_table(run, sway, limits, mean, settings.dt_s / 2) for run in modal]
    count = force_terms(coupled_of(limits))
    starts = _first_forces(modal, [table[:, :count] for table in tables], weights, linear, settings.dt_s)
    starts = np.pad(starts, ((0, 0), (0, tables[0].shape[1] - count), (0, 0)))
    shown, pose = subspace.scale[: len(step)], _fit_pose(modal, weights, sway, limits, mean)
    first = modal_tensors(
        ritz, step, drag, sway=sway, force=starts[0][:count], shown=shown, pose=pose, limits=limits
    )
    force = fitted_force(
        first, list(starts), modal, tables, weights, ritz.shapes, settings.dt_s, iterations=iterations
    )
    corrected = ritz.place_load + force[count:].T.reshape(ritz.place_load.shape)
    return replace(first, force=single(force[:count]), place_load=single(corrected))


def force_table(run: ModalRun, sway: Floats, limits: Floats, mean: Floats, half_s: float) -> Floats:
    """(T, F + 2G) force terms at the start of every step, then the gusts at the places along x and along z.

    The frames of the run take the place of the trees. ``mean`` (G,): ``mean_gust``.
    """
    felt_pa = run.felt_pa(mean)
    frames = len(felt_pa)
    e, v, felt = (np.ascontiguousarray(rows[:frames].T) for rows in (run.e, run.v, felt_pa))
    terms = np.empty((force_terms(coupled_of(limits)), frames))
    write_force_terms(sway, limits, half_s, e, v, felt, np.empty_like(e), np.empty((3, 2, frames)), terms)
    return np.concatenate([terms.T, run.wind.local_pa.reshape(frames, -1)], axis=1)


def _pose_table(run: ModalRun, sway: Floats, limits: Floats, mean: Floats) -> Floats:
    """(T + 1, terms) pose terms of every state, with the wind of the step that led to it."""
    e = np.ascontiguousarray(run.e.T)
    pressure = np.concatenate([np.zeros((1, 2)), run.felt_pa(mean)]).T.copy()
    terms, pair = np.empty((len(e) + 2 + shape_terms(coupled_of(limits)), e.shape[1])), sway @ e
    write_pose_terms(limits, e, pressure, pair, terms)
    return terms.T


@dataclass(frozen=True)
class _Linear:
    """What is known before the fit: the oscillators, their steps (d, 6), and the drag."""

    step: Floats
    ritz: Oscillators
    drag: DragPoints

    def motion(self, run: ModalRun, dt_s: float) -> Floats:
        """(T + 1, d) motion under the load of a run's wind and the drag at its speeds."""
        force = self.ritz.force(run.wind) + drag_along(run, self.drag, dt_s)
        return np.concatenate([response(row, force[:, k : k + 1]) for k, row in enumerate(self.step)], axis=1)


def drag_along(run: ModalRun, drag: DragPoints, dt_s: float) -> Floats:
    """(T, d) modal force of the drag along a run, at the mean speed of each step; without its steady part."""
    speed = np.ascontiguousarray(np.diff(run.e, axis=0).T / dt_s)
    force = np.zeros_like(speed)
    if len(drag.point):
        room = np.zeros((3 * len(drag.point) + 2, speed.shape[1]))
        tensors = drag_tensors(drag.point, drag.shape, drag.rest, drag.streamlined_exponent)
        add_drag(*tensors, speed, np.ascontiguousarray(run.air_pa(drag.place).T), room, force)
    return force.T


def _first_forces(
    runs: Sequence[ModalRun], tables: Sequence[Floats], weights: Floats, linear: _Linear, dt_s: float
) -> Floats:
    """(ridges, F, d) coefficients of the force, fitted to the error of each oscillator's linear step."""
    forces = np.empty((len(START_RIDGES), tables[0].shape[1], len(linear.step)))
    known = [linear.motion(run, dt_s) for run in runs]
    for k, oscillator in enumerate(linear.step):
        moved = np.concatenate([w * response(oscillator, t) for w, t in zip(weights, tables, strict=True)])
        missed = np.concatenate(
            [w * (run.e[:, k] - own[:, k]) for w, run, own in zip(weights, runs, known, strict=True)]
        )
        forces[:, :, k] = ridge_fits(moved, missed[:, None], START_RIDGES)[:, :, 0]
    return forces


def _fit_pose(
    runs: Sequence[ModalRun], weights: Floats, sway: Floats, limits: Floats, mean: Floats
) -> Floats:
    """(terms, r − d) coefficients of the output modes that are not shapes of oscillators."""
    terms = np.concatenate(
        [w * _pose_table(run, sway, limits, mean) for w, run in zip(weights, runs, strict=True)]
    )
    further = np.concatenate([w * run.q[:, sway.shape[1] :] for w, run in zip(weights, runs, strict=True)])
    return ridge_fit(terms, further, POSE_RIDGE)


def ridge_fit(terms: Floats, target: Floats, ridge: float) -> Floats:
    """(F, m) ridge regression of targets (T, m) on terms (T, F), each term scaled by its root mean square."""
    return np.asarray(ridge_fits(terms, target, [ridge])[0], np.float64)


def ridge_fits(terms: Floats, target: Floats, ridges: Sequence[float]) -> Floats:
    """(ridges, F, m) regressions as in ``ridge_fit``."""
    size = np.sqrt(np.mean(terms**2, axis=0))
    size[size == 0] = 1.0
    scaled = terms / size
    normal, side = scaled.T @ scaled / len(terms), scaled.T @ target / len(terms)
    eye = np.eye(len(size))
    return np.stack([np.linalg.solve(normal + ridge * eye, side) / size[:, None] for ridge in ridges])
