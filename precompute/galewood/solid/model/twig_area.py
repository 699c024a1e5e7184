"""Area that the twigs a mesh lacks turn to the wind, from their mass.

By the pipe model (`crown_mass`), 533 d^0.79 kg of wood per m² of trunk are thinner than d, in cm. Wood of the
diameter d and the mass dm has the projected area dm / (ρ d), averaged over directions (Cauchy). Twigs end
with a diameter of 2.8 mm: the mean of the moderately slender twigs in the database of rTwig, the class of 61
of its 112 entries (its article "Twigs"; Morales and MacFarlane, Forestry 98, 2024); maples have 2.5 mm. The
area grows with its power −0.21: twigs half as thick add a fifth.
"""

from __future__ import annotations

import numpy as np

from galewood.solid.model.crown_mass import BRANCH_POWER, COARSEST_CM, FINEST_CM

END_TWIG_CM = 0.28
"""Diameter of the last twigs; none is thinner."""
TWIG_DRAG_COEFFICIENT = 0.75
"""Of a twig in any direction, on its mean projected area: that of a long cylinder across the wind at Reynolds
numbers of 10³ to 10⁵, about 1.0 (Hoerner, "Fluid-Dynamic Drag", 1965, from memory), if only the wind across
the cylinder drags: times ⟨sin³⟩ / ⟨sin⟩ = 3/4 over all directions."""


def twig_area_per_mass(finest_cm: float, density_kg_m3: float) -> float:
    """Projected area, m² per kg, of all twigs beyond branches of this diameter, cm."""
    coarse, power = float(np.clip(finest_cm, FINEST_CM, COARSEST_CM)), BRANCH_POWER - 2
    # ∫ dm / (ρ d) from the end twigs to the branch, and the end twigs themselves; m = d^power
    area = (END_TWIG_CM ** (power - 1) - power * coarse ** (power - 1)) / (1 - power)
    return 100 * area / (density_kg_m3 * coarse**power)


def shown_area(twigs_m2: float, free_m2: float) -> float:
    """Silhouette, m², of twigs of a projected area that overlap at random within an area, m²."""
    return 0.0 if free_m2 <= 0 else float(-free_m2 * np.expm1(-twigs_m2 / free_m2))
