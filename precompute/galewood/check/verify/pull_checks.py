"""Checks of pulling: the linear response of the compliance file against the nonlinear static solution.

A linear displacement is straight, while a pole moves on an arc. At 40 % of the breaking force, the most that
a hand may pull with, this slender pole bends by a seventh of its height, and the linear displacement of the
pulled point is 5.5 % too long. That is no error of the elements: the elastica says the same. So the small
pull is compared with the nonlinear solution, and at the large one the excess of the linear response with that
of the elastica.

The nonlinear solution is the mean of pulls to both sides. The corotational force of elements that are longer
than thick has an error that changes its sign with the side (docs/physics.md, "Static equilibrium"), of 1.2 %.
"""

from collections.abc import Iterator

import numpy as np

from galewood.check.verify.bars import polygon_bar
from galewood.check.verify.checks import Check, relative
from galewood.check.verify.motion_checks import (
    CROWN_FROM_M,
    CROWN_MASS_KG,
    PLATE_WOOD,
    POLE_LENGTH_M,
    POLE_RADIUS_M,
    POLE_TIP_RADIUS_M,
    loaded_pole,
)
from galewood.check.verify.pulled_pole import PROFILE_POINTS, PulledPole
from galewood.constants import PULL_FORCE_SHARE
from galewood.solid.fem import FemModel, TangentFactor, solve_static, tangent_factor
from galewood.solid.model import GRAVITY_M_S2
from galewood.util import Floats

SMALL_SHARE = 0.05
"""A small pull over the force at which the wood would break; the largest is PULL_FORCE_SHARE."""
SMALL_LIMIT, EXCESS_LIMIT = 0.002, 0.002


def checks() -> Iterator[Check]:
    """All checks of this module."""
    model = loaded_pole()
    factor = tangent_factor(model)
    node = int(np.argmin(np.abs(model.nodes_m[:, 1] - 0.75 * POLE_LENGTH_M)))
    name = "pole pulled sideways at 3/4 of its height"
    found, exact = pulled(model, factor, node, SMALL_SHARE)
    yield relative(f"{name}, {SMALL_SHARE:.0%} of the breaking force", exact, found, "m", SMALL_LIMIT)
    found, bent = pulled(model, factor, node, PULL_FORCE_SHARE)
    excess = linear_excess(found, float(model.nodes_m[node, 1]))
    yield relative(
        f"{name}, {PULL_FORCE_SHARE:.0%}: linear over nonlinear displacement", excess, found / bent, "–",
        EXCESS_LIMIT, f"exact: elastica; it moves by {bent / POLE_LENGTH_M:.0%} of the height",
    )  # fmt: skip


def pulled(model: FemModel, factor: TangentFactor, node: int, share: float) -> tuple[float, float]:
    """Displacement of a node pulled along x, m: by the factor, and by the nonlinear static solution.

    Both are means of a pull to either side.
    """
    at = int(factor.rank[node])
    force = share * float(factor.limit_n[at])
    load: Floats = np.zeros((factor.free, 3))
    load[at, 0] = force
    system, sides = model.system(), list[float]()
    for side in (1.0, -1.0):
        whole = model.gravity_n.copy()
        whole[node, 0] += side * force
        u, _, _ = solve_static(system, whole)
        sides.append(side * float(u[node, 0]))
    return float(factor.solve(load)[at, 0]), float(np.mean(sides))


def linear_excess(linear_m: float, pulled_at_m: float) -> float:
    """Linear over nonlinear displacement of the pole by beam theory, where the linear one is ``linear_m``."""
    pole = laden_elastica(pulled_at_m)
    unit = pole.sway_m(1.0, linear=True)
    return linear_m / pole.sway_m(linear_m / unit)


def laden_elastica(pulled_at_m: float) -> PulledPole:
    """The pole of ``loaded_pole`` as a beam."""
    foot = polygon_bar(sides=6, radius_m=POLE_RADIUS_M, length_m=POLE_LENGTH_M, layers=1)
    height_m = np.linspace(0.0, POLE_LENGTH_M, PROFILE_POINTS)
    radius = 1.0 + (POLE_TIP_RADIUS_M / POLE_RADIUS_M - 1.0) * height_m / POLE_LENGTH_M
    crown_kg_m = np.where(height_m > CROWN_FROM_M, CROWN_MASS_KG / (POLE_LENGTH_M - CROWN_FROM_M), 0.0)
    load_n_m = GRAVITY_M_S2 * (PLATE_WOOD.density_kg_m3 * foot.area_m2 * radius**2 + crown_kg_m)
    spans = 0.5 * (load_n_m[1:] + load_n_m[:-1]) * np.diff(height_m)
    weight_n = np.concatenate([np.cumsum(spans[::-1])[::-1], [0.0]])
    bending = PLATE_WOOD.young_longitudinal_pa * foot.second_moment_m4 * radius**4
    return PulledPole(height_m=height_m, bending_n_m2=bending, weight_n=weight_n, pulled_at_m=pulled_at_m)
