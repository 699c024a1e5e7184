"""Bindings moved together so that a bend is shared by all edges around it: least stretch in some poses.

Where a thick limb bends, as above the flare of a trunk, no single vertex can move without stretching its
other edges. So the bindings of all vertices around stretched edges are found at once: each slides along the
path from the root through its branch, and the sum of a power of the excess stretches is minimised.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import AxisPaths, Bindings
from galewood.solid.skinning.node_poses import limit_stretch, turned
from galewood.util import Floats, Ints

FREE_STRETCH = 1.02
"""Length of an edge, relative to rest, that costs nothing."""
COST_POWER = 3
SLIDING_RINGS = 8
"""Vertices so many edges away from a stretched one slide too."""
MOST_ITERATIONS = 120
DIFFERENCE_STEP = 1e-4
"""Step of the difference quotient, relative to the typical length of an edge."""


@dataclass(frozen=True)
class AxisPoses:
    """k poses of an axis: displacement (p, 3, k), m, and rotation vectors (p, 3, k) of its points."""

    moved_m: Floats
    turned: Floats

    def some(self, own: Ints) -> AxisPoses:
        """Some of the poses."""
        return AxisPoses(self.moved_m[:, :, own], self.turned[:, :, own])


def axis_poses(axis: Axis, basis: Floats, poses: Floats) -> AxisPoses:
    """The poses (k, r) of a model's particles with the modes ``basis`` (N, 3, r), as they are drawn.

    The stretch of links is limited as between the nodes of a table (``limit_stretch``).
    """
    moved, stretch = limit_stretch(axis.points_m, axis.parent, axis.displacement(basis) @ poses.T)
    return AxisPoses(moved, (axis.rotation(basis) @ poses.T) / stretch[:, None])


def posed_positions(
    place_m: Floats, child: Ints, arc_m: Floats, paths: AxisPaths, poses: AxisPoses
) -> Floats:
    """(v, k, 3) where vertices at place_m (v, 3) are drawn if they are bound to places of the axis (v,)."""
    bound = paths.bindings(child, arc_m, np.zeros(len(child)))
    up, share = paths.parent[child], bound.share[:, None, None]
    moved = (1 - share) * poses.moved_m[up] + share * poses.moved_m[child]
    turn = (1 - share) * poses.turned[up] + share * poses.turned[child]
    arm = np.broadcast_to((place_m - bound.at_m)[:, None], (len(child), moved.shape[2], 3))
    return bound.at_m[:, None] + moved.transpose(0, 2, 1) + turned(arm, turn.transpose(0, 2, 1))


@dataclass(frozen=True)
class EdgeMesh:
    """Vertices place_m (v, 3) joined by edges ends (e, 2) of a length at rest (e,), m."""

    place_m: Floats
    ends: Ints
    length_m: Floats

    def stretch(self, place_m: Floats) -> Floats:
        """(e, k) length of the edges over that at rest, for vertices at place_m (v, k, 3)."""
        apart = place_m[self.ends[:, 0]] - place_m[self.ends[:, 1]]
        return np.linalg.norm(apart, axis=2) / self.length_m[:, None]

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


def hardest_poses(
    mesh: EdgeMesh, bindings: Bindings, paths: AxisPaths, poses: AxisPoses, count: int
) -> AxisPoses:
    """Those poses that together stretch the edges most: each adds the most to those before it."""
    if poses.moved_m.shape[2] <= count:
        return poses
    places = paths.places(bindings)
    each = [poses.some(np.array([k])) for k in range(poses.moved_m.shape[2])]  # one by one: large meshes
    ratio = [mesh.stretch(posed_positions(mesh.place_m, *places, paths, one))[:, 0] for one in each]
    excess = np.maximum(np.column_stack(ratio) - 1.0, 0.0) ** COST_POWER  # (e, k)
    covered, chosen = np.zeros(len(excess)), list[int]()
    for _ in range(count):
        chosen.append(int(np.maximum(excess, covered[:, None]).sum(axis=0).argmax()))
        covered = np.maximum(covered, excess[:, chosen[-1]])
    return poses.some(np.unique(chosen))


class StretchMinimisation:
    """Some vertices of a mesh, each free to slide between the root and the end of its branch."""

    def __init__(
        self, mesh: EdgeMesh, child: Ints, arc_m: Floats, free: Ints, paths: AxisPaths, poses: AxisPoses
    ) -> None:
        """All vertices are bound to places (v,); those that are ``free`` (f,) slide."""
        self._mesh, self._child, self._arc = mesh, child, arc_m
        self._free, self._paths, self._poses = free, paths, poses
        index = np.full(len(child), -1)
        index[free] = np.arange(len(free))
        own = (index[mesh.ends] >= 0).any(axis=1)
        self._ends, self._length = index[mesh.ends[own]], mesh.length_m[own]
        self._fixed = posed_positions(mesh.place_m, child, arc_m, paths, poses)[mesh.ends[own]]
        self._tip = paths.line_ends[child[free]]
        self.unit_m = max(float(np.median(self._length)), 1e-9)

    def places(self) -> tuple[Ints, Floats]:
        """The places (v,) of all vertices at the least cost, sought by L-BFGS from the places given."""
        start = self._arc[self._free]
        root, end = self._paths.arc_m[self._paths.roots[self._tip]], self._paths.arc_m[self._tip]
        found = minimize(
            self.cost, start / self.unit_m, jac=True, method="L-BFGS-B",
            bounds=np.stack([root, end], axis=1) / self.unit_m,
            options={"maxiter": MOST_ITERATIONS, "maxcor": 20},
        )  # fmt: skip
        child, arc = self._child.copy(), self._arc.copy()
        arc[self._free] = found.x * self.unit_m
        child[self._free] = self._paths.links_towards(self._tip, arc[self._free])
        return child, arc

    def _posed(self, arc_m: Floats) -> Floats:
        child = self._paths.links_towards(self._tip, arc_m)
        return posed_positions(self._mesh.place_m[self._free], child, arc_m, self._paths, self._poses)

    def cost(self, scaled: Floats) -> tuple[float, Floats]:
        """The cost of places at arc lengths in units of ``unit_m``, and its gradient (f,)."""
        arc = scaled * self.unit_m
        now = self._posed(arc)
        step = DIFFERENCE_STEP * self.unit_m
        slope = (self._posed(arc + step) - now) / step  # (f, k, 3)
        place = np.where((self._ends >= 0)[:, :, None, None], now[self._ends], self._fixed)
        apart = place[:, 1] - place[:, 0]  # (e, k, 3)
        length = np.linalg.norm(apart, axis=2)
        excess = np.maximum(length / self._length[:, None] - FREE_STRETCH, 0.0)
        pull = COST_POWER * excess ** (COST_POWER - 1) / (self._length[:, None] * np.maximum(length, 1e-12))
        pull = pull[:, :, None] * apart
        total = np.zeros(len(arc))
        for side, sign in ((0, -1.0), (1, 1.0)):
            own = self._ends[:, side] >= 0
            at = self._ends[own, side]
            total += np.bincount(at, sign * (pull[own] * slope[at]).sum(axis=(1, 2)), len(arc))
        return 1e6 * float((excess**COST_POWER).sum()), 1e6 * self.unit_m * total
