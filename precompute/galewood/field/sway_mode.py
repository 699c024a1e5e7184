"""The main sway mode: the natural mode that moves most of the tree's mass horizontally."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.fem import FemModel, natural_modes
from galewood.util import Floats

MODES = 24


@dataclass(frozen=True)
class SwayMode:
    """Main sway mode: frequency, the lowest frequency, share of the mass, direction, shape (N,3) 1/√kg."""

    frequency_hz: float
    lowest_hz: float
    number: int
    """1: the lowest mode."""
    mass_share: float
    """Effective horizontal mass over the mass that is free to move."""
    direction: tuple[float, float]
    """Unit vector (x, z) in which the mode moves the mass."""
    shape: Floats


def main_sway_mode(model: FemModel) -> SwayMode:
    """The mode of largest horizontal effective mass Γ², Γ = Σ m φ (Clough and Penzien, 12-7)."""
    count = min(MODES, (3 * len(model.nodes_m) - 3 * len(model.fixed)) // 2)
    modes = natural_modes(model, count)
    gamma = np.einsum("n,kni->ki", model.mass_kg, modes.shapes)[:, [0, 2]]
    effective = (gamma**2).sum(axis=1)
    best = int(np.argmax(effective))
    x, z = gamma[best] / np.sqrt(effective[best])
    return SwayMode(
        float(modes.frequencies_hz[best]),
        float(modes.frequencies_hz[0]),
        best + 1,
        float(effective[best] / (model.mass_kg.sum() - model.mass_kg[model.fixed].sum())),
        (float(x), float(z)),
        modes.shapes[best],
    )
