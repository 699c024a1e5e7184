"""Damping of the hinges: that of the table's modes, by non-negative least squares.

A damper at a hinge damps a mode by the hinge's share of its elastic energy, so that 2 ζ ω = Σ d_j ψ_j², with
the mass-normalised angles ψ. The table's damping is Rayleigh's. No hinge has the part of it that is
proportional to the mass, but the energies of low and high modes lie in different hinges.
"""

from __future__ import annotations

import numpy as np
import scipy.optimize

from galewood.io.export.rigid.chain import ChainModes
from galewood.util import Floats

FITTED_MODES = 24
UNCOUPLED_MODES = 10
FIRST_MODES, FIRST_WEIGHT = 5, 10.0
EVEN_WEIGHT = 0.005
"""Of the relative distance of a hinge's time constant from the mean."""
LEAST_TIME_S = 2e-3
"""Least damping over stiffness. An integrator that is implicit in the velocities is stable up to a step of
twice that, however stiff a hinge is: 4 M + 2 h D − h² K must be positive definite."""


def hinge_damping(modes: ChainModes, hinges: Floats, alpha_1_s: float, beta_s: float) -> Floats:
    """(h,) N m s/rad for modes with the damping 2 ζ ω = α + β ω² each; ``hinges`` (h,) N m/rad."""
    omega = 2 * np.pi * modes.frequency_hz
    wanted = alpha_1_s + beta_s * np.square(omega)
    shape = modes.angle / np.sqrt(wanted)
    # close modes must not damp each other: ψᵀ d ψ is diagonal
    first, second = np.triu_indices(min(UNCOUPLED_MODES, len(omega)), 1)
    energy = hinges * np.concatenate([np.square(shape.T), (shape[:, first] * shape[:, second]).T])
    given = np.concatenate([np.ones(len(omega)), np.zeros(len(first))])
    weight = np.ones(len(given))
    weight[:FIRST_MODES] = FIRST_WEIGHT
    energy, given = energy * weight[:, None], given * weight
    # unknown: damping over stiffness, above the least, in units of the mean
    mean = float(wanted.sum() / np.square(omega).sum())
    least = LEAST_TIME_S / mean
    rows = np.concatenate([energy * mean, EVEN_WEIGHT * np.eye(len(hinges))])
    even = np.full(len(hinges), EVEN_WEIGHT * (1 - least))
    more, _ = scipy.optimize.nnls(rows, np.concatenate([given - least * mean * energy.sum(axis=1), even]))
    return hinges * mean * (least + np.asarray(more, np.float64))


def damping_ratios(modes: ChainModes, damping: Floats) -> Floats:
    """(k,) ζ of the modes with the dampers (h,)."""
    return 0.5 * (damping @ np.square(modes.angle)) / (2 * np.pi * modes.frequency_hz)
