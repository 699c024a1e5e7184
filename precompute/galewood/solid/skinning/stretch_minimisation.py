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
FELT_STRETCH = 1e-2
"""Change of an edge's length, relative to rest, from which a pose counts for it and the edges beside it."""
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
    count, of_poses = len(child), poses.moved_m.shape[2]
    pairs = np.repeat(np.arange(count), of_poses), np.tile(np.arange(of_poses), count)
    return _posed_pairs(place_m, child, arc_m, paths, poses, *pairs).reshape(count, of_poses, 3)


def _posed_pairs(
    place_m: Floats, child: Ints, arc_m: Floats, paths: AxisPaths, poses: AxisPoses, vertex: Ints, pose: Ints
) -> Floats:
    """(m, 3) where some of the vertices (m,) are drawn, each in one pose (m,)."""
    bound = paths.bindings(child, arc_m, np.zeros(len(child)))
    posed_m = np.empty((len(vertex), 3))
    where = (bound.child, paths.parent[bound.child], bound.share, bound.at_m, place_m - bound.at_m)
    _pose(vertex, pose, where, poses.moved_m, poses.turned, posed_m)
    return posed_m


@numba.njit(**KERNEL_JIT)
def _pose(
    vertex: Ints,
    pose: Ints,
    where: tuple[Ints, Ints, Floats, Floats, Floats],
    moved_m: Floats,
    turned: Floats,
    posed_m: Floats,
) -> None:  # pragma: no cover  (compiled)
    """posed_m (m, 3) ← vertices bound to links and turned as in ``galewood.solid.skinning.node_poses``."""
    child, parent, share, at_m, arm_m = where
    for m in range(len(vertex)):
        v, k = vertex[m], pose[m]
        i, j, second = parent[v], child[v], share[v]
        first = 1.0 - second
        a0, a1, a2 = arm_m[v, 0], arm_m[v, 1], arm_m[v, 2]
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
        posed_m[m, 0] = at_m[v, 0] + x + a0 * cosine + w1 * a2 - w2 * a1 + w0 * along
        posed_m[m, 1] = at_m[v, 1] + y + a1 * cosine + w2 * a0 - w0 * a2 + w1 * along
        posed_m[m, 2] = at_m[v, 2] + z + a2 * cosine + w0 * a1 - w1 * a0 + w2 * along


@numba.njit(**KERNEL_JIT)
def longest_m(
    one_m: Floats, first: Ints, other_m: Floats, second: Ints
) -> Floats:  # pragma: no cover  (compiled)
    """(e,) largest distance in any pose between vertices (e,) of one_m (v, k, 3) and (e,) of other_m."""
    found = np.zeros(len(first))
    for e in range(len(first)):
        a, b = first[e], second[e]
        most = 0.0
        for k in range(one_m.shape[1]):
            x, y, z = (
                one_m[a, k, 0] - other_m[b, k, 0],
                one_m[a, k, 1] - other_m[b, k, 1],
                one_m[a, k, 2] - other_m[b, k, 2],
            )
            most = max(most, x * x + y * y + z * z)
        found[e] = np.sqrt(most)
    return found


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
    every = np.column_stack(ratio)
    excess = np.maximum(every[every.max(axis=1) > FREE_STRETCH] - 1.0, 0.0) ** COST_POWER  # (e, k)
    covered, chosen = np.zeros(len(excess)), list[int]()
    for _ in range(count):
        chosen.append(int(np.maximum(excess, covered[:, None]).sum(axis=0).argmax()))
        covered = np.maximum(covered, excess[:, chosen[-1]])
    return poses.some(np.unique(chosen))


class StretchMinimisation:
    """Some vertices of a mesh, each free to slide between the root and the end of its branch.

    A pull bends one limb of many. So each edge counts only in the poses that change its length, or that of an
    edge beside it, at the places given.
    """

    def __init__(
        self, mesh: EdgeMesh, child: Ints, arc_m: Floats, free: Ints, paths: AxisPaths, poses: AxisPoses
    ) -> None:
        """All vertices are bound to places (v,); those that are ``free`` (f,) slide."""
        self._child, self._arc, self._free = child, arc_m, free
        self._place, self._paths, self._poses = mesh.place_m[free], paths, poses
        index = np.full(len(child), -1)
        index[free] = np.arange(len(free))
        own = np.flatnonzero((index[mesh.ends] >= 0).any(axis=1))
        ends, length = mesh.ends[own], mesh.length_m[own]
        now = posed_positions(mesh.place_m, child, arc_m, paths, poses)
        bent = np.abs(mesh.stretch(now)[own] - 1.0) > FELT_STRETCH  # (e, k)
        felt = np.zeros(now.shape[:2], bool)
        for side in (0, 1):
            np.logical_or.at(felt, ends[:, side], bent)
        edge, pose = np.nonzero(felt[ends[:, 0]] | felt[ends[:, 1]])
        self._length = length[edge]
        # pairs of a vertex and a pose, each once, those of free vertices first
        rank = np.where(index >= 0, index, len(free) + np.arange(len(index)))
        pairs, place = np.unique(rank[ends][edge] * now.shape[1] + pose[:, None], return_inverse=True)
        self._ends = place.reshape(-1, 2)
        vertex, pose = np.divmod(pairs, now.shape[1])
        moving = int((vertex < len(free)).sum())
        self._vertex, self._pose = vertex[:moving], pose[:moving]
        self._fixed = now[vertex[moving:] - len(free), pose[moving:]]
        self._tip = paths.line_ends[child[free]]
        self.unit_m = max(float(np.median(length)), 1e-9)

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
        where = (self._place, child, arc_m, self._paths, self._poses)
        return np.concatenate([_posed_pairs(*where, self._vertex, self._pose), self._fixed])

    def cost(self, scaled: Floats) -> tuple[float, Floats]:
        """The cost of places at arc lengths in units of ``unit_m``, and its gradient (f,)."""
        arc, step = scaled * self.unit_m, DIFFERENCE_STEP * self.unit_m
        now, ahead = self._posed(arc), self._posed(arc + step)
        rise = np.zeros(len(now))
        total = _stretch_cost(self._ends, self._length, now, ahead, rise)
        gradient = np.bincount(self._vertex, rise[: len(self._vertex)], len(arc)) / step
        return 1e6 * total, 1e6 * self.unit_m * gradient


@numba.njit(**KERNEL_JIT)
def _stretch_cost(
    ends: Ints, length_m: Floats, now_m: Floats, ahead_m: Floats, rise: Floats
) -> float:  # pragma: no cover  (compiled)
    """Sum of a power of the excess stretches of edges between places now_m (m, 3).

    rise (m,) ← by how much the step of each place to ahead_m (m, 3) raises it.
    """
    total = 0.0
    for e in range(len(ends)):
        a, b = ends[e, 0], ends[e, 1]
        x, y, z = now_m[b, 0] - now_m[a, 0], now_m[b, 1] - now_m[a, 1], now_m[b, 2] - now_m[a, 2]
        squared, free_m = x * x + y * y + z * z, FREE_STRETCH * length_m[e]
        if squared > free_m * free_m:
            now = np.sqrt(squared)
            excess = now / length_m[e] - FREE_STRETCH
            total += excess**COST_POWER
            pull = COST_POWER * excess ** (COST_POWER - 1) / (length_m[e] * now)
            for end, sign in ((a, -pull), (b, pull)):
                dx, dy = ahead_m[end, 0] - now_m[end, 0], ahead_m[end, 1] - now_m[end, 1]
                dz = ahead_m[end, 2] - now_m[end, 2]
                rise[end] += sign * (x * dx + y * dy + z * dz)
    return total
