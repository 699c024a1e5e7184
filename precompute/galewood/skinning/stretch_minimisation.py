"""Places that hold the bark, moved together so that a bend is shared by all edges around it.

Where a thick limb bends, as above the flare of a trunk, no single vertex can move without stretching its
other edges. So the places of all vertices around stretched edges are found at once: each slides along the way
from the root through its branch, and the sum of a power of the excess stretches is minimised.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from galewood.model import AxisPaths
from galewood.table import turned
from galewood.util import Floats, Ints

FREE = 1.02
"""Length of an edge, relative to rest, that costs nothing."""
POWER = 3
RINGS = 8
"""Vertices so many edges away from a stretched one slide too."""
STEPS = 120
PROBE = 1e-4
"""Step of the difference quotient, relative to the typical length of an edge."""


@dataclass(frozen=True)
class AxisPoses:
    """k poses of an axis: displacement (p, 3, k), m, and rotation vectors (p, 3, k) of its points."""

    moved_m: Floats
    turned: Floats


def drawn_at(place_m: Floats, child: Ints, mark_m: Floats, paths: AxisPaths, poses: AxisPoses) -> Floats:
    """(v, k, 3) where vertices at place_m (v, 3) are drawn if they are held at places of the axis (v,)."""
    feet = paths.feet(child, mark_m, np.zeros(len(child)))
    up, share = paths.parent[child], feet.share[:, None, None]
    moved = (1 - share) * poses.moved_m[up] + share * poses.moved_m[child]
    turn = (1 - share) * poses.turned[up] + share * poses.turned[child]
    arm = np.broadcast_to((place_m - feet.at_m)[:, None], (len(child), moved.shape[2], 3))
    return feet.at_m[:, None] + moved.transpose(0, 2, 1) + turned(arm, turn.transpose(0, 2, 1))


@dataclass(frozen=True)
class Skin:
    """Vertices place_m (v, 3) joined by edges ends (e, 2) of a length at rest (e,), m."""

    place_m: Floats
    ends: Ints
    length_m: Floats

    def around(self, edges: Ints, rings: int) -> Ints:
        """The vertices of some edges, and those that are at most so many edges away."""
        count = len(self.place_m)
        both = np.concatenate([self.ends, self.ends[:, ::-1]])
        near = csr_matrix((np.ones(len(both), bool), (both[:, 0], both[:, 1])), shape=(count, count))
        found = np.zeros(count, bool)
        found[self.ends[edges]] = True
        for _ in range(rings):
            found |= near @ found
        return np.flatnonzero(found)


def spread(
    skin: Skin,
    child: Ints,
    mark_m: Floats,
    stretched: Ints,
    still: np.ndarray,
    paths: AxisPaths,
    poses: AxisPoses,
) -> tuple[Ints, Floats]:
    """The places (v,) of the vertices of a skin, slid so that stretched edges (s,) are stretched less.

    Vertices that are ``still`` (v,) keep their places.
    """
    around = skin.around(stretched, RINGS)
    free = around[~still[around]]
    if not len(free):
        return child, mark_m
    return Slide(skin, child, mark_m, free, paths, poses).places()


class Slide:
    """Some vertices of a skin, each free to slide between the root and the end of its branch."""

    def __init__(
        self, skin: Skin, child: Ints, mark_m: Floats, free: Ints, paths: AxisPaths, poses: AxisPoses
    ) -> None:
        self._skin, self._child, self._mark = skin, child, mark_m
        self._free, self._paths, self._poses = free, paths, poses
        index = np.full(len(child), -1)
        index[free] = np.arange(len(free))
        own = (index[skin.ends] >= 0).any(axis=1)
        self._ends, self._length = index[skin.ends[own]], skin.length_m[own]
        self._still = drawn_at(skin.place_m, child, mark_m, paths, poses)[skin.ends[own]]
        self._tip = paths.line_ends[child[free]]
        self.unit_m = max(float(np.median(self._length)), 1e-9)

    def places(self) -> tuple[Ints, Floats]:
        """Minimises the cost from the places given."""
        start = self._mark[self._free]
        root, end = self._paths.mark_m[self._paths.roots[self._tip]], self._paths.mark_m[self._tip]
        found = minimize(
            self.cost, start / self.unit_m, jac=True, method="L-BFGS-B",
            bounds=np.stack([root, end], axis=1) / self.unit_m, options={"maxiter": STEPS, "maxcor": 20},
        )  # fmt: skip
        child, mark = self._child.copy(), self._mark.copy()
        mark[self._free] = found.x * self.unit_m
        child[self._free] = self._paths.on_way(self._tip, mark[self._free])
        return child, mark

    def _drawn(self, mark_m: Floats) -> Floats:
        child = self._paths.on_way(self._tip, mark_m)
        return drawn_at(self._skin.place_m[self._free], child, mark_m, self._paths, self._poses)

    def cost(self, scaled: Floats) -> tuple[float, Floats]:
        """The cost of places, and its slope (f,)."""
        mark = scaled * self.unit_m
        now = self._drawn(mark)
        step = PROBE * self.unit_m
        slope = (self._drawn(mark + step) - now) / step  # (f, k, 3)
        place = np.where((self._ends >= 0)[:, :, None, None], now[self._ends], self._still)
        apart = place[:, 1] - place[:, 0]  # (e, k, 3)
        length = np.linalg.norm(apart, axis=2)
        excess = np.maximum(length / self._length[:, None] - FREE, 0.0)
        pull = POWER * excess ** (POWER - 1) / (self._length[:, None] * np.maximum(length, 1e-12))
        pull = pull[:, :, None] * apart
        total = np.zeros(len(mark))
        for side, sign in ((0, -1.0), (1, 1.0)):
            own = self._ends[:, side] >= 0
            at = self._ends[own, side]
            total += np.bincount(at, sign * (pull[own] * slope[at]).sum(axis=(1, 2)), len(mark))
        return 1e6 * float((excess**POWER).sum()), 1e6 * self.unit_m * total
