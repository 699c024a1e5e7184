"""How rods bear the weight of a tree: the rule of the finite elements (`galewood.solid.fem.remaining_share`).

Above a third of the buckling load, radii or masses are taken as wrong. For shapes that the stem takes part
in, only the share of the weight acts that leaves the tree `remaining_share` of its stiffness: the moment of
the weight in the bent pose is then as large as that of a tree that stands. Limbs that give way by
themselves are stiffened until they lose no more than the rule allows.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from galewood.solid.beams import RodBuckling, Rods, rod_buckling
from galewood.solid.fem import LARGEST_LOSS, TRUNK_LIMB, holding_limbs, remaining_share
from galewood.util import Floats, Ints

MODE_COUNT = 12
"""Ways to give way that are looked at together."""
MAX_ROUNDS = 30
LOAD_TOLERANCE = 0.01


@dataclass(frozen=True)
class StandingRods:
    """Rods with limbs that hold, and the share of the weight that acts; load factor of the whole tree."""

    rods: Rods
    load_factor: float
    weight_share: float


def standing_rods(rods: Rods, branch: Ints) -> StandingRods:
    """How rods of the branches (n,), 0 the stem, stand."""
    modes = rod_buckling(rods, MODE_COUNT)
    for _ in range(MAX_ROUNDS):
        factor = _limb_factors(modes, branch)
        if factor.max() == 1:
            break
        rods = rods.stiffened(factor[branch])
        modes = rod_buckling(rods, MODE_COUNT)
    tree = max(float(modes.load_factor[0]), 0.0)
    share = (1 - remaining_share(tree)) / tree if tree > 0 else 1.0
    return StandingRods(replace(rods, weight_n=share * rods.weight_n), tree, share)


def share_of_weight(load_factor: float, weight_share: float, stiffness_factor: float) -> float:
    """Factor by which ``weight_share`` changes if all wood is this many times as stiff."""
    as_given = load_factor / stiffness_factor
    return (1 - remaining_share(as_given)) / max(as_given * weight_share, 1e-300) if as_given > 0 else 1.0


def _limb_factors(modes: RodBuckling, branch: Ints) -> Floats:
    """Factor of the stiffness of each branch with which it does not give way alone; 1: it holds."""
    factor = np.ones(int(branch.max()) + 1)
    for load, energy in zip(modes.load_factor, modes.energy_j, strict=True):
        if load <= LARGEST_LOSS * (1 + LOAD_TOLERANCE):
            continue
        holding = holding_limbs(energy, branch)
        if TRUNK_LIMB not in holding:
            factor[holding] = np.maximum(factor[holding], load / LARGEST_LOSS)
    return factor
