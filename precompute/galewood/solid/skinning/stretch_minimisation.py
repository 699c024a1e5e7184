"""Bindings moved together so that a bend is shared by all edges around it: least stretch in some poses.

Where a thick limb bends, as above the flare of a trunk, no single vertex can move without stretching its
other edges. So the bindings of all vertices around stretched edges are found at once: each slides along the
path from the root through its branch, and the sum of a power of the excess stretches is minimised.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from scipy.optimize import minimize
from scipy.sparse import csr_matrix

from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import AxisPaths, Bindings
from galewood.solid.skinning.node_poses import limit_stretch
from galewood.util import Floats, Ints

KERNEL_JIT: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy"}

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
    posed_m = np.empty((len(child), poses.moved_m.shape[2], 3))
    where = (bound.child, paths.parent[bound.child], bound.share, bound.at_m)
    _pose(place_m, *where, poses.moved_m, poses.turned, posed_m)
    return posed_m


@numba.njit(**KERNEL_JIT)
def _pose(
    place_m: Floats,
    child: Ints,
    up: Ints,
    share: Floats,
    at_m: Floats,
    moved_m: Floats,
    turned: Floats,
    posed_m: Floats,
) -> None:  # pragma: no cover  (compiled)
    """posed_m (v, k, 3) ← the vertices with their bindings, as ``galewood.solid.skinning.node_poses`` turns
    them.
    """
    for v in range(len(child)):
        i, j, second = up[v], child[v], share[v]
        first = 1.0 - second
        a0, a1, a2 = place_m[v, 0] - at_m[v, 0], place_m[v, 1] - at_m[v, 1], place_m[v, 2] - at_m[v, 2]
        for k in range(moved_m.shape[2]):
            w0 = first * turned[i, 0, k] + second * turned[j, 0, k]
            w1 = first * turned[i, 1, k] + second * turned[j, 1, k]
            w2 = first * turned[i, 2, k] + second * turned[j, 2, k]
            squared = w0 * w0 + w1 * w1 + w2 * w2
            less = 1.0 / np.sqrt(np.sqrt(1.0 + squared * squared))
            w0, w1, w2 = w0 * less, w1 * less, w2 * less
            cosine = np.sqrt(max(1.0 - squared * less * less, 0.0))
            along = (w0 * a0 + w1 * a1 + w2 * a2) / (1.0 + cosine)
            x = first * moved_m[i, 0, k] + second * moved_m[j, 0, k]
            y = first * moved_m[i, 1, k] + second * moved_m[j, 1, k]
            z = first * moved_m[i, 2, k] + second * moved_m[j, 2, k]
            posed_m[v, k, 0] = at_m[v, 0] + x + a0 * cosine + w1 * a2 - w2 * a1 + w0 * along
            posed_m[v, k, 1] = at_m[v, 1] + y + a1 * cosine + w2 * a0 - w0 * a2 + w1 * along
            posed_m[v, k, 2] = at_m[v, 2] + z + a2 * cosine + w0 * a1 - w1 * a0 + w2 * along


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
        gradient = np.zeros(len(arc))
        total = _stretch_cost(self._ends, self._length, now, slope, self._fixed, gradient)
        return 1e6 * total, 1e6 * self.unit_m * gradient


@numba.njit(**KERNEL_JIT)
def _stretch_cost(
    ends: Ints, length_m: Floats, now_m: Floats, slope: Floats, fixed_m: Floats, gradient: Floats
) -> float:  # pragma: no cover  (compiled)
    """Sum of a power of the excess stretches of edges (e, 2); adds to its gradient (f,).

    An end is the index of a vertex in ``now_m`` (f, k, 3), or negative: it is in ``fixed_m`` (e, 2, k, 3).
    """
    total = 0.0
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        for k in range(now_m.shape[1]):
            one = now_m[a, k] if a >= 0 else fixed_m[e, 0, k]
            other = now_m[b, k] if b >= 0 else fixed_m[e, 1, k]
            x, y, z = other[0] - one[0], other[1] - one[1], other[2] - one[2]
            now = np.sqrt(x * x + y * y + z * z)
            excess = now / length_m[e] - FREE_STRETCH
            if excess > 0.0:
                total += excess**COST_POWER
                pull = COST_POWER * excess ** (COST_POWER - 1) / (length_m[e] * max(now, 1e-12))
                if a >= 0:
                    gradient[a] -= pull * (x * slope[a, k, 0] + y * slope[a, k, 1] + z * slope[a, k, 2])
                if b >= 0:
                    gradient[b] += pull * (x * slope[b, k, 0] + y * slope[b, k, 1] + z * slope[b, k, 2])
    return total
