"""Stiffness of the hinges of a rigid tree: beam theory first, then a fit to the finite elements.

Unknown are the logarithms of the stiffnesses. The residuals are the relative errors of the response of every
section of the wood to forces on it, of the response of all sections to the inertia of each natural mode, of
the lowest frequencies, and, weakly, the distance from beam theory, which decides what the others leave open.
The weight of the tree is part of the model: it stands in its own gravity, which makes a slender tree softer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from galewood.io.export.rigid.bodies import RigidTree
from galewood.io.export.rigid.chain import natural_modes
from galewood.util import Floats

SHEAR_RATIO = 0.064
"""Shear modulus over the modulus along the grain: mean of the species of `galewood.wood`; only a start."""
SMOOTH_WEIGHTS = (0.1, 0.02, 0.004)
"""Of the difference between a hinge's ratio to beam theory and that of its parent, or its other axis of
bending; one fit after another, so that the first does not end in a poor minimum."""
BEAM_SHARE = 0.3
"""Weight of the ratio itself over that of the differences."""
MODE_WEIGHT = 0.3
FREQUENCY_WEIGHT = 10.0
MOST_STEPS = 25
LEAST_GAIN = 1e-3
"""The fit ends when a step reduces the sum of squares by less than this share, and was hardly damped."""
UNDAMPED_BELOW = 1e-3
LONGEST_STEP = 1.5
"""Of a logarithm in one step."""
_ROW, _COLUMN = np.triu_indices(3)
_TWICE = np.where(_ROW == _COLUMN, 1.0, np.sqrt(2.0))


@dataclass(frozen=True)
class Chain:
    """A chain in its weight, and what it should do; g sections, k modes, h = 3b hinges."""

    tree: RigidTree
    mass: Floats
    """(h, h)"""
    weight: Floats
    """(h, h) stiffness of gravity, N m/rad."""
    rows: Floats
    """(g, 3, h) motion of the sections per radian."""
    yields: Floats
    """(g, 3, 3) m/N: their response to forces on them."""
    inertia: Floats
    """(h, k) generalised force of each mode's inertia, M φ."""
    swayed: Floats
    """(g, 3, k) static response of the sections to it, φ / ω²."""
    frequency_hz: Floats
    """Lowest frequencies."""

    def stiffness(self, hinges: Floats) -> Floats:
        """(h, h) of the hinges (h,) and the weight."""
        return np.diag(hinges) + self.weight


def beam_stiffness(chain: Chain) -> Floats:
    """(h,) N m/rad: E I / L and G J / L of round beams; the modulus makes the first frequency right."""
    tree = chain.tree
    bending = 0.25 * np.pi * tree.radius_m**4 / tree.length_m
    unit = np.stack([bending, bending, 2 * SHEAR_RATIO * bending], axis=1).ravel()
    moves, given = np.square(chain.rows) @ (1.0 / unit), np.trace(chain.yields, axis1=1, axis2=2)
    hinges = unit * float(np.median(moves.sum(axis=1) / given))
    while natural_or_none(chain, hinges, 1) is None:
        hinges = 1.5 * hinges
    return hinges


def natural_or_none(chain: Chain, hinges: Floats, count: int) -> Floats | None:
    """(count,) lowest frequencies, Hz; None: the chain falls over."""
    try:
        return natural_modes(chain.mass, chain.stiffness(hinges), count).frequency_hz
    except np.linalg.LinAlgError:
        return None


@dataclass(frozen=True)
class _Fit:
    """Sum of squares of the residuals, half its gradient (h,) and the Gauss–Newton matrix (h, h)."""

    squares: float
    gradient: Floats
    normal: Floats


def fitted_stiffness(chain: Chain) -> Floats:
    """(h,) N m/rad: stiffness of every hinge about its three axes."""
    first = np.log(beam_stiffness(chain))
    log_k = first
    for weight in SMOOTH_WEIGHTS:
        log_k = _minimum(chain, log_k, first, weight * _roughness(chain.tree))
    return np.exp(log_k)


def _minimum(chain: Chain, log_k: Floats, first: Floats, rough: Floats) -> Floats:
    """The logarithms (h,) of the least sum of squares, by the Levenberg–Marquardt method."""
    now, damping = _fit(chain, log_k, first, rough), 1e-2
    for _ in range(MOST_STEPS):
        damped = now.normal + damping * np.diag(np.diag(now.normal))
        step = np.clip(-np.linalg.solve(damped, now.gradient), -LONGEST_STEP, LONGEST_STEP)
        stands = natural_or_none(chain, np.exp(log_k + step), 1) is not None
        tried = _fit(chain, log_k + step, first, rough) if stands else now
        gain = 1.0 - tried.squares / now.squares
        if gain <= 0:
            damping *= 10
            continue
        log_k, now, damping = log_k + step, tried, damping / 5
        if gain < LEAST_GAIN and damping < UNDAMPED_BELOW:
            break
    return log_k


def _fit(chain: Chain, log_k: Floats, first: Floats, rough: Floats) -> _Fit:
    hinges = np.exp(log_k)
    stiffness = chain.stiffness(hinges)
    count, size = len(chain.rows), len(hinges)
    loads = np.concatenate([chain.rows.reshape(-1, size).T, chain.inertia], axis=1)
    bent = scipy.linalg.cho_solve(scipy.linalg.cho_factor(stiffness), loads)
    pulled, swung = bent[:, : 3 * count].T, bent[:, 3 * count :]
    yields, moves = (rows.reshape(count, 3, size) for rows in (chain.rows.reshape(-1, size), pulled))
    norm = _TWICE / np.linalg.norm(chain.yields, axis=(1, 2))[:, None]
    own = ((yields @ moves.transpose(0, 2, 1)) - chain.yields)[:, _ROW, _COLUMN] * norm
    of_own = (-(moves[:, _ROW] * moves[:, _COLUMN] * hinges) * norm[:, :, None]).reshape(-1, size)
    scale = MODE_WEIGHT / np.sqrt(np.square(chain.swayed).sum(axis=(0, 1)))
    modal = ((chain.rows @ swung - chain.swayed) * scale).reshape(3 * count, -1)
    # the derivative of this residual is −pulled ⊗ swung: its normal matrix is a product of two small ones
    left, right = pulled * hinges, swung * scale
    modes = natural_modes(chain.mass, stiffness, len(chain.frequency_hz))
    tuned = 2 * FREQUENCY_WEIGHT * np.log(modes.frequency_hz / chain.frequency_hz)
    of_tuned = FREQUENCY_WEIGHT * modes.slope(hinges)
    away = rough @ (log_k - first)
    return _Fit(
        float(sum(np.square(part).sum() for part in (own, modal, tuned, away))),
        own.ravel() @ of_own - ((left.T @ modal) * right).sum(axis=1) + tuned @ of_tuned + away @ rough,
        of_own.T @ of_own + (left.T @ left) * (right @ right.T) + of_tuned.T @ of_tuned + rough.T @ rough,
    )


def _roughness(tree: RigidTree) -> Floats:
    """(m, h) rows that beam theory weighs the logarithms by."""
    every = np.eye(tree.count)
    steps = (every - np.where((tree.parent >= 0)[:, None], every[tree.parent], 0.0))[tree.parent >= 0]
    across = np.kron(every, np.array([[1.0, -1.0, 0.0]]))
    rows = np.concatenate([np.kron(steps, np.eye(3)), across, BEAM_SHARE * np.eye(3 * tree.count)])
    return rows.astype(np.float64)
