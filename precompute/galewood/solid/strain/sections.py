"""Bending moment, strain and stress along the stem and the boughs of a tree in a steady wind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

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
    x_m: float
    z_m: float
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
    young_pa: float
    breast_height_strain: float | None
    """Of the stem at 1.3 m; None: it does not reach it."""
    base_moment_nm: float
    top_displacement_m: float
    load_factor: float
    """Weight over buckling load, as given."""
    weight_share: float
    """Of the weight, the share that acts: less than 1 for a tree that would hardly stand."""
    rupture_strain: float
    """Of green wood, without knots: where the strain exceeds it, the wood would break."""

    @property
    def stress_pa(self) -> Floats:
        """(s,) stress at the outermost fibre."""
        return self.young_pa * self.strain

    def largest(self, part: Part = "stem") -> Section | None:
        """The section with the largest strain; None: the tree has no boughs of 4 cm.

        Raises ValueError for another part.
        """
        if part not in get_args(Part):
            raise ValueError(f"part must be one of {', '.join(get_args(Part))}, not {part!r}")
        of_part = np.flatnonzero(self.stem if part == "stem" else self.bough)
        if not len(of_part):
            return None
        at = int(of_part[np.argmax(self.strain[of_part])])
        return self.section(at, float(self.strain[at]))

    def section(self, at: int, strain: float) -> Section:
        """A section by its index, with a strain at its outermost fibre."""
        x, y, z = self.place_m[at].tolist()
        diameter_m, stress_pa = float(self.diameter_m[at]), self.young_pa * strain
        moment_nm = stress_pa * np.pi / 4 * (diameter_m / 2) ** 3
        return Section(y, x, z, 100 * diameter_m, moment_nm, strain, stress_pa / 1e6)

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
            "rupture_strain": self.rupture_strain,
            "caution": CAUTION_TEXT,
        }


class RodSections:
    """The sections of a tree whose strain is reported; those of a scan's points are not.

    Entry i of an array (s,) is the middle of rod ``rod[i]``.
    """

    def __init__(self, rods: WindRods) -> None:
        self.rod: Ints = np.flatnonzero(~rods.inside & (rods.rods.clamped == 0) & (rods.radius_m > 0))
        self._axis = rods.rods.axis[self.rod]
        self.radius_m: Floats = rods.radius_m[self.rod]
        self.place_m: Floats = rods.section_m[self.rod]
        self.branch: Ints = rods.branch[self.rod]
        self.young_pa = rods.wood.young_longitudinal_pa
        on_line = self.branch == TRUNK_LIMB
        self._line = np.flatnonzero(on_line)[np.argsort(self.place_m[on_line, 1])]
        radius = self.at_breast_height(self.radius_m)
        foot = self.radius_m[on_line][0] if radius is None else float(radius)
        self.stem: NDArray[np.bool_] = on_line & (self.radius_m >= STEM_DIAMETER_SHARE * foot)
        self.bough: NDArray[np.bool_] = ~on_line & (2 * self.radius_m >= THIN_DIAMETER_M)

    def moments_nm(self, pose: BentRods) -> Floats:
        """(s, 3) bending moments in a pose, N·m: without torsion, in axes that turn with the rods."""
        moment = pose.moment_nm[self.rod]
        return moment - np.einsum("ni,ni->n", moment, self._axis)[:, None] * self._axis

    def strain(self, moment_nm: Floats) -> Floats:
        """Strain at the outermost fibre by moments (s, ...): M r / (E I)."""
        return (moment_nm.T / (self.young_pa * np.pi / 4 * self.radius_m**3)).T

    def at_breast_height(self, values: Floats) -> Floats | None:
        """Values (s, ...) of the stem at 1.3 m, between its sections; None: it is lower."""
        height = self.place_m[self._line, 1]
        if not height.size or height[-1] < BREAST_HEIGHT_M:
            return None
        above = min(max(int(np.searchsorted(height, BREAST_HEIGHT_M)), 1), len(height) - 1)
        low, high = self._line[above - 1], self._line[above]
        gap = max(float(height[above] - height[above - 1]), 1e-12)
        share = float(np.clip((BREAST_HEIGHT_M - height[above - 1]) / gap, 0.0, 1.0))
        return np.asarray((1 - share) * values[low] + share * values[high], np.float64)

    def breast_height_strain(self, moment_nm: Floats) -> Floats | None:
        """Strain at 1.3 m by moments (s, ...): by moment and radius there; None: the stem is lower."""
        radius, moment = self.at_breast_height(self.radius_m), self.at_breast_height(moment_nm)
        if radius is None or moment is None:
            return None
        return np.asarray(moment / (self.young_pa * np.pi / 4 * radius**3), np.float64)


def strain_in_wind(
    rods: WindRods, wind_m_s: float, direction_deg: float, start: BentRods | None = None
) -> tuple[TreeStrain, BentRods]:
    """Strain of a tree in a steady wind, and its pose. Raises NoEquilibrium.

    The strain follows from the moment M by M r / (E I) with the radius r as drawn.
    """
    load = rods.wind_load_n(wind_m_s, direction_deg)
    pose = bent(rods.rods, load, start)
    sections = RodSections(rods)
    moment = np.linalg.norm(sections.moments_nm(pose), axis=1)
    strain = sections.strain(moment)
    breast = sections.breast_height_strain(moment)
    return TreeStrain(
        wind_m_s,
        direction_deg,
        sections.place_m,
        sections.branch,
        sections.stem,
        sections.bough,
        2 * sections.radius_m,
        moment,
        strain,
        sections.young_pa,
        None if breast is None else float(breast),
        base_moment_nm(rods, load, pose),
        float(np.linalg.norm(pose.displacement_m[np.argmax(rods.points_m[:, 1])])),
        rods.load_factor,
        rods.weight_share,
        rods.wood.rupture_strain,
    ), pose


def base_moment_nm(rods: WindRods, load_n: Floats, pose: BentRods) -> float:
    """Overturning moment at the ground, N·m, of the wind and of the weight in the bent pose."""
    arm = rods.points_m + pose.displacement_m - rods.points_m[0]
    weight = np.zeros_like(load_n)
    weight[:, 1] = -rods.rods.weight_n
    total = np.cross(arm, load_n).sum(axis=0) + np.cross(pose.displacement_m, weight).sum(axis=0)
    return float(np.hypot(total[0], total[2]))
