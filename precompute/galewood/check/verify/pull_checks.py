"""Checks of pulling: the linear response of the compliance file against the nonlinear static solution."""

from collections.abc import Iterator

import numpy as np

from galewood.check.verify.checks import Check, relative
from galewood.check.verify.motion_checks import loaded_pole
from galewood.solid.fem import FemModel, TangentFactor, solve_static, tangent_factor
from galewood.util import Floats

SHARES = (0.05, 0.4)
"""Pulls to check, relative to the force at which the wood would break."""


def checks() -> Iterator[Check]:
    """All checks of this module."""
    model = loaded_pole()
    factor = tangent_factor(model)
    node = int(np.argmin(np.abs(model.nodes_m[:, 1] - 6.0)))
    for share in SHARES:
        found, exact = pulled(model, factor, node, share)
        name = f"pole pulled sideways at 3/4 of its height, {share:.0%} of the breaking force"
        yield relative(name, exact, found, "m", 0.02)


def pulled(model: FemModel, factor: TangentFactor, node: int, share: float) -> tuple[float, float]:
    """Displacement of a node pulled along x, m: by the factor, and by the nonlinear static solution."""
    at = int(factor.rank[node])
    force = share * float(factor.limit_n[at])
    load: Floats = np.zeros((factor.free, 3))
    load[at, 0] = force
    whole = model.gravity_n.copy()
    whole[node, 0] += force
    u, _, _ = solve_static(model.system(), whole)
    return float(factor.solve(load)[at, 0]), float(u[node, 0])
