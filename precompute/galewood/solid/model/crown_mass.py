"""Mass of the twigs that a mesh lacks, from the trunk's cross-section and the finest branches it draws.

Pipe model (Shinozaki and others, Japanese Journal of Ecology 14, 1964): the cross-sections of all branches
of one thickness add up to that of the trunk. A tree whose wood is drawn down to branches of diameter d thus
has A / (π d²/4) branches of this diameter, where A is the cross-section of the trunk, and each carries its
twigs.

Their mass is that of measured branches, weighed fresh with all their side branches: m = 0.0419 d^2.79 kg, d
in cm. Fitted (residual 34 %) to the 21 branches of 1.2 to 9.9 cm in the table "branch diameter – branch dry
weight" of the course FES 519b, Yale (yale.edu/fes519b/totoket/allom/brdat.txt). Their species is not stated;
a dry mass of 0.65 of the fresh one suggests hardwood without leaves. Together: 533 d^0.79 kg per m² of trunk.

Assumed: the cross-section at breast height stands for that below the crown, which is smaller, and for that of
the twigs, which together are thicker than the limbs they grow from. Twigs hang where leaves hang (again the
pipe model), or, on a tree without leaves, evenly along the limbs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from galewood.constants import BREAST_HEIGHT_M
from galewood.formats import alpha_coverage
from galewood.solid.skeleton import Outline, outline_of
from galewood.tree import RenderPrimitive, TreeMesh
from galewood.util import Floats

BRANCH_KG, BRANCH_POWER = 0.0419, 2.79
"""Fresh mass of a branch of 1 cm with its twigs, and the power of its diameter in cm."""
FINEST_CM, COARSEST_CM = 1.0, 10.0
"""Range of the diameters that were weighed."""
LOW_SHARE = 1 / 9
"""Height of the measured cross-section on a low tree, relative to its own; otherwise at breast height."""
FEWEST_BRANCHES = 3
"""A trunk with fewer side branches is a pole, which has no twigs."""
MOST_TWIG_MASS = 0.5
"""Relative to the mass of the wood."""
LIMB_SHARE = 0.5
"""Radius, relative to the trunk's, below which a limb has twigs if the tree has no leaves."""
MASS_SOURCE = "pipe model; fresh branch mass 0.0419 d^2.79 kg (21 branches, FES 519b, Yale)"

Spread = Callable[[RenderPrimitive, Floats], Floats]
"""Distributes an amount (v,) at the vertices of a primitive to the points (n,) of a model."""


@dataclass(frozen=True)
class TwigLoads:
    """Per point of a model: mass (n,) of twigs that the mesh lacks, kg, and the share (n,) of all twigs that
    hang there, also where none are lacking; and a report.
    """

    mass_kg: Floats
    share: Floats
    report: dict[str, Any]


def branch_mass_kg(diameter_cm: float) -> float:
    """Fresh mass of a branch of this diameter with all its twigs, kg."""
    return BRANCH_KG * diameter_cm**BRANCH_POWER


def twig_mass_per_area(finest_cm: float) -> float:
    """Mass of twigs, kg per m² of trunk, on a tree that is drawn down to branches of this diameter, cm."""
    diameter_cm = float(np.clip(finest_cm, FINEST_CM, COARSEST_CM))
    return branch_mass_kg(diameter_cm) / (np.pi / 4 * (diameter_cm / 100) ** 2)


def twig_loads(
    tree: TreeMesh,
    spread: Spread,
    wood_mass_kg: float,
    drawn_kg: float = 0.0,
    outline: Outline | None = None,
) -> TwigLoads:
    """The missing twigs of a tree, with wood of this mass and drawn twigs of ``drawn_kg``.

    ``spread`` is that of ``crown_loads``.
    """
    leaves = any(part.kind == "leaves" for part in tree.primitives)
    drawn = _scanned(tree)
    if drawn and leaves:  # no outline is needed, which takes a while
        weight = _like_leaves(tree, spread)
    else:
        # Added wood has no twigs of its own: how finely a tree is drawn is told by what is drawn.
        outline = _outline(tree) if outline is None or tree.added_faces else outline
        if outline is None:
            none = spread(tree.primitives[0], np.zeros(len(tree.primitives[0].positions_m)))
            return TwigLoads(none, none, {"added_twig_mass_kg": 0.0})
        drawn = drawn or _drawn(outline)
        weight = _like_leaves(tree, spread) if leaves else _along_limbs(tree, outline, spread)
    trunk_cm, finest_cm = drawn
    if finest_cm is None or not weight.any():
        none = np.zeros_like(weight)
        return TwigLoads(none, none, {"added_twig_mass_kg": 0.0})
    allometric = np.pi / 4 * (trunk_cm / 100) ** 2 * twig_mass_per_area(finest_cm)
    missing, most = max(allometric - drawn_kg, 0.0), MOST_TWIG_MASS * wood_mass_kg
    share = weight / weight.sum()
    mass = min(missing, most) * share
    report = {
        "added_twig_mass_kg": float(mass.sum()),
        "twig_mass_capped": missing > most,
        "twig_mass_source": MASS_SOURCE,
        "trunk_diameter_cm": trunk_cm,
        "finest_branch_cm": finest_cm,
    }
    return TwigLoads(mass, share, report)


def _outline(tree: TreeMesh) -> Outline | None:
    """The branches of the drawn wood; None if its surface has none that can be followed."""
    wood = tree.drawn_wood()
    try:
        return outline_of(wood.positions_m, wood.faces)
    except (ValueError, IndexError):
        return None


def trunk_diameter_cm(points_m: Floats, radius_m: Floats, branch: np.ndarray[Any, Any]) -> float:
    """Diameter of the trunk (branch 0) 1.3 m above its base, on a low tree at a ninth of its height; cm."""
    trunk = branch == 0
    height = points_m[trunk, 1] - points_m[:, 1].min()
    rising = np.argsort(height)
    at_m = min(BREAST_HEIGHT_M, LOW_SHARE * float(np.ptp(points_m[:, 1])))
    return 200 * float(np.interp(at_m, height[rising], radius_m[trunk][rising]))


def _scanned(tree: TreeMesh) -> tuple[float, float | None] | None:
    """Diameters, cm, of a scanned tree's trunk, and below which its branches were cut; as in ``_drawn``."""
    scan = tree.report.get("qsm", {})
    if not scan.get("dbh_cm"):
        return None
    limbs = scan["branches"] - scan["dropped"]["thin_branches"] - 1
    return float(scan["dbh_cm"]), 0.2 * float(scan["min_radius_mm"]) if limbs >= FEWEST_BRANCHES else None


def _drawn(outline: Outline) -> tuple[float, float | None]:
    """Diameters, cm, of the trunk and of the finest branches: of those without side branches, at their base.

    The second is None if there are hardly any branches.
    """
    trunk_cm = trunk_diameter_cm(outline.points_m, outline.radius_m, outline.branch)
    first = np.flatnonzero((outline.parent >= 0) & (outline.branch[outline.parent] != outline.branch))
    if len(first) < FEWEST_BRANCHES:
        return trunk_cm, None
    bearing = np.unique(outline.branch[outline.parent[first]])
    last = first[~np.isin(outline.branch[first], bearing)]
    return trunk_cm, 200 * float(np.median(outline.radius_m[last]))


def _like_leaves(tree: TreeMesh, spread: Spread) -> Floats:
    """(n,) relative: as the leaves are spread."""
    leaves = (part for part in tree.primitives if part.kind == "leaves")
    return np.sum([spread(p, vertex_areas(p) * alpha_coverage(p.material)) for p in leaves], axis=0)


def _along_limbs(tree: TreeMesh, outline: Outline, spread: Spread) -> Floats:
    """(n,) relative: evenly along all limbs, which are thinner than the trunk."""
    near, trunk_m = KDTree(outline.points_m), outline.radius_m[outline.branch == 0].max()
    parts: list[Floats] = []
    for part in (p for p in tree.primitives if p.kind == "wood"):
        radius = outline.radius_m[near.query(part.positions_m)[1]]
        length = vertex_areas(part) / np.maximum(radius, 1e-6)  # of the limb, up to a factor
        parts.append(spread(part, np.where(radius < LIMB_SHARE * trunk_m, length, 0.0)))
    return np.sum(parts, axis=0)


def vertex_areas(primitive: RenderPrimitive) -> Floats:
    """Area (n,) of the faces around each vertex; each corner gets a third of its face."""
    corners = primitive.positions_m[primitive.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    share = np.linalg.norm(cross, axis=1) / 6.0
    return np.asarray(
        np.bincount(primitive.faces.ravel(), np.repeat(share, 3), len(primitive.positions_m)),
        dtype=np.float64,
    )
