"""The main sway mode: the natural mode that moves most of the tree's mass horizontally."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.solid.fem import FemModel, natural_modes
from galewood.solid.model import effective_masses, free_mass_kg, horizontal_masses, participation_factors
from galewood.util import Floats

MODE_COUNT = 24


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
    """The mode of the largest horizontal effective mass (`galewood.solid.model.effective_masses`)."""
    count = min(MODE_COUNT, (3 * len(model.nodes_m) - 3 * len(model.fixed)) // 2)
    modes = natural_modes(model, count)
    horizontal = horizontal_masses(effective_masses(modes, model.mass_kg))
    best = int(np.argmax(horizontal))
    x, _, z = participation_factors(modes, model.mass_kg)[best] / np.sqrt(horizontal[best])
    return SwayMode(
        float(modes.frequencies_hz[best]),
        float(modes.frequencies_hz[0]),
        best + 1,
        float(horizontal[best] / free_mass_kg(model)),
        (float(x), float(z)),
        modes.shapes[best],
    )
