"""Green wood: elastic constants, strength, density and damping of the supported species.

Wood is modelled as transversely isotropic about its fibre. The radial and tangential constants are averaged,
because the cross-section of a branch has too few tetrahedra to resolve the ring structure.

Sources, by the tag in each entry:

- ``WH``: Forest Products Laboratory, *Wood Handbook*, FPL-GTR-190 (2010), chapter 5: tables 5-1 (elastic
  ratios, at about 12 % moisture), 5-2 (Poisson's ratios), 5-3 (static bending of green wood).
- ``engdb``: engdatabase.com's reprint of the same tables (compared for sugar maple and Douglas-fir; for
  Douglas-fir also with a transcript of table 5-1 of the 2021 edition, FPL-GTR-282, page 5-2).
- ``matweb``: MatWeb, North American eastern cottonwood, unseasoned: 1,010 ksi, 49 lb/ft³.
- ``AHEC``: American Hardwood Information Center, black cherry, green: 1.31 million psi.
- ``Wytham``: the wood of the measured trees of Wytham Woods (Jackson and others, doi
  10.1016/j.agrformet.2018.11.014), quoted from a compilation; unchecked.
- ``oak drag``: wind drag of an open-grown oak through the seasons (doi 10.1093/aob/cpz026, abstract).
- ``fgr``: parameters of species of the wind-risk model ForestGALES, in its R package fgr
  (github.com/tom-locatelli/fgr, ``ud_species_parameters``): E and modulus of rupture of green wood, density
  of stems with bark, and n in the drag area ∝ U^-n of crowns in a wind tunnel: the exponent is 2 − n.
- ``CWT``: properties of black willow in a leaflet of the Center for Wood Anatomy Research (docslib.org).
- ``WH21``: the 2021 edition, FPL-GTR-282, tables 4-1 (moisture of green wood) and 5-3a (static bending), from
  a transcript of the rows for white ash and white oak.

Moduli of rupture are those of green wood in static bending, of small clear specimens. For oak, ash, birch and
sycamore they are E times the rupture strains 0.0069, 0.0070, 0.0074 and 0.0079 with which the critical winds
of the measured trees were computed (``Wytham``). The others are those of the wood that stands in for the
species, as table 5-3 of ``WH`` has them: eastern cottonwood 5,300 psi (``matweb``), sugar maple 65 MPa and
Douglas-fir, interior south 47 MPa (``engdb``), black cherry 8,000 psi (``AHEC``); American sycamore 6,500 psi
is quoted from memory, unchecked.

Values without a second source are marked "unchecked" in the entry: the ratios of cottonwood and black cherry,
those of ash, birch, oak, beech, spruce, pine and larch, and all constants of plane. Unchecked ratios of ash,
birch, oak, beech, spruce, pine, larch and plane are quoted from memory, with no copy of the handbook at hand
to compare them with; their ν_TT is the geometric mean of ν_RT and ν_TR. The influence of
the ratios is small: changing the transverse stiffness by 30 % changes the first ten frequencies by at most
1.6 %, changing the shear stiffness by 30 % by 2 to 10 % (docs/physics.md). The handbook's bending moduli
include some shear deflection; it recommends adding 10 % to obtain the true E_L. This is not done here,
because the spread between trees (22 % of the mean) is larger.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

LEAF_EXPONENT = 1.3
"""Streamlined exponent of a tree in leaf: 2 + Vogel exponent (−0.7), said to be the middle of the range of
wind-tunnel tests of broad-leaved crowns."""
BARE_EXPONENT = 2.0
"""The same of a bare tree: wood does not streamline. Measured on an oak: 1.9 to 2.0 (``oak drag``)."""


@dataclass(frozen=True, kw_only=True)
class Wood:
    """Constants of green wood; ratios are relative to the longitudinal modulus.

    ``streamlined_exponent`` is that of a tree in leaf: its wind load grows with this power of the wind speed
    above 5 m/s. Bare trees have ``BARE_EXPONENT``. ``modulus_of_rupture_pa`` is the bending strength.
    ``evergreen`` trees keep their leaves or needles in winter and are never bare.
    """

    name: str
    young_longitudinal_pa: float
    radial_ratio: float
    tangential_ratio: float
    shear_lr_ratio: float
    shear_lt_ratio: float
    poisson_longitudinal: float
    poisson_transverse: float
    density_kg_m3: float
    modulus_of_rupture_pa: float
    damping_ratio: float
    drag_coefficient: float
    source: str
    streamlined_exponent: float = LEAF_EXPONENT
    evergreen: bool = False

    def __post_init__(self) -> None:
        positive = (
            self.young_longitudinal_pa,
            self.radial_ratio,
            self.tangential_ratio,
            self.shear_lr_ratio,
            self.shear_lt_ratio,
            self.density_kg_m3,
            self.modulus_of_rupture_pa,
        )
        if not all(0 < value < float("inf") for value in positive):
            raise ValueError(f"{self.name}: moduli, ratios, density and strength must be positive and finite")
        if not 0 < self.damping_ratio < 1:
            raise ValueError(f"{self.name}: the damping ratio must lie between 0 and 1")
        if not 1 <= self.streamlined_exponent <= 2:
            raise ValueError(f"{self.name}: the streamlined exponent must lie between 1 and 2")
        if not self.is_stable():
            raise ValueError(f"{self.name}: the wood is unstable with these Poisson's ratios")

    @property
    def rupture_strain(self) -> float:
        """Bending strain at which sound green wood breaks: modulus of rupture over E."""
        return self.modulus_of_rupture_pa / self.young_longitudinal_pa

    @property
    def young_transverse_pa(self) -> float:
        """Mean of the radial and tangential moduli, Pa."""
        return self.young_longitudinal_pa * (self.radial_ratio + self.tangential_ratio) / 2

    @property
    def shear_longitudinal_pa(self) -> float:
        """Mean of the two shear moduli along the fibre, Pa."""
        return self.young_longitudinal_pa * (self.shear_lr_ratio + self.shear_lt_ratio) / 2

    @property
    def shear_transverse_pa(self) -> float:
        """Shear modulus across the fibre, Pa, determined by transverse isotropy."""
        return self.young_transverse_pa / (2 * (1 + self.poisson_transverse))

    def scaled(self, stiffness_factor: float) -> Wood:
        """This wood with all moduli times a factor, which its name tells. ValueError if not positive."""
        if stiffness_factor == 1:
            return self
        return replace(
            self,
            name=f"{self.name}, stiffness × {stiffness_factor:.2g}",
            young_longitudinal_pa=self.young_longitudinal_pa * stiffness_factor,
        )

    def is_stable(self) -> bool:
        """Whether the strain energy is positive for every strain (Lempriere, AIAA Journal 6, 1968)."""
        ratio = self.young_transverse_pa / self.young_longitudinal_pa
        return (
            abs(self.poisson_transverse) < 1
            and 1 - self.poisson_transverse - 2 * self.poisson_longitudinal**2 * ratio > 0
        )


SPECIES: dict[str, Wood] = {
    wood.name: wood
    for wood in (
        Wood(
            name="poplar",
            young_longitudinal_pa=7.0e9,
            radial_ratio=0.083,
            tangential_ratio=0.047,
            shear_lr_ratio=0.076,
            shear_lt_ratio=0.052,
            poisson_longitudinal=0.38,
            poisson_transverse=0.55,
            density_kg_m3=785.0,
            modulus_of_rupture_pa=37e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="eastern cottonwood: E, density green (WH 5-3, matweb); ratios WH 5-1, 5-2 (unchecked)",
        ),
        Wood(
            name="maple",
            young_longitudinal_pa=10.7e9,
            radial_ratio=0.132,
            tangential_ratio=0.065,
            shear_lr_ratio=0.111,
            shear_lt_ratio=0.063,
            poisson_longitudinal=0.45,
            poisson_transverse=0.52,
            density_kg_m3=940.0,
            modulus_of_rupture_pa=65e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="sugar maple: E green, ratios (WH 5-1 to 5-3, engdb); green density from "
            "specific gravity 0.56 and about 68 % moisture",
        ),
        Wood(
            name="apricot",
            young_longitudinal_pa=9.0e9,
            radial_ratio=0.197,
            tangential_ratio=0.086,
            shear_lr_ratio=0.147,
            shear_lt_ratio=0.097,
            poisson_longitudinal=0.41,
            poisson_transverse=0.53,
            density_kg_m3=920.0,
            modulus_of_rupture_pa=55e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="black cherry stands in for apricot: E green (WH 5-3, AHEC); ratios WH 5-1, 5-2 "
            "(unchecked); density of green apricot estimated from its basic specific gravity 0.58 "
            "(The Wood Database)",
        ),
        Wood(
            name="conifer",
            young_longitudinal_pa=8.0e9,
            radial_ratio=0.068,
            tangential_ratio=0.050,
            shear_lr_ratio=0.064,
            shear_lt_ratio=0.078,
            poisson_longitudinal=0.37,
            poisson_transverse=0.38,
            density_kg_m3=690.0,
            modulus_of_rupture_pa=47e6,
            damping_ratio=0.04,
            drag_coefficient=0.45,
            source="Douglas-fir, interior south: E green, ratios (WH 5-1 to 5-3, engdb); density green "
            "43 lb/ft³ (Oregon State University, table of working properties)",
            evergreen=True,
        ),
        Wood(
            name="spruce",
            young_longitudinal_pa=6.3e9,
            radial_ratio=0.128,
            tangential_ratio=0.059,
            shear_lr_ratio=0.124,
            shear_lt_ratio=0.120,
            poisson_longitudinal=0.44,
            poisson_transverse=0.36,
            density_kg_m3=850.0,
            modulus_of_rupture_pa=36e6,
            damping_ratio=0.04,
            drag_coefficient=0.45,
            source="Norway spruce grown in Britain: E, strength and density green, drag of the crown as "
            "U^1.49 (fgr); ratios of Engelmann spruce (WH 5-1, 5-2, unchecked)",
            streamlined_exponent=1.49,
            evergreen=True,
        ),
        Wood(
            name="pine",
            young_longitudinal_pa=7.3e9,
            radial_ratio=0.088,
            tangential_ratio=0.044,
            shear_lr_ratio=0.096,
            shear_lt_ratio=0.081,
            poisson_longitudinal=0.33,
            poisson_transverse=0.36,
            density_kg_m3=850.0,
            modulus_of_rupture_pa=46e6,
            damping_ratio=0.04,
            drag_coefficient=0.45,
            source="Scots pine grown in Britain: E, strength and density green, drag of the crown as U^1.25 "
            "(fgr); ratios of red pine (WH 5-1, 5-2, unchecked)",
            streamlined_exponent=1.25,
            evergreen=True,
        ),
        Wood(
            name="larch",
            young_longitudinal_pa=7.9e9,
            radial_ratio=0.079,
            tangential_ratio=0.065,
            shear_lr_ratio=0.063,
            shear_lt_ratio=0.069,
            poisson_longitudinal=0.32,
            poisson_transverse=0.37,
            density_kg_m3=850.0,
            modulus_of_rupture_pa=53e6,
            damping_ratio=0.04,
            drag_coefficient=0.45,
            source="European larch grown in Britain: E, strength and density green, drag of the crown as "
            "U^1.25 (fgr: as Scots pine); ratios of western larch (WH 5-1, 5-2, unchecked)",
            streamlined_exponent=1.25,
        ),
        Wood(
            name="willow",
            young_longitudinal_pa=5.4e9,
            radial_ratio=0.083,
            tangential_ratio=0.047,
            shear_lr_ratio=0.076,
            shear_lt_ratio=0.052,
            poisson_longitudinal=0.38,
            poisson_transverse=0.55,
            density_kg_m3=800.0,
            modulus_of_rupture_pa=33e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="black willow: E 0.79 and strength 0.0048 million psi green (CWT); density green about "
            "50 lb/ft³ (unchecked); ratios of cottonwood, of the same family (WH 5-1, 5-2, unchecked)",
        ),
        Wood(
            name="ash",
            young_longitudinal_pa=9.5e9,
            radial_ratio=0.125,
            tangential_ratio=0.080,
            shear_lr_ratio=0.109,
            shear_lt_ratio=0.077,
            poisson_longitudinal=0.41,
            poisson_transverse=0.50,
            density_kg_m3=801.0,
            modulus_of_rupture_pa=66.5e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="European ash: E and density green (Wytham); ratios of white ash (WH 5-1, 5-2, unchecked)",
        ),
        Wood(
            name="birch",
            young_longitudinal_pa=8.5e9,
            radial_ratio=0.078,
            tangential_ratio=0.050,
            shear_lr_ratio=0.074,
            shear_lt_ratio=0.068,
            poisson_longitudinal=0.44,
            poisson_transverse=0.54,
            density_kg_m3=801.0,
            modulus_of_rupture_pa=62.9e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="European birch: E and density green (Wytham); ratios of yellow birch (WH 5-1, 5-2, "
            "unchecked)",
        ),
        Wood(
            name="oak",
            young_longitudinal_pa=10.5e9,
            radial_ratio=0.163,
            tangential_ratio=0.072,
            shear_lr_ratio=0.086,
            shear_lt_ratio=0.081,
            poisson_longitudinal=0.40,
            poisson_transverse=0.43,
            density_kg_m3=865.0,
            modulus_of_rupture_pa=72.5e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="European oak: E and density green (Wytham); ratios of white oak (WH 5-1, 5-2, "
            "unchecked), G_LT/E_L of red oak, as white oak has none; "
            "load in leaf as U^1.6 to U^1.68 (oak drag)",
            streamlined_exponent=1.64,
        ),
        Wood(
            name="beech",
            young_longitudinal_pa=9.8e9,
            radial_ratio=0.163,
            tangential_ratio=0.083,
            shear_lr_ratio=0.117,
            shear_lt_ratio=0.077,
            poisson_longitudinal=0.48,
            poisson_transverse=0.52,
            density_kg_m3=940.0,
            modulus_of_rupture_pa=65e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="European beech: E and strength green (fgr; American beech has 9.5 GPa and 59 MPa, "
            "WH 5-3); ratios of European beech after R. F. S. Hearmon (unchecked); green density from the "
            "specific gravity 0.56 of American beech (WH 5-3) and about 68 % moisture",
        ),
        Wood(
            name="sycamore",
            young_longitudinal_pa=8.4e9,
            radial_ratio=0.132,
            tangential_ratio=0.065,
            shear_lr_ratio=0.111,
            shear_lt_ratio=0.063,
            poisson_longitudinal=0.45,
            poisson_transverse=0.52,
            density_kg_m3=721.0,
            modulus_of_rupture_pa=66.4e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="European sycamore, a maple: E and density green (Wytham); ratios of sugar maple (WH 5-1, "
            "5-2)",
        ),
        Wood(
            name="plane",
            young_longitudinal_pa=7.3e9,
            radial_ratio=0.115,
            tangential_ratio=0.050,
            shear_lr_ratio=0.089,
            shear_lt_ratio=0.061,
            poisson_longitudinal=0.36,
            poisson_transverse=0.46,
            density_kg_m3=930.0,
            modulus_of_rupture_pa=45e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="American sycamore, a plane: E green (WH 5-3, "
            "unchecked); ratios of sweetgum, as sycamore has none (WH 5-1, 5-2, unchecked); density green of "
            "wood and bark 58 lb/ft³ (spikevm.com, table of green log weights, unchecked)",
        ),
        Wood(
            name="default",
            young_longitudinal_pa=9.5e9,
            radial_ratio=0.14,
            tangential_ratio=0.07,
            shear_lr_ratio=0.11,
            shear_lt_ratio=0.07,
            poisson_longitudinal=0.42,
            poisson_transverse=0.5,
            density_kg_m3=880.0,
            modulus_of_rupture_pa=60e6,
            damping_ratio=0.03,
            drag_coefficient=0.5,
            source="the middle of the hardwoods above, for a tree whose species is not known",
        ),
    )
}

ALIASES = {
    "aspen": "poplar",
    "cottonwood": "poplar",
    "cherry": "apricot",
    "fir": "conifer",
    "hardwood": "default",
}


def wood_of_species(name: str) -> Wood:
    """The wood of a species by name or alias. Raises KeyError with the known names."""
    key = name.strip().lower()
    key = ALIASES.get(key, key)
    if key not in SPECIES:
        raise KeyError(f"unknown species {name!r}; known: {', '.join(sorted(SPECIES))}")
    return SPECIES[key]


def is_evergreen(name: str | None) -> bool:
    """Whether a species, by name or alias, keeps its leaves in winter; False for unknown ones."""
    key = (name or "").strip().lower()
    wood = SPECIES.get(ALIASES.get(key, key))
    return wood is not None and wood.evergreen
