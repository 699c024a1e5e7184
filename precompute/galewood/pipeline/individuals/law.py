"""The nonlinear force on the sway of a tree, without dimensions and without a direction of its own.

The polynomial that was fitted to a tree of a species depends on that tree's own boughs: on which side they
grow. What it has in common with another tree is the part that is the same in all directions. It has few
terms (``isotropic``), whose coefficients follow from the polynomial by least squares over all directions.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from galewood.motion.modal import force_terms, write_force_terms
from galewood.pipeline.individuals.sway import Sway, sway_of_table
from galewood.table import Table
from galewood.util import Floats

DRAWN_COUNT = 500
"""Random states at which polynomials are compared, each in eight directions: enough for 92 coefficients."""


@dataclass(frozen=True)
class SwayStates:
    """Random states of a sway, each (n, 2) along x and z in its own units: sway, speed and pressure."""

    sway: Floats
    speed: Floats
    pressure: Floats


Law = Callable[[SwayStates], Floats]
"""The acceleration (n, 2) of the sway, in its own units, that a linear tree would not have."""


def sampled_states(speed: float, pressure: float, seed: int = 0) -> SwayStates:
    """States in all directions: sways up to 1, speeds and pressures up to these.

    Each comes eight times, turned by right angles and mirrored, so that no direction outweighs another.
    """
    rng = np.random.default_rng(seed)

    def disc(radius: float) -> Floats:
        angle = rng.uniform(0, 2 * np.pi, DRAWN_COUNT)
        size = radius * np.sqrt(rng.uniform(0, 1, DRAWN_COUNT))
        drawn = np.column_stack([size * np.cos(angle), size * np.sin(angle)])
        quarter, mirror = np.array([[0.0, 1.0], [-1.0, 0.0]]), np.diag([1.0, -1.0])
        turns = [np.linalg.matrix_power(quarter, k) @ side for k in range(4) for side in (np.eye(2), mirror)]
        return np.concatenate([drawn @ turn for turn in turns])

    return SwayStates(disc(1.0), disc(speed), disc(pressure))


def isotropic(states: SwayStates) -> Floats:
    """(7, n, 2) the forces up to degree 3 (and pressure times degree 2) that have no direction of their own.

    Stiffness; inertia of the curved path (2); damping (2); load on the bent tree (2). Terms of even degree
    are not among them: turned by half a turn they would push the other way.
    """
    s, w, p = states.sway, states.speed, states.pressure

    def dot(a: Floats, b: Floats) -> Floats:
        return (a * b).sum(axis=1, keepdims=True)

    return np.stack(
        [
            dot(s, s) * s,
            dot(w, w) * s,
            dot(s, w) * w,
            dot(s, s) * w,
            dot(s, w) * s,
            dot(s, s) * p,
            dot(s, p) * s,
        ]
    )


def isotropic_law(coefficients: Floats) -> Law:
    """The law of these coefficients (7,)."""
    return lambda states: np.tensordot(coefficients, isotropic(states), axes=1)


def law_of_table(table: Table) -> Law:
    """The polynomial of a fitted table, in the units of its sway, with the directions of that tree."""
    own, limits = sway_of_table(table), table.modal_limits.astype(np.float64)
    force = table.modal_force.astype(np.float64)

    def law(states: SwayStates) -> Floats:
        terms = _terms(own, limits, states)
        return (own.rows @ (force.T @ terms)).T @ own.turn / own.omega**2

    return law


def isotropic_part(law: Law, states: SwayStates) -> Floats:
    """(7,) coefficients of the isotropic law that is nearest to a law over these states."""
    basis = isotropic(states).reshape(7, -1)
    return np.asarray(np.linalg.lstsq(basis.T, law(states).ravel(), rcond=None)[0], np.float64)


def force_of_law(law: Law, own: Sway, limits: Floats, states: SwayStates) -> Floats:
    """(F, d) coefficients of the force of a model that follows a law.

    Its ``limits`` (3,) have no coupled coordinates.
    """
    terms = _terms(own, limits, states)
    wanted = law(states) @ own.turn.T * own.omega**2
    coefficients = np.linalg.lstsq(terms.T, wanted, rcond=None)[0]
    return coefficients @ own.spread.T


def _terms(own: Sway, limits: Floats, states: SwayStates) -> Floats:
    """(F, n) force terms of a model in states of its sway."""
    e = np.ascontiguousarray(own.spread @ (own.turn @ states.sway.T))
    v = np.ascontiguousarray(own.spread @ (own.turn @ states.speed.T) * own.omega)
    pressure_pa = np.ascontiguousarray(states.pressure.T * own.unit_pa)
    n, coupled = len(states.sway), (len(limits) - 3) // 2
    terms = np.empty((force_terms(coupled), n))
    write_force_terms(own.rows, limits, 0.0, e, v, pressure_pa, np.empty_like(e), np.empty((3, 2, n)), terms)
    return terms
