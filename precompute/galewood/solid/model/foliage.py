"""Effect of foliage and twigs on the wood: mass and wind area, lumped at the points of a model."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any, Protocol

import numpy as np
from scipy.spatial import ConvexHull

from galewood.formats import alpha_coverage
from galewood.solid.model.crown_mass import Spread, TwigLoads, twig_loads, vertex_areas
from galewood.solid.model.silhouette import silhouette_area
from galewood.solid.model.twigs import (
    TWIG_DRAG_COEFFICIENT,
    shown_area,
    twig_area_per_mass,
    twig_volumes,
)
from galewood.solid.skeleton import CLAMPED_SHARE, Outline, root_vertices
from galewood.solid.skinning import LARGEST_RIGID_PIECE, leading_vertices, nearest_tets
from galewood.solid.tets import TetMesh, tet_volumes
from galewood.tree import RenderPrimitive, TreeMesh
from galewood.util import Floats, Int32s
from galewood.wood import BARE_EXPONENT

LEAF_MASS_KG_M2 = 0.2  # fresh leaf including its petiole, per one-sided area
EVERGREEN_LEAF_MASS_KG_M2 = 0.4
"""Needles and other evergreen leaves are about twice as heavy per area as those shed each year (H. Poorter
and others, New Phytologist 182, 2009, 565–588; quoted from memory, unchecked)."""
MOST_LEAF_MASS = 0.5  # relative to the mass of the wood
PROFILE_EXPONENT = 0.4  # of the pressure over height; the speed grows with about the fifth root
RANDOM_PROJECTION = 0.5  # mean projected area of a flat leaf over its one-sided area
LEAF_DRAG_COEFFICIENT = 0.4
"""Drag area of leaves over their one-sided area, in the air among them (calibrated, docs/physics.md)."""
CONVEX_PROJECTION = 0.25  # mean projected area of a convex body over its surface (Cauchy)


class WoodLike(Protocol):
    """The part of a Wood used here."""

    @property
    def density_kg_m3(self) -> float: ...
    @property
    def drag_coefficient(self) -> float: ...
    @property
    def streamlined_exponent(self) -> float: ...
    @property
    def evergreen(self) -> bool: ...


@dataclass(frozen=True)
class LumpedMasses:
    """Per tet vertex: added mass (n,) kg and drag area (n,) m²; also the fixed vertices (k,).

    The drag area is Cd·A of the silhouette, the exposed area that of all leaves, twigs and wood without
    shelter; both include the height profile of the pressure, whose root is wind_profile
    (`galewood.solid.fem.drag`).
    leaf_mass_kg (n,) is the leaves' part of the mass, the rest is twigs; empty: there are no leaves.
    streamlined_exponent is that of the pressure over the wind speed above 5 m/s.
    """

    mass_kg: Floats
    drag_area_m2: Floats
    fixed: Int32s
    report: dict[str, Any]
    exposed_area_m2: Floats | None = None
    wind_profile: Floats | None = None
    leaf_mass_kg: Floats = field(default_factory=lambda: np.zeros(0))
    streamlined_exponent: float = BARE_EXPONENT


@dataclass(frozen=True)
class CrownLoads:
    """Per point: mass (n,) kg of leaves and twigs, and areas (n,) as in ``LumpedMasses``; and a report."""

    mass_kg: Floats
    drag_area_m2: Floats
    exposed_area_m2: Floats
    wind_profile: Floats
    report: dict[str, Any]
    leaf_mass_kg: Floats
    streamlined_exponent: float


def _without_leaves(tree: TreeMesh) -> TreeMesh:
    """The tree without the primitives of its leaves."""
    return replace(tree, primitives=[part for part in tree.primitives if part.kind != "leaves"])


def bind_foliage(tree: TreeMesh, mesh: TetMesh, wood: WoodLike, leaves: bool = True) -> LumpedMasses:
    """Mass of leaves and twigs, and wind area, at the vertices of the tetrahedral mesh.

    Without ``leaves`` mass and wind area are those of wood and twigs.
    """
    wood_mass = float(
        (tet_volumes(mesh.vertices_m, mesh.tets) * mesh.radius_ratio**2).sum() * wood.density_kg_m3
    )
    rigid_m = LARGEST_RIGID_PIECE * tree.height_m if tree.added_faces else np.inf
    spread = partial(_spread, mesh=mesh, rigid_m=rigid_m)
    crown = crown_loads(tree, wood, mesh.vertices_m[:, 1], spread, wood_mass, leaves)
    fixed = root_vertices(mesh.vertices_m, mesh.tets).astype(np.int32)
    report = crown.report | {"clamped_lowest_share": CLAMPED_SHARE}
    areas = (crown.exposed_area_m2, crown.wind_profile)
    return LumpedMasses(
        crown.mass_kg, crown.drag_area_m2, fixed, report, *areas, crown.leaf_mass_kg,
        crown.streamlined_exponent,
    )  # fmt: skip


def crown_loads(
    tree: TreeMesh,
    wood: WoodLike,
    height_m: Floats,
    spread: Spread,
    wood_mass_kg: float,
    leaves: bool = True,
    outline: Outline | None = None,
) -> CrownLoads:
    """Mass of leaves and twigs, and wind area, at points of a model at the heights (n,).

    ``spread`` distributes an amount (v,) at the vertices of a primitive to the points (n,). Without
    ``leaves`` the twigs still hang where leaves do. ``outline`` is that of the drawn wood, if it is known.
    """
    crown = _drawn_loads(tree if leaves else _without_leaves(tree), wood, height_m, spread, wood_mass_kg)
    drawn_kg = crown.report["twig_mass_kg"]
    twigs = twig_loads(tree, spread, wood_mass_kg, drawn_kg, outline)
    return _with_twigs(crown, twigs, wood, tree)


def _with_twigs(crown: CrownLoads, twigs: TwigLoads, wood: WoodLike, tree: TreeMesh) -> CrownLoads:
    """The loads with mass and area of the twigs, which fill the crown's outline where nothing is drawn."""
    report = crown.report | twigs.report
    if not twigs.share.any():
        return replace(crown, report=report)
    all_kg = float(twigs.mass_kg.sum()) + crown.report["twig_mass_kg"]
    all_m2 = all_kg * twig_area_per_mass(twigs.report["finest_branch_cm"], wood.density_kg_m3)
    total = max(all_m2 - crown.report["twig_area_m2"], 0.0)
    shown = shown_area(total, _envelope_area(tree) - crown.report["silhouette_m2"])
    area = total * twigs.share
    exposed = TWIG_DRAG_COEFFICIENT * area * crown.wind_profile**2
    drag = crown.drag_area_m2 + exposed * (shown / max(total, 1e-300))
    return replace(
        crown,
        mass_kg=crown.mass_kg + twigs.mass_kg,
        drag_area_m2=drag,
        exposed_area_m2=np.maximum(crown.exposed_area_m2 + exposed, drag),
        report=report
        | {
            "added_twig_area_m2": total,
            "added_twig_silhouette_m2": shown,
            "twig_drag_coefficient": TWIG_DRAG_COEFFICIENT,
            "exposed_drag_area_m2": crown.report["exposed_drag_area_m2"] + float(exposed.sum()),
        },
    )


def _envelope_area(tree: TreeMesh) -> float:
    """Area, m², that the crown covers: in leaf, or else the mean projection of its convex hull (Cauchy)."""
    if any(part.kind == "leaves" for part in tree.primitives):
        return silhouette_area(*_triangles(tree))
    return CONVEX_PROJECTION * float(ConvexHull(tree.wood_vertices_m).area)


def _drawn_loads(
    tree: TreeMesh,
    wood: WoodLike,
    height_m: Floats,
    spread: Spread,
    wood_mass_kg: float,
) -> CrownLoads:
    """The loads of what is drawn.

    The silhouette area of the whole tree, averaged over directions, is distributed in proportion to each
    part's projected area.
    """
    leaf_area, wood_area, twig_mass = (np.zeros(len(height_m)) for _ in range(3))
    twig_area = 0.0
    for primitive in tree.primitives:
        area = spread(primitive, vertex_areas(primitive) * alpha_coverage(primitive.material))
        if primitive.kind == "leaves":
            leaf_area += area
        else:
            wood_area += area
        if primitive.kind == "twigs":
            twig_mass += spread(primitive, twig_volumes(primitive) * wood.density_kg_m3)
            twig_area += CONVEX_PROJECTION * float(area.sum())
    per_area = EVERGREEN_LEAF_MASS_KG_M2 if wood.evergreen else LEAF_MASS_KG_M2
    leaf_mass, capped = _leaf_mass(per_area * leaf_area, wood_mass_kg)
    silhouette = silhouette_area(*_triangles(tree))
    projected = RANDOM_PROJECTION * leaf_area + CONVEX_PROJECTION * wood_area
    frontal = projected * (silhouette / max(float(projected.sum()), 1e-300))
    leafy = any(primitive.kind == "leaves" for primitive in tree.primitives)
    exponent = wood.streamlined_exponent if leafy else BARE_EXPONENT
    profile = np.clip(height_m / tree.height_m, 0.0, 1.0) ** PROFILE_EXPONENT
    exposed = LEAF_DRAG_COEFFICIENT * leaf_area + wood.drag_coefficient * CONVEX_PROJECTION * wood_area
    return CrownLoads(
        leaf_mass + twig_mass,
        wood.drag_coefficient * frontal * profile,
        np.maximum(exposed, wood.drag_coefficient * frontal) * profile,
        np.sqrt(profile),
        {
            "silhouette_m2": silhouette,
            "leaf_area_m2": float(leaf_area.sum()),
            "leaf_mass_kg": float(leaf_mass.sum()),
            "leaf_mass_capped": capped,
            "twig_mass_kg": float(twig_mass.sum()),
            "twig_area_m2": twig_area,
            "wood_mass_kg": wood_mass_kg,
            "drag_coefficient": wood.drag_coefficient,
            "leaf_drag_coefficient": LEAF_DRAG_COEFFICIENT,
            "exposed_drag_area_m2": float((exposed * profile).sum()),
            "profile_exponent": PROFILE_EXPONENT,
            "streamlined_exponent": exponent,
        },
        leaf_mass,
        exponent,
    )


def _leaf_mass(mass: Floats, wood_mass_kg: float) -> tuple[Floats, bool]:
    most = MOST_LEAF_MASS * wood_mass_kg
    total = float(mass.sum())
    return (mass * (most / total), True) if total > most else (mass, False)


def _spread(primitive: RenderPrimitive, amount: Floats, mesh: TetMesh, rigid_m: float) -> Floats:
    """Distribute an amount (n,) at render vertices to the tet vertices that they are embedded in.

    A piece larger than ``rigid_m``, such as a crown around an added stem, weighs on all wood inside it.
    """
    points = nearest_tets(primitive.positions_m, mesh)
    leader = np.arange(len(amount))
    if primitive.kind != "wood":
        leader = leading_vertices(primitive, points.distance_m, rigid_m)
    parts = points.weight[leader] * amount[:, None]
    return np.asarray(
        np.bincount(mesh.tets[points.tet[leader]].ravel(), parts.ravel(), len(mesh.vertices_m)),
        dtype=np.float64,
    )


def _triangles(tree: TreeMesh) -> tuple[Floats, Floats]:
    triangles = [p.positions_m[p.faces] for p in tree.primitives]
    coverage = [np.full(len(p.faces), alpha_coverage(p.material)) for p in tree.primitives]
    return np.concatenate(triangles), np.concatenate(coverage)
