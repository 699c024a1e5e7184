"""Fits the force of the modal model to the motion that it simulates (output-error method).

Least squares along the reference solution (``reduction.modal_fit``) ignores that a wrong force
changes the motion, and with it every later force: such a fit can be good term by term and drift away, or
diverge, when it is stepped. Here the model itself is stepped through all training runs, and the distance of
its motion to theirs is minimised (Ljung, System Identification, 2nd ed. 1999, chapters 3 and 7: simulation
or output-error models). The gradient comes from one backward pass through the steps; the minimiser is
L-BFGS. Its variables are scaled by the normal equations of the open-loop responses, which are nearly those
of the whole problem; tens of iterations are enough.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numba
import numpy as np

from galewood.motion.modal import (
    ModalTensors,
    add_drag,
    add_drag_gradient,
    add_terms_gradient,
    drag_tensors,
    write_force_terms,
)
from galewood.pipeline.reduction.modal_runs import ModalRun
from galewood.pipeline.reduction.oscillators import response
from galewood.pipeline.reduction.run_lanes import Target, side_by_side
from galewood.util import Array, Floats

RIDGE_PENALTY = 1e-2
"""Penalty on the coefficients, relative to the mean of the diagonal of the normal equations."""
PLACE_PENALTY = 100.0
"""Penalty on the corrections of the places' loads over that on the other coefficients.

The loads follow from the field of the gusts; two dozen runs say less about them than about the force.
"""
FIT_ITERATIONS = 100
FIRST_STEP = 1 / 30
"""Length of the first step of the minimiser in its own variables; a longer one can make the model diverge."""
LBFGS_CORRECTIONS = 30
"""Steps that L-BFGS remembers."""


def fitted_force(
    model: ModalTensors,
    starts: Sequence[Floats],
    runs: Sequence[ModalRun],
    tables: Sequence[Floats],
    weights: Floats,
    shapes: Floats,
    dt_s: float,
    *,
    iterations: int = FIT_ITERATIONS,
) -> Floats:
    """(F + 2G, d) force with which the model, stepped from rest, follows the runs best.

    The last rows are added to the loads of the places. Begins with the best of ``starts`` (F + 2G, d), and
    returns another of them if it follows the runs better than the result; the force of ``model`` is not used.
    ``tables`` are the force terms and the gusts at the places (T, F + 2G) along the runs,
    ``weights`` (R,) those of the runs' errors, and ``shapes`` (d, 3n) the displacements of the oscillators:
    the error is measured at the vertices. The minimiser takes ``iterations`` steps at most. A start that
    diverges is left out; if all do, the force is zero.
    """
    import scipy.optimize  # slow to load

    metric = shapes @ shapes.T / (shapes.shape[1] / 3)
    simulation = Simulation(model, side_by_side(model, runs, weights), metric, dt_s)
    scaling = _Scaling(model, tables, weights, np.diag(metric))

    def cost(force: Floats) -> tuple[float, Floats]:
        own, by_force = simulation.cost(force)
        penalty, by_penalty = scaling.penalty(force)
        return own + penalty, by_force + by_penalty

    candidates = [np.ascontiguousarray(start.T, np.float64) for start in starts]
    candidates.append(np.zeros_like(candidates[0]))
    costs = [cost(candidate)[0] for candidate in candidates]
    start, first_cost = candidates[int(np.argmin(costs))], max(min(costs), 1e-300)

    def scaled_cost(variables: Floats) -> tuple[float, Floats]:
        own, by_force = cost(scaling.force(variables))
        return own / first_cost, scaling.by_variables(by_force) / first_cost

    options = {"maxiter": iterations, "maxcor": LBFGS_CORRECTIONS}
    found = scipy.optimize.minimize(
        scaled_cost, scaling.variables(start), jac=True, method="L-BFGS-B", options=options
    )
    candidates.append(scaling.force(np.asarray(found.x, np.float64)))
    best = min(candidates, key=lambda force: simulation.cost(force)[0])
    return np.ascontiguousarray(best.T)


class Simulation:
    """Steps the model through all runs at once, and back for the gradient."""

    def __init__(self, model: ModalTensors, target: Target, metric: Floats, dt_s: float) -> None:
        place_load = model.place_load.reshape(len(model.step), -1)
        tensors = (model.step, model.load, place_load, model.sway, model.limits)
        self._tensors = tuple(np.ascontiguousarray(tensor, np.float64) for tensor in tensors)
        self._drag = drag_tensors(
            model.drag_point, model.drag_shape, model.drag_rest, model.streamlined_exponent
        )
        self._target, self._metric, self._half_s = target, metric, dt_s / 2
        steps, lanes = len(target.pressure_pa), len(target.weight[0])
        d, terms = len(model.step), len(model.force) + place_load.shape[1]
        self._e, self._v = np.zeros((2, steps + 1, d, lanes))
        self._mean_speed, self._terms = np.zeros((steps, d, lanes)), np.zeros((steps, terms, lanes))
        self._terms[:, len(model.force) :] = target.local_pa

    def cost(self, force: Floats) -> tuple[float, Floats]:
        """Half the weighted squared error of the motion under a force (d, F + 2G), and its gradient.

        Infinite, with a zero gradient, if the motion diverges.
        """
        state = (self._e, self._v, self._mean_speed, self._terms)
        wind = (self._target.pressure_pa, self._target.felt_pa, self._target.air_pa)
        arguments: tuple[Any, ...] = (self._tensors, self._half_s, self._drag, wind, force, state)
        with np.errstate(over="ignore", invalid="ignore"):
            _simulate(*arguments)
            gap = self._e - self._target.e
            by_e = np.einsum("kl,tlr->tkr", self._metric, gap) * self._target.weight[:, None]
            cost = 0.5 * float(np.sum(by_e * gap))
        by_force = np.zeros_like(force)
        if not np.isfinite(cost):
            return np.inf, by_force
        backwards: tuple[Any, ...] = (*arguments, by_e, by_force)
        _go_back(*backwards)
        return cost, by_force


class _Scaling:
    """Variables in which the problem is well conditioned, and the penalty on the coefficients.

    The normal matrix of an oscillator is that of the responses to its terms, each term scaled by its root
    mean square.
    """

    def __init__(self, model: ModalTensors, tables: Sequence[Floats], weights: Floats, reach: Floats) -> None:
        step = np.asarray(model.step, np.float64).copy()
        step[:, [0, 3]] += 1.0
        size = np.sqrt(np.mean(np.concatenate(tables) ** 2, axis=0))
        size[size == 0] = 1.0
        self._size, self._roots, self._ridges = size, list[Floats](), np.zeros(len(step))
        self._strict = np.ones(len(size))
        self._strict[len(model.force) :] = PLACE_PENALTY
        for k, oscillator in enumerate(step):
            normal = np.zeros((len(size), len(size)))
            for table, w in zip(tables, weights, strict=True):
                moved = w * response(oscillator, table / size)
                normal += moved.T @ moved * (reach[k] / len(table))
            self._ridges[k] = RIDGE_PENALTY * np.trace(normal) / len(size)
            self._roots.append(
                np.linalg.cholesky(normal + max(self._ridges[k], 1e-300) * np.diag(self._strict))
            )

    def variables(self, force: Floats) -> Floats:
        """Variables of a force (d, F + 2G)."""
        rows = [root.T @ (row * self._size) for root, row in zip(self._roots, force, strict=True)]
        return np.concatenate(rows) / FIRST_STEP

    def force(self, variables: Floats) -> Floats:
        """(d, F + 2G) force of the variables."""
        return (
            self._solved(variables.reshape(len(self._roots), -1) * FIRST_STEP, transposed=True) / self._size
        )

    def by_variables(self, by_force: Floats) -> Floats:
        """Gradient by the variables of a gradient by the force (d, F + 2G)."""
        return self._solved(by_force / self._size, transposed=False).ravel() * FIRST_STEP

    def penalty(self, force: Floats) -> tuple[float, Floats]:
        """Half the squared, scaled coefficients (d, F + 2G) times their ridges, and the gradient."""
        scaled = force * self._size
        pull = self._ridges[:, None] * self._strict * scaled
        return 0.5 * float(np.sum(pull * scaled)), pull * self._size

    def _solved(self, rows: Array, *, transposed: bool) -> Floats:
        from scipy.linalg import solve_triangular  # slow to load

        trans = 1 if transposed else 0
        pairs = zip(self._roots, rows, strict=True)
        return np.stack([solve_triangular(root, row, trans=trans, lower=True) for root, row in pairs])


@numba.njit(cache=True, nogil=True)
def _simulate(tensors, half_s, drag, wind, force, state):  # pragma: no cover  (compiled)
    """The step of `galewood.motion.modal` for all runs; keeps what the way back needs in ``state``.

    e, v (T + 1, d, R), mean_speed (T, d, R): without the drag; terms (T, F + 2G, R), which end with the gusts
    at the places.
    """
    step, load, place_load, sway, limits = tensors
    pressure, felt, air = wind
    e, v, mean_speed, terms = state
    point, inputs, outputs, rest, exponent = drag
    d, lanes = e.shape[1], e.shape[2]
    ahead, pairs = np.empty((d, lanes)), np.empty((3, 2, lanes))
    room, places = np.empty((3 * len(point) + 2, lanes)), terms.shape[1] - place_load.shape[1]
    for t in range(len(pressure)):
        write_force_terms(sway, limits, half_s, e[t], v[t], felt[t], ahead, pairs, terms[t])
        total = np.dot(force, terms[t]) + np.dot(load, pressure[t])
        total += np.dot(place_load, terms[t, places:])
        for k in range(d):
            a, b, _, _, s0, _ = step[k]
            for lane in range(lanes):
                moved = a * e[t, k, lane] + b * v[t, k, lane] + s0 * total[k, lane]
                mean_speed[t, k, lane] = moved * (0.5 / half_s)
        if len(point) > 0:
            add_drag(point, inputs, outputs, rest, exponent, mean_speed[t], air[t], room, total)
        for k in range(d):
            a, b, c, g, s0, s1 = step[k]
            for lane in range(lanes):
                x, y, f = e[t, k, lane], v[t, k, lane], total[k, lane]
                e[t + 1, k, lane] = x + (a * x + b * y + s0 * f)
                v[t + 1, k, lane] = y + (c * x + g * y + s1 * f)


@numba.njit(cache=True, nogil=True)
def _go_back(tensors, half_s, drag, wind, force, state, by_motion, by_force):  # pragma: no cover  (compiled)
    """Add to by_force (d, F + 2G) the gradient of Σ by_motion · e through all steps of ``_simulate``."""
    step, _, _, sway, limits = tensors
    pressure, felt, air = wind
    e, v, mean_speed, terms = state
    point, inputs, outputs, rest, exponent = drag
    d, lanes = e.shape[1], e.shape[2]
    by_e, by_v = np.zeros((d, lanes)), np.zeros((d, lanes))
    by_total, by_speed = np.empty((d, lanes)), np.empty((d, lanes))
    transposed = np.ascontiguousarray(force.T)
    for t in range(len(pressure) - 1, -1, -1):
        by_e += by_motion[t + 1]
        by_speed[:] = 0.0
        for k in range(d):
            for lane in range(lanes):
                by_total[k, lane] = step[k, 4] * by_e[k, lane] + step[k, 5] * by_v[k, lane]
        if len(point) > 0:
            add_drag_gradient(
                point, inputs, outputs, rest, exponent, mean_speed[t], air[t], by_total, by_speed
            )
        for k in range(d):
            a, b, c, g, s0, _ = step[k]
            for lane in range(lanes):
                x, y, moved = by_e[k, lane], by_v[k, lane], by_speed[k, lane] * (0.5 / half_s)
                by_total[k, lane] += s0 * moved
                by_e[k, lane] = x + a * (x + moved) + c * y
                by_v[k, lane] = y + b * (x + moved) + g * y
        by_force += np.dot(by_total, np.ascontiguousarray(terms[t].T))
        add_terms_gradient(
            sway, limits, half_s, e[t], v[t], felt[t], np.dot(transposed, by_total), by_e, by_v
        )
