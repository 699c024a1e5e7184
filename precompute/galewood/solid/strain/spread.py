"""Spread of what the critical wind of a tree depends on, and samples of it.

- E and modulus of rupture: coefficients of variation of clear green wood, 0.22 and 0.16: ASTM
  D2555 has 0.21 and 0.16 for white fir, 0.22 and 0.16 for western hemlock, 0.18 and 0.19 for black cottonwood
  (from a transcript of its table). Dry logs of Irish ash, birch and sycamore from thinnings: 0.14 to 0.24 and
  0.12 to 0.18 (doi 10.1007/s13595-020-00957-x, table 4; read). Their correlation, 0.7, is assumed.
- Drag: the coefficients of three broad-leaved species, on their frontal area in still air, were 0.15 to 0.22
  at 20 m/s (Vollsinger and others, Canadian Journal of Forest Research 35, 2005; abstract read). The
  coefficient of variation of 0.25 is assumed to cover this and the tree's shelter.
- Leaf area: 0.3, assumed.

All are lognormal with the median 1.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from galewood.util import Floats

VARIATION_COEFFICIENTS = {"young": 0.22, "rupture": 0.16, "drag": 0.25, "leaf_area": 0.3}
"""Coefficients of variation."""
WOOD_CORRELATION = 0.7
"""Of E and modulus of rupture, on logarithmic scales."""


class Sample(NamedTuple):
    """Factors of one possible tree."""

    young: float
    rupture: float
    drag: float
    leaf_area: float


def samples(count: int, seed: int) -> list[Sample]:
    """``count`` possible trees; the same seed gives the same ones."""
    deviation = np.sqrt(np.log1p(np.array([VARIATION_COEFFICIENTS[name] for name in Sample._fields]) ** 2))
    normal = np.random.default_rng(seed).normal(size=(count, len(deviation)))
    normal[:, 1] = WOOD_CORRELATION * normal[:, 0] + np.sqrt(1 - WOOD_CORRELATION**2) * normal[:, 1]
    factors: Floats = np.exp(normal * deviation)
    return [Sample(*map(float, row)) for row in factors]
