"""Fits the modal model to training runs (FEM): its nonlinear force and its pose.

The force is a linear least-squares fit of motions, not of one-step residuals: each term, evaluated along the
reference solution, drives its oscillator, and the sum of the responses must equal the error of the linear
step. The effect of a term on the frequency and damping of a mode is thus weighted by its effect on the sway.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from galewood.fem import FemSettings
from galewood.modal import (
    ModalTensors,
    add_drag,
    coupled_of,
    drag_tensors,
    force_terms,
    shape_terms,
    write_force_terms,
    write_pose_terms,
)
from galewood.reduction.drag_points import DragPoints, drag_points
from galewood.reduction.oscillators import Oscillators, propagators, response
from galewood.reduction.pod import Subspace
from galewood.util import Array, Floats

FORCE_RIDGES = (0.3, 0.02, 1e-4)
"""Ridge parameters of the force to choose from, relative to the mean square of each term.

Terms that are alike along the runs get large coefficients of opposite sign if the ridge is small, which can
be unstable elsewhere; a large ridge misses part of the force (docs/design/0005-drift-free-motion.md). Which
is better depends on the tree: the training error decides.
"""
POSE_RIDGE = 1e-7
LIGHT_SHARE = 0.05
"""Lower bound of a run's sway in its weight, over the largest sway of all runs."""


class RunLike(Protocol):
    """A training run from rest: displacement (T + 1, n, 3), m, under the pressure (T, 2), Pa.

    Runs are read one after the other, each array once, so that they need not all be in memory.
    """

    @property
    def pressure_pa(self) -> Array: ...
    @property
    def displacement_m(self) -> Array: ...


@dataclass(frozen=True)
class Run:
    """A run in memory."""

    pressure_pa: Array
    displacement_m: Array


@dataclass(frozen=True)
class ModalRun:
    """A run in modal coordinates: e, v (T + 1, d), pressure (T, 2), Pa, and output modes q (T + 1, r)."""

    pressure: Floats
    e: Floats
    v: Floats
    q: Floats


def fit_modal_model(
    ritz: Oscillators,
    mass_kg: Floats,
    runs: Sequence[RunLike],
    subspace: Subspace,
    settings: FemSettings,
    *,
    coupled: int = 4,
    force_ridges: Sequence[float] = FORCE_RIDGES,
) -> list[ModalTensors]:
    """Fit the modal model to the oscillators of a tree (``leading_oscillators``) and its runs, per ridge.

    The output modes are those of ``subspace``, which begins with the shapes of the oscillators. ``coupled``
    coordinates after the first two (at most all) interact with the sway.
    """
    modal = [modal_run(run, ritz, mass_kg, subspace, settings.dt_s) for run in runs]
    step = propagators(ritz.omega, np.diag(ritz.damping), settings)
    sway = sway_coordinates(ritz, modal)
    limits = sampled_range(sway, modal, min(coupled, len(ritz.omega) - 2))
    weights = run_weights(sway, modal)
    drag = drag_points(ritz, typical_speed(modal))
    linear = _Linear(step, ritz.load, drag)
    forces = _fit_force(modal, weights, linear, sway, limits, settings.dt_s, force_ridges)
    shown, pose = subspace.scale[: len(step)], _fit_pose(modal, weights, sway, limits)
    step[:, [0, 3]] -= 1.0
    others = (shown, pose, limits, drag.point, drag.shape, drag.rest)
    return [_single((step, ritz.load, sway, force, *others)) for force in forces]


def _single(tensors: Sequence[Array]) -> ModalTensors:
    return ModalTensors(*(np.ascontiguousarray(tensor, np.float32) for tensor in tensors))


def modal_run(run: RunLike, ritz: Oscillators, mass_kg: Floats, subspace: Subspace, dt_s: float) -> ModalRun:
    """Project a run on the oscillators, mass-weighted; velocities by central differences."""
    u = np.asarray(run.displacement_m, np.float64)
    u = u.reshape(len(u), -1)
    weighted = ritz.shapes * np.repeat(mass_kg, 3)
    e: Floats = np.linalg.solve(weighted @ ritz.shapes.T, weighted @ u.T).T.astype(np.float64)
    v: Floats = np.zeros(e.shape)
    v[1:-1] = (e[2:] - e[:-2]) / (2 * dt_s)
    v[-1] = (e[-1] - e[-2]) / dt_s
    return ModalRun(np.asarray(run.pressure_pa, np.float64), e, v, u @ subspace.dual.T)


def sway_coordinates(ritz: Oscillators, runs: Sequence[ModalRun]) -> Floats:
    """(2, d) the two directions of largest motion, m, scaled to 1 at the largest sampled sway."""
    reach = np.sqrt((ritz.shapes.reshape(len(ritz.omega), -1, 3) ** 2).sum(axis=2).max(axis=1))
    motion = np.concatenate([run.e for run in runs])
    _, vectors = np.linalg.eigh((motion * reach).T @ (motion * reach))
    sway = (vectors[:, ::-1][:, :2] * reach[:, None]).T
    largest = np.sqrt(((motion @ sway.T) ** 2).sum(axis=1).max())
    return sway / max(largest, 1e-12)


def sampled_range(sway: Floats, runs: Sequence[ModalRun], coupled: int) -> Floats:
    """(3 + 2c,) largest sway, sway speed, pressure, coupled coordinates and their speeds; never zero."""
    e = np.concatenate([run.e for run in runs])
    v = np.concatenate([run.v for run in runs])
    pressure = np.concatenate([run.pressure for run in runs])
    sizes = [np.linalg.norm(rows, axis=1).max() for rows in (e @ sway.T, v @ sway.T, pressure)]
    beside = slice(2, 2 + coupled)
    return np.maximum([*sizes, *np.abs(e[:, beside]).max(axis=0), *np.abs(v[:, beside]).max(axis=0)], 1e-9)


def run_weights(sway: Floats, runs: Sequence[ModalRun]) -> Floats:
    """(R,) weight of the rows of each run: 1 / (largest sway)², mean 1.

    Nonlinear effects grow with the square and cube of the sway. Without weights the strongest runs would
    dominate, with effects that no term of the model can represent.
    """
    farthest = [np.linalg.norm(run.e @ sway.T, axis=1).max() for run in runs]
    weights = np.maximum(farthest, LIGHT_SHARE) ** -2.0
    return weights / weights.mean()


def _force_table(run: ModalRun, sway: Floats, limits: Floats, half_s: float) -> Floats:
    """(T, F) force terms at the start of every step; the frames of the run take the place of the trees."""
    frames = len(run.pressure)
    e, v, pressure = (np.ascontiguousarray(rows[:frames].T) for rows in (run.e, run.v, run.pressure))
    terms = np.empty((force_terms(coupled_of(limits)), frames))
    write_force_terms(sway, limits, half_s, e, v, pressure, np.empty_like(e), np.empty((3, 2, frames)), terms)
    return terms.T


def _pose_table(run: ModalRun, sway: Floats, limits: Floats) -> Floats:
    """(T + 1, terms) pose terms of every state, with the pressure of the step that led to it."""
    e = np.ascontiguousarray(run.e.T)
    pressure = np.concatenate([np.zeros((1, 2)), run.pressure]).T.copy()
    terms, pair = np.empty((len(e) + 2 + shape_terms(coupled_of(limits)), e.shape[1])), sway @ e
    write_pose_terms(limits, e, pressure, pair, terms)
    return terms.T


@dataclass(frozen=True)
class _Linear:
    """What is known before the fit: the oscillators' steps (d, 6), the load (d, 2) and the drag."""

    step: Floats
    load: Floats
    drag: DragPoints

    def motion(self, run: ModalRun, dt_s: float) -> Floats:
        """(T + 1, d) motion under the load of a run's wind and the drag at its speeds."""
        force = run.pressure @ self.load.T + drag_along(run, self.drag, dt_s)
        return np.concatenate([response(row, force[:, k : k + 1]) for k, row in enumerate(self.step)], axis=1)


def drag_along(run: ModalRun, drag: DragPoints, dt_s: float) -> Floats:
    """(T, d) modal force of the drag along a run, at the mean speed of each step; without its steady part."""
    speed = np.ascontiguousarray(np.diff(run.e, axis=0).T / dt_s)
    force = np.zeros_like(speed)
    if len(drag.point):
        room = np.zeros((3 * len(drag.point) + 3, speed.shape[1]))
        tensors = drag_tensors(drag.point, drag.shape, drag.rest)
        add_drag(*tensors, speed, np.ascontiguousarray(run.pressure.T), room, force)
    return force.T


def typical_speed(runs: Sequence[ModalRun]) -> Floats:
    """(d,) root mean square of the speed of each oscillator."""
    return np.sqrt(np.mean(np.concatenate([run.v for run in runs]) ** 2, axis=0))


def _fit_force(
    runs: Sequence[ModalRun],
    weights: Floats,
    linear: _Linear,
    sway: Floats,
    limits: Floats,
    dt_s: float,
    ridges: Sequence[float],
) -> Floats:
    """(ridges, F, d) coefficients of the force, fitted to the error of each oscillator's linear step."""
    terms = [_force_table(run, sway, limits, dt_s / 2) for run in runs]
    force = np.empty((len(ridges), terms[0].shape[1], len(linear.step)))
    known = [linear.motion(run, dt_s) for run in runs]
    for k, oscillator in enumerate(linear.step):
        moved = np.concatenate([w * response(oscillator, t) for w, t in zip(weights, terms, strict=True)])
        missed = np.concatenate(
            [w * (run.e[:, k] - own[:, k]) for w, run, own in zip(weights, runs, known, strict=True)]
        )
        force[:, :, k] = ridge_fits(moved, missed[:, None], ridges)[:, :, 0]
    return force


def _fit_pose(runs: Sequence[ModalRun], weights: Floats, sway: Floats, limits: Floats) -> Floats:
    """(terms, r − d) coefficients of the output modes that are not shapes of oscillators."""
    terms = np.concatenate([w * _pose_table(run, sway, limits) for w, run in zip(weights, runs, strict=True)])
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
