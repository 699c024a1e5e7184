"""Bending moment, strain and stress along the stem and the boughs of a tree in a steady wind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from galewood.constants import BREAST_HEIGHT_M
from galewood.solid.beams import BentRods, bent
from galewood.solid.fem import TRUNK_LIMB
from galewood.solid.strain.tree_rods import WindRods
from galewood.util import Floats, Ints

STEM_DIAMETER_SHARE = 0.5
"""The stem ends where it is thinner than this share of its diameter at breast height."""
THIN_DIAMETER_M = 0.04
"""Boughs thinner than this are not searched for the largest strain: scans are unsure of them."""
CAUTION_TEXT = (
    "This is a calculation for sound wood, and no substitute for an inspection of the tree. It is not "
    "validated for decay, root damage or included bark, of which it knows nothing."
)
"""What every result says."""
Part = Literal["stem", "boughs"]


@dataclass(frozen=True)
class Section:
    """One section of a tree, as ``TreeStrain`` has them."""

    height_m: float
    diameter_cm: float
    moment_nm: float
    strain: float
    stress_mpa: float


@dataclass(frozen=True)
class TreeStrain:
    """Bending of the sections of a tree in a steady wind; arrays have one entry per section (s,).

    place_m (s, 3) of their middles at rest; branch (s,), 0 for the line of the stem; stem (s,) and bough
    (s,): which of them the largest strains are sought in; diameter_m; bending moment, N·m, by the wind and by
    the weight in the bent pose; bending strain and stress at the outermost fibre. Strain by the weight at
    rest, growth stress, torsion and axial forces are not included.
    """

    wind_m_s: float
    direction_deg: float
    place_m: Floats
    branch: Ints
    stem: NDArray[np.bool_]
    bough: NDArray[np.bool_]
    diameter_m: Floats
    moment_nm: Floats
    strain: Floats
    stress_pa: Floats
    breast_height_strain: float | None
    """Of the stem at 1.3 m; None: it does not reach it."""
    base_moment_nm: float
    top_displacement_m: float
    load_factor: float
    """Weight over buckling load, as given."""
    weight_share: float
    """Of the weight, the share that acts: less than 1 for a tree that would hardly stand."""

    def largest(self, part: Part = "stem") -> Section | None:
        """The section with the largest strain; None: the tree has no boughs of 4 cm."""
        of_part = np.flatnonzero(self.stem if part == "stem" else self.bough)
        if not len(of_part):
            return None
        at = int(of_part[np.argmax(self.strain[of_part])])
        return Section(
            float(self.place_m[at, 1]),
            100 * float(self.diameter_m[at]),
            float(self.moment_nm[at]),
            float(self.strain[at]),
            float(self.stress_pa[at]) / 1e6,
        )

    def figures(self) -> dict[str, Any]:
        """The largest strains, that at breast height, moment and sway; JSON-able."""
        largest = {part: self.largest(part) for part in ("stem", "boughs")}
        return {
            "wind_m_s": self.wind_m_s,
            "direction_deg": self.direction_deg,
            "breast_height_strain": self.breast_height_strain,
            "largest": {part: found and vars(found) for part, found in largest.items()},
            "base_moment_nm": self.base_moment_nm,
            "top_displacement_m": self.top_displacement_m,
            "load_factor": self.load_factor,
            "weight_share": self.weight_share,
            "caution": CAUTION_TEXT,
        }


def strain_in_wind(
    rods: WindRods, wind_m_s: float, direction_deg: float, start: BentRods | None = None
) -> tuple[TreeStrain, BentRods]:
    """Strain of a tree in a steady wind, and its pose. Raises NoEquilibrium.

    The strain follows from the moment M by M r / (E I) with the radius r as drawn.
    """
    load = rods.wind_load_n(wind_m_s, direction_deg)
    pose = bent(rods.rods, load, start)
    moment = _bending_moments(rods, pose)
    shown = ~rods.inside & (rods.rods.clamped == 0) & (rods.radius_m > 0)  # a scan may end in a point
    radius, place = rods.radius_m[shown], rods.section_m[shown]
    young = rods.wood.young_longitudinal_pa
    strain = _strain(moment[shown], radius, young)
    on_line = rods.branch[shown] == TRUNK_LIMB
    breast = _at_breast_height(on_line, place, radius, moment[shown])
    thick = 2 * radius >= STEM_DIAMETER_SHARE * (2 * radius[on_line][0] if breast is None else breast[0])
    return TreeStrain(
        wind_m_s,
        direction_deg,
        place,
        rods.branch[shown],
        on_line & thick,
        ~on_line & (2 * radius >= THIN_DIAMETER_M),
        2 * radius,
        moment[shown],
        strain,
        young * strain,
        None if breast is None else float(_strain(breast[1], breast[0] / 2, young)),
        base_moment_nm(rods, load, pose),
        float(np.linalg.norm(pose.displacement_m[np.argmax(rods.points_m[:, 1])])),
        rods.load_factor,
        rods.weight_share,
    ), pose


def base_moment_nm(rods: WindRods, load_n: Floats, pose: BentRods) -> float:
    """Overturning moment at the ground, N·m, of the wind and of the weight in the bent pose."""
    arm = rods.points_m + pose.displacement_m - rods.points_m[0]
    weight = np.zeros_like(load_n)
    weight[:, 1] = -rods.rods.weight_n
    total = np.cross(arm, load_n).sum(axis=0) + np.cross(pose.displacement_m, weight).sum(axis=0)
    return float(np.hypot(total[0], total[2]))


def _bending_moments(rods: WindRods, pose: BentRods) -> Floats:
    """(n,) moment across each rod, N·m: without torsion."""
    torsion = np.einsum("ni,ni->n", pose.moment_nm, rods.rods.axis)
    return np.sqrt(np.maximum((pose.moment_nm**2).sum(axis=1) - torsion**2, 0.0))


def _strain(moment_nm: Floats | float, radius_m: Floats | float, young_pa: float) -> Floats:
    return np.asarray(moment_nm / (young_pa * np.pi / 4 * np.asarray(radius_m) ** 3), np.float64)


def _at_breast_height(
    on_line: NDArray[np.bool_], place_m: Floats, radius_m: Floats, moment_nm: Floats
) -> tuple[float, float] | None:
    """Diameter, m, and moment, N·m, of the stem at 1.3 m, between its sections; None: it is lower."""
    height = place_m[on_line, 1]
    order = np.argsort(height)
    if not height.size or height[order[-1]] < BREAST_HEIGHT_M:
        return None
    diameter, moment = (
        float(np.interp(BREAST_HEIGHT_M, height[order], of_section[on_line][order]))
        for of_section in (2 * radius_m, moment_nm)
    )
    return diameter, moment
