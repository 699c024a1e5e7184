"""Twigs: volume of those that are drawn, as wood too thin to be meshed, and area of those that are not drawn.

By the pipe model (`crown_mass`), 533 d^0.79 kg of wood per m² of trunk are thinner than d, in cm. Wood of the
diameter d and the mass dm has the projected area dm / (ρ d), averaged over directions (Cauchy). Twigs end
with a diameter of 2.8 mm: the mean of the moderately slender twigs in the database of rTwig, the class of 61
of its 112 entries (its article "Twigs"; Morales and MacFarlane, Forestry 98, 2024); maples have 2.5 mm. The
area grows with its power −0.21: twigs half as thick add a fifth.
"""

from __future__ import annotations

import numpy as np

from galewood.solid.model.crown_mass import BRANCH_POWER, COARSEST_CM, FINEST_CM
from galewood.tree import RenderPrimitive, Surface, face_components, weld_keeping_faces
from galewood.util import Floats

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


def twig_volumes(primitive: RenderPrimitive) -> Floats:
    """Volume (n,) m³ of the wood at each vertex: that enclosed by its piece, in equal shares.

    A piece must be closed; open ones count as if their edge were joined to their centre. Flat pieces have no
    volume. The sense in which the faces are wound is of no importance.
    """
    welded = weld_keeping_faces(Surface(primitive.positions_m, primitive.faces))
    count, of_face = face_components(welded.faces, len(welded.vertices))
    piece = np.full(len(primitive.positions_m), count, dtype=np.int64)
    piece[primitive.faces.ravel()] = np.repeat(of_face, 3)
    corners_of = np.bincount(piece, minlength=count + 1)
    centre = np.stack([np.bincount(piece, primitive.positions_m[:, k], count + 1) for k in range(3)], axis=1)
    centre /= np.maximum(corners_of, 1)[:, None]
    a, b, c = np.moveaxis(primitive.positions_m[primitive.faces] - centre[of_face][:, None], 1, 0)
    volume = np.abs(np.bincount(of_face, np.einsum("fi,fi->f", a, np.cross(b, c)) / 6, count + 1))
    volume[count] = 0.0  # vertices without a face
    return np.asarray((volume / np.maximum(corners_of, 1))[piece], dtype=np.float64)
