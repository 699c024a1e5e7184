"""Height curves: the height of a tree from its diameter, where only the diameter was measured."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from galewood.constants import BREAST_HEIGHT_M

FEWEST_PAIRS = 10
"""Measured pairs of diameter and height that a curve is fitted to."""
SMALLEST_RATIO_OF_DIAMETERS = 1.5
"""Of the largest to the smallest diameter of a curve: pairs of trees that are alike determine none."""


@dataclass(frozen=True)
class HeightCurve:
    """Petterson's curve h = 1.3 m + (d / (a + b d))³, fitted to measured pairs."""

    species: str
    """As in the file; empty: all species together."""
    a: float
    """m^(2/3)."""
    b: float
    """m^(−1/3)."""
    pairs: int
    residual_m: float
    """Root mean square of measured less fitted heights."""

    def height_m(self, dbh_m: float) -> float:
        """The height (m) at a diameter (m)."""
        return BREAST_HEIGHT_M + (dbh_m / (self.a + self.b * dbh_m)) ** 3


def assumed_height_m(dbh_m: float) -> float:
    """Height of a tree of this diameter: 1.3 m + 30 m (1 − exp(−d / 0.28 m)); assumed, for closed stands."""
    return BREAST_HEIGHT_M + 30.0 * (1.0 - math.exp(-dbh_m / 0.28))


def fitted_curves(measured: Iterable[tuple[str, float, float]]) -> dict[str, HeightCurve]:
    """The curve of each species with enough pairs, and that of all together under "".

    ``measured``: species, diameter and height (m) of each tree. The curve is fitted as
    d / (h − 1.3 m)^(1/3) = a + b d by least squares (Petterson 1955;
    Kramer and Akça, *Leitfaden zur Waldmesslehre*).
    """
    groups: dict[str, list[tuple[float, float]]] = {}
    for species, dbh_m, height_m in measured:
        if height_m > BREAST_HEIGHT_M:
            for name in {species, ""}:
                groups.setdefault(name, []).append((dbh_m, height_m))
    curves = {name: _fitted(name, pairs) for name, pairs in groups.items()}
    return {name: curve for name, curve in curves.items() if curve is not None}


def _fitted(species: str, pairs: list[tuple[float, float]]) -> HeightCurve | None:
    """None if the pairs are too few or too alike, or give no curve that rises towards a greatest height."""
    dbh_m, height_m = np.array(pairs).T
    if len(pairs) < FEWEST_PAIRS or dbh_m.max() < SMALLEST_RATIO_OF_DIAMETERS * dbh_m.min():
        return None
    b, a = np.polyfit(dbh_m, dbh_m / np.cbrt(height_m - BREAST_HEIGHT_M), 1)
    if a <= 0.0 or b <= 0.0:
        return None
    curve = HeightCurve(species, float(a), float(b), len(pairs), 0.0)
    left = height_m - np.array([curve.height_m(d) for d in dbh_m])
    return replace(curve, residual_m=float(np.sqrt(np.mean(left**2))))
