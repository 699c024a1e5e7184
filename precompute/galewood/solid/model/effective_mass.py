"""Effective modal masses: how much of a tree each of its natural modes moves, and which one is the main sway.

With mass-normalised shapes φ, the participation factor of mode k for a direction d is Γ = φᵀ M 1_d, and its
effective mass Γ². Over all modes the effective masses of each direction add up to the mass that is free to
move; that of the first mode of a uniform cantilever is 0.613 of it (Clough & Penzien, "Dynamics of
Structures", chapter 13).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.solid.fem import FemModel, Modes
from galewood.util import Floats

SIGNIFICANT_MASS_SHARE = 0.05
"""Horizontal effective mass over free mass of a mode that is reported as main sway."""


def participation_factors(modes: Modes, mass_kg: Floats) -> Floats:
    """(k, 3) participation factor Γ, √kg, of each mode for each axis; mass_kg (N,) is that of the nodes."""
    return np.einsum("n,kni->ki", mass_kg, modes.shapes)


def effective_masses(modes: Modes, mass_kg: Floats) -> Floats:
    """(k, 3) effective mass Γ², kg, of each mode for each axis; mass_kg (N,) is that of the nodes."""
    return participation_factors(modes, mass_kg) ** 2


def horizontal_masses(effective_kg: Floats) -> Floats:
    """(k,) horizontal effective mass, kg, of effective masses (k, 3): x and z together."""
    return effective_kg[:, 0] + effective_kg[:, 2]


def free_mass_kg(model: FemModel) -> float:
    """Mass of the nodes that are free to move, kg."""
    return float(model.mass_kg.sum() - model.mass_kg[model.fixed].sum())


def sway_report(model: FemModel, modes: Modes) -> dict[str, Any]:
    """Effective masses, kg, and the main sway mode: that of the largest horizontal one, x and z together.

    The main mode counts from 0; it is None if no mode moves a noticeable part of the tree.
    """
    effective = effective_masses(modes, model.mass_kg)
    horizontal = horizontal_masses(effective)
    free = free_mass_kg(model)
    main = int(np.argmax(horizontal))
    found = horizontal[main] > SIGNIFICANT_MASS_SHARE * free
    return {
        "free_mass_kg": free,
        "effective_mass_kg": effective.round(4).tolist(),
        "main_mode": main if found else None,
        "main_frequency_hz": float(modes.frequencies_hz[main]) if found else None,
        "main_share": float(horizontal[main] / free),
    }
