"""Strain of trees of a form in wind, from that of one tree by similarity.

A tree of the height h and diameter d is taken as the form's tree stretched by k = h/h₀ and thickened by
κ = d/d₀, with a crown κ times as wide: crown width is nearly in proportion to stem diameter (Hemery and
others, Forest Ecology and Management 215, 2005). Its wind area grows as k κ and its second moments as κ⁴, so
in a wind it has the shape that the form has in a pressure s times as high, with

    s = k³/κ³ · E₀/E · (1 − ν₀)/(1 − ν)

There its sway is k times, its strain κ/k times, and its moment κ⁴/k · E/E₀ times that of the form. ν is the
share of the buckling load that the weight is; it grows as k³/κ², and with density over E. Weight enlarges a
bending by 1/(1 − ν), with the rule for trees that would hardly stand (`galewood.solid.fem.remaining_share`).
Beyond the winds in which the form was bent, strain, moment and sway are continued in proportion to the
pressure (the sway up to the height): too much rather than too little, for stems that are far too slender.
The first frequency is κ/k² · √(E ρ₀/(E₀ ρ)) · √((1 − ν)/(1 − ν₀)) times that of the form.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from galewood.motion.wind import dynamic_pressure, speed_of_pressure
from galewood.solid.beams import NoEquilibrium
from galewood.solid.fem import remaining_share
from galewood.solid.strain import STRONGEST_M_S, Sample, TreeStrain, WindRods, strain_in_wind
from galewood.util import Floats
from galewood.wood import Wood

CURVE_M_S = tuple(float(speed) for speed in np.geomspace(2.5, 250.0, 40))
"""Slender trees bend as far in ordinary winds as the form does in these."""
DIRECTIONS_DEG = (0.0, 90.0, 180.0, 270.0)
CHOSEN_AT_M_S = 15.0
"""Wind in which the least favourable direction is sought."""
USUAL_RATIOS = (0.5, 2.0)
"""Range of the height and of the slenderness, over those of the form, beyond which figures are rough."""
MEDIAN_SAMPLE = Sample(1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True)
class TreeForm:
    """A tree of known size and wood, and its bending in winds (c,) m/s at its top.

    strain (c,) is the largest of the stem, moment_nm (c,) that at the ground, sway_m (c,) of the top;
    load_factor the weight over the buckling load; leaf_share that of the leaves in the moment of the wind.
    """

    name: str
    height_m: float
    dbh_m: float
    wood: Wood
    frequency_hz: float
    load_factor: float
    leaf_share: float
    streamlined_exponent: float
    wind_m_s: Floats
    strain: Floats
    moment_nm: Floats
    sway_m: Floats

    def scaled(self, height_m: float, dbh_m: float, wood: Wood) -> ScaledTree:
        """The form as a tree of another size and wood."""
        return ScaledTree(self, height_m / self.height_m, dbh_m / self.dbh_m, wood)


@dataclass(frozen=True)
class ScaledTree:
    """A tree of a form: stretched, thickened, and of a wood."""

    form: TreeForm
    stretch: float
    thickening: float
    wood: Wood

    @property
    def rough(self) -> bool:
        """Whether its figures are rough: far from the size or the slenderness of the form."""
        low, high = USUAL_RATIOS
        return not (low <= self.stretch <= high and low <= self.stretch / self.thickening <= high)

    @property
    def load_factor(self) -> float:
        """Weight over buckling load."""
        heavier = self.wood.density_kg_m3 / self.form.wood.density_kg_m3
        return self.form.load_factor * heavier * self.stretch**3 / self.thickening**2 / self._stiffer

    @property
    def pressure_factor(self) -> float:
        """Pressure in which the form bends to the same shape, over that in which this tree does."""
        return (self.stretch / self.thickening) ** 3 / self._stiffer / self._remaining()

    @property
    def frequency_hz(self) -> float:
        """First natural frequency."""
        lighter = self.form.wood.density_kg_m3 / self.wood.density_kg_m3
        scale = self.thickening / self.stretch**2 * np.sqrt(self._stiffer * lighter * self._remaining())
        return self.form.frequency_hz * float(scale)

    def strain_at(self, wind_m_s: float, shelter: float = 1.0) -> float:
        """Largest strain of the stem in a wind at its top; ``shelter`` multiplies the load."""
        return self.thickening / self.stretch * self._of_form(self.form.strain, wind_m_s, shelter)

    def sway_m(self, wind_m_s: float, shelter: float = 1.0) -> float:
        """Displacement of the top in a wind at its top, m."""
        form = self.form
        return self.stretch * min(self._of_form(form.sway_m, wind_m_s, shelter), form.height_m)

    def moment_nm(self, wind_m_s: float, shelter: float = 1.0) -> float:
        """Moment at the ground, N·m."""
        scale = self.thickening**4 / self.stretch * self._stiffer
        return scale * self._of_form(self.form.moment_nm, wind_m_s, shelter)

    def critical_m_s(self, shelter: float = 1.0, possible: Sample = MEDIAN_SAMPLE) -> float:
        """Gust at the top at which the largest strain reaches the rupture strain; inf: not up to 100 m/s."""
        return float(self.all_critical_m_s(shelter, [possible])[0])

    def all_critical_m_s(self, shelter: float, possible: Sequence[Sample]) -> Floats:
        """(n,) the same of n possible trees."""
        form = self.form
        young, rupture, own_drag, leaf_area = np.array(possible).T
        limit = rupture * self.wood.rupture_strain / young * self.stretch / self.thickening
        remaining = np.array([remaining_share(one) for one in self.load_factor / young])
        remaining /= remaining_share(self.load_factor)
        drag = own_drag * (1 + form.leaf_share * (leaf_area - 1))
        factor = shelter * drag * self.pressure_factor / young / remaining
        speeds, strains = np.concatenate([[0.0], form.wind_m_s]), np.concatenate([[0.0], form.strain])
        pressure_pa = dynamic_pressure(np.interp(limit, strains, speeds), form.streamlined_exponent) / factor
        pressure_pa *= np.maximum(limit / strains[-1], 1.0)
        found = np.array([speed_of_pressure(one, form.streamlined_exponent) for one in pressure_pa])
        return np.where(found > STRONGEST_M_S, np.inf, found)

    def _of_form(self, values: Floats, wind_m_s: float, shelter: float) -> float:
        """A value of the form in the wind that bends it to this tree's shape."""
        exponent = self.form.streamlined_exponent
        pressure_pa = float(dynamic_pressure(wind_m_s, exponent)) * shelter * self.pressure_factor
        speeds, values = (np.concatenate([[0.0], one]) for one in (self.form.wind_m_s, values))
        beyond = max(pressure_pa / float(dynamic_pressure(float(speeds[-1]), exponent)), 1.0)
        return beyond * float(np.interp(float(speed_of_pressure(pressure_pa, exponent)), speeds, values))

    @property
    def _stiffer(self) -> float:
        return self.wood.young_longitudinal_pa / self.form.wood.young_longitudinal_pa

    def _remaining(self) -> float:
        return remaining_share(self.load_factor) / remaining_share(self.form.load_factor)


def form_of_rods(name: str, rods: WindRods, dbh_m: float, frequency_hz: float) -> TreeForm:
    """Bend a tree in all winds up to 100 m/s, or until it gives way, in its least favourable direction."""
    tried = {
        direction: _largest(strain_in_wind(rods, CHOSEN_AT_M_S, direction)[0]) for direction in DIRECTIONS_DEG
    }
    direction = max(tried, key=lambda one: tried[one])
    pose, found = None, list[TreeStrain]()
    for wind in CURVE_M_S:
        try:
            strain, pose = strain_in_wind(rods, wind, direction, pose)
        except NoEquilibrium:
            break
        if found and _largest(strain) <= _largest(found[-1]):  # the crown gives way to the wind
            break
        found.append(strain)
    arm = rods.points_m[:, 1] - rods.points_m[0, 1]
    total = float(rods.drag_area_m2 @ arm)
    return TreeForm(
        name,
        float(np.ptp(rods.points_m[:, 1])),
        dbh_m,
        rods.wood,
        frequency_hz,
        rods.load_factor,
        float(rods.leaf_area_m2 @ arm) / total if total > 0 else 0.0,
        rods.streamlined_exponent,
        np.array([one.wind_m_s for one in found]),
        np.array([_largest(one) for one in found]),
        np.array([one.base_moment_nm for one in found]),
        np.array([one.top_displacement_m for one in found]),
    )


def _largest(strain: TreeStrain) -> float:
    return float(strain.strain[strain.stem].max())
