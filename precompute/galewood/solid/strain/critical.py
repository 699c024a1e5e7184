"""Critical wind: the gust speed at which the largest strain of stem or boughs reaches the rupture strain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from galewood.motion.wind import check_direction
from galewood.solid.beams import BentRods, NoEquilibrium
from galewood.solid.strain.sections import (
    CAUTION_TEXT,
    Part,
    RodSections,
    Section,
    TreeStrain,
    strain_in_wind,
)
from galewood.solid.strain.spread import Sample, samples
from galewood.solid.strain.standing import share_of_weight
from galewood.solid.strain.tree_rods import WindRods, with_leaves_times
from galewood.util import Floats

DIRECTIONS_DEG = tuple(45.0 * k for k in range(8))
STRONGEST_M_S = 100.0
"""A critical wind above this is none."""
TRIED_M_S = (10.0, 20.0, 30.0, 45.0, 60.0, 80.0, STRONGEST_M_S)
"""Speeds between which a critical wind is sought; beyond the last one there is none."""
SPEED_TOLERANCE_M_S = 0.02
FIELD_SPEEDS_M_S = (5.0, 7.5, 10.0, 12.5, 15.0)
"""Speeds at which field studies measure strain, to extrapolate it with the square of the speed."""
CURVE_M_S = tuple(2.5 * k for k in range(1, 25))
QUANTILES = (0.1, 0.5, 0.9)


@dataclass(frozen=True, kw_only=True)
class CriticalOptions:
    """What a critical wind is computed for; ValueError if a value is out of range.

    ``direction_deg`` None: the least favourable of eight directions. ``knot_factor``: share of the strength
    of clear wood that knots and other defects leave. Without ``root_strength_knm`` (the largest moment that
    the roots resist) overturning is not assessed.
    """

    direction_deg: float | None = None
    knot_factor: float = 1.0
    root_strength_knm: float | None = None
    sample_count: int = 200
    seed: int = 1

    def __post_init__(self) -> None:
        if self.direction_deg is not None:
            check_direction(self.direction_deg)
        if not 0 < self.knot_factor <= 1:
            raise ValueError("knot_factor must lie above 0 and at most at 1")
        if self.root_strength_knm is not None and not 0 < self.root_strength_knm < np.inf:
            raise ValueError("root_strength_knm must be positive")
        if not 0 <= self.sample_count <= 10_000:
            raise ValueError("sample_count must lie between 0 and 10000")
        if self.seed < 0:
            raise ValueError("seed must be 0 or more")


Quantiles = tuple[float, float, float]


@dataclass(frozen=True)
class Rupture:
    """Gust speeds, m/s at the top of the tree, at which a part breaks; inf: not up to 100 m/s.

    gust_m_s is that of the mean tree: where the largest strain of the part, at ``section``, reaches the
    rupture strain in the direction in which this is soonest. samples_m_s (k,) are those of possible trees
    (`spread.py`).
    """

    direction_deg: float
    gust_m_s: float
    section: Section | None
    by_direction_m_s: dict[float, float]
    samples_m_s: Floats

    @property
    def quantiles_m_s(self) -> Quantiles | None:
        """10 %, median and 90 % of the samples; None: there are none."""
        if not len(self.samples_m_s):
            return None
        low, median, high = np.quantile(self.samples_m_s, QUANTILES, method="nearest")
        return float(low), float(median), float(high)

    def figures(self) -> dict[str, Any]:
        """All of it, JSON-able; null: not up to 100 m/s."""
        quantiles = self.quantiles_m_s or (None, None, None)
        return {
            "direction_deg": self.direction_deg,
            "gust_m_s": _finite(self.gust_m_s),
            "quantiles_m_s": dict(zip(("10 %", "median", "90 %"), map(_finite, quantiles), strict=True)),
            "sample_count": len(self.samples_m_s),
            "section": self.section and vars(self.section),
            "by_direction_m_s": {
                f"{direction:g}": _finite(v) for direction, v in self.by_direction_m_s.items()
            },
        }


@dataclass(frozen=True)
class CriticalWind:
    """Gust speeds, m/s at the top of the tree, at which a tree breaks; inf: not up to 100 m/s.

    ``stem``, and ``boughs``: where the first bough of 4 cm and more breaks (None: there are none). At breast
    height the rupture strain is reached at ``breast_height_m_s``; ``extrapolated_m_s`` is the speed of field
    studies: strain = a U², a from breast height in 5 to 15 m/s. None: the tree is lower than 1.3 m.
    overturning_m_s None: not assessed. curve (c, 3): wind, largest strain of the stem, and strain at breast
    height (NaN: none). All of these are in the direction of the stem's rupture.
    """

    rupture_strain: float
    stem: Rupture
    boughs: Rupture | None
    breast_height_m_s: float | None
    extrapolated_m_s: float | None
    overturning_m_s: float | None
    curve: Floats
    load_factor: float
    weight_share: float

    @property
    def gust_m_s(self) -> float:
        """Gust that breaks the stem of the mean tree."""
        return self.stem.gust_m_s

    @property
    def quantiles_m_s(self) -> Quantiles | None:
        """10 %, median and 90 % of the gusts that break the stems of possible trees; None: no samples."""
        return self.stem.quantiles_m_s

    def figures(self) -> dict[str, Any]:
        """All of it, JSON-able; null: not up to 100 m/s, or not assessed."""
        return {
            "rupture_strain": self.rupture_strain,
            **self.stem.figures(),
            "boughs": self.boughs and self.boughs.figures(),
            "breast_height_m_s": _finite(self.breast_height_m_s),
            "extrapolated_m_s": _finite(self.extrapolated_m_s),
            "overturning_m_s": _finite(self.overturning_m_s),
            "overturning_assessed": self.overturning_m_s is not None,
            "curve": [[_finite(float(value)) for value in row] for row in self.curve],
            "load_factor": self.load_factor,
            "weight_share": self.weight_share,
            "caution": CAUTION_TEXT,
        }


def _finite(value: float | None) -> float | None:
    return None if value is None or not np.isfinite(value) else value


def critical_wind_of(
    rods: WindRods, options: CriticalOptions, on_progress: Callable[[float], None] = lambda share: None
) -> CriticalWind:
    """The critical wind of a tree. ``on_progress`` receives the share done; what it raises ends it."""
    rupture = options.knot_factor * rods.wood.rupture_strain
    directions = DIRECTIONS_DEG if options.direction_deg is None else (options.direction_deg,)
    parts: tuple[Part, ...] = ("stem", "boughs") if RodSections(rods).bough.any() else ("stem",)
    by_direction = {part: {one: _breaks_at(rods, one, rupture, part) for one in directions} for part in parts}
    worst = {part: min(found, key=lambda one: found[one]) for part, found in by_direction.items()}
    broken: dict[Part, list[float]] = {part: [] for part in parts}
    for number, one in enumerate(samples(options.sample_count, options.seed), 1):
        possible = _possible(rods, one)
        for part in parts:
            limit = rupture * one.rupture / one.young
            broken[part].append(_breaks_at(possible, worst[part], limit, part))
        on_progress(number / options.sample_count)

    def rupture_of(part: Part) -> Rupture:
        direction, gust = worst[part], by_direction[part][worst[part]]
        at_gust = _Course(rods, direction).strain(gust) if np.isfinite(gust) else None
        section = at_gust and at_gust.largest(part)
        return Rupture(direction, gust, section, by_direction[part], np.array(broken[part]))

    course = _Course(rods, worst["stem"])
    curve = np.array([[v, *course.strains(v)] for v in CURVE_M_S])
    slope = _square_law(course.strains)
    strength = options.root_strength_knm
    at_breast = bool(np.isfinite(curve[0, 2]))
    return CriticalWind(
        rupture,
        rupture_of("stem"),
        rupture_of("boughs") if "boughs" in parts else None,
        _speed_at(rupture, lambda v: course.strains(v)[1]) if at_breast else None,
        float(np.sqrt(rupture / slope)) if at_breast else None,
        None if strength is None else _speed_at(1000 * strength, course.base_moment_nm),
        curve,
        rods.load_factor,
        rods.weight_share,
    )


class _Course:
    """A tree in winds of one direction; each pose starts from the one before."""

    def __init__(self, rods: WindRods, direction_deg: float) -> None:
        self._rods, self._direction_deg = rods, direction_deg
        self._pose: BentRods | None = None

    def strain(self, wind_m_s: float) -> TreeStrain | None:
        """Strain in a wind; None: the tree has no equilibrium, it gives way."""
        try:
            found, self._pose = strain_in_wind(self._rods, wind_m_s, self._direction_deg, self._pose)
        except NoEquilibrium:
            self._pose = None
            return None
        return found

    def strains(self, wind_m_s: float) -> tuple[float, float]:
        """Largest strain of the stem, and that at breast height (NaN: none)."""
        found = self.strain(wind_m_s)
        if found is None:
            return np.inf, np.inf
        breast = found.breast_height_strain
        return float(found.strain[found.stem].max()), np.nan if breast is None else breast

    def largest(self, wind_m_s: float, part: Part) -> float:
        """Largest strain of a part."""
        found = self.strain(wind_m_s)
        if found is None:
            return np.inf
        return float(found.strain[found.stem if part == "stem" else found.bough].max())

    def base_moment_nm(self, wind_m_s: float) -> float:
        found = self.strain(wind_m_s)
        return np.inf if found is None else found.base_moment_nm


def _breaks_at(rods: WindRods, direction_deg: float, rupture_strain: float, part: Part) -> float:
    course = _Course(rods, direction_deg)
    return _speed_at(rupture_strain, lambda wind_m_s: course.largest(wind_m_s, part))


def _speed_at(limit: float, reached: Callable[[float], float]) -> float:
    """Lowest wind, m/s, at which a value that grows with it reaches a limit; inf: none of those tried."""

    def excess(wind_m_s: float) -> float:
        return min(reached(wind_m_s), 1e9) - limit if wind_m_s > 0 else -limit  # finite where it gives way

    below = 0.0
    for above in TRIED_M_S:
        if excess(above) >= 0:
            found: Any = brentq(excess, below, above, xtol=SPEED_TOLERANCE_M_S)
            return float(found)
        below = above
    return np.inf


def _square_law(strains_at: Callable[[float], tuple[float, float]]) -> float:
    """a of strain = a U² at breast height, by least squares over the speeds of field studies."""
    squares = np.array(FIELD_SPEEDS_M_S) ** 2
    strains = np.array([strains_at(speed)[1] for speed in FIELD_SPEEDS_M_S])
    return float(squares @ strains / (squares @ squares))


def _possible(rods: WindRods, sample: Sample) -> WindRods:
    """The tree with other wood, drag and leaves."""
    rods = with_leaves_times(rods, sample.leaf_area)
    weight = share_of_weight(rods.load_factor, rods.weight_share, sample.young)
    other = rods.rods.stiffened(np.full(len(rods.radius_m), sample.young))
    return replace(
        rods,
        rods=replace(other, weight_n=weight * other.weight_n),
        drag_area_m2=sample.drag * rods.drag_area_m2,
        wood=rods.wood.scaled(sample.young),
    )
