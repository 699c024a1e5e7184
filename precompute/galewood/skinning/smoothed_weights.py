"""Places that hold the bark, chosen so that no edge is drawn much longer than at rest in a far bend.

The outer side of a thick limb stretches where it bends in one place, and the skin of a fork where its
branches bend apart. In given poses, vertices of edges that are stretched too far are held a little nearer to
each other along the axis, one neighbour after the other, if that shortens the longest edge around them. So a
bend is spread over more edges.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from galewood.model import Axis, AxisPaths, Feet, WeldedWood, axis_paths
from galewood.reduction.nodes import JOINTS_PER_LINK
from galewood.reduction.spread_bends import AxisPoses, Skin, drawn_at, spread
from galewood.table import unstretched
from galewood.util import Floats, Ints

CALM = 1.03
"""Length of an edge, relative to rest, from which its vertices are held nearer to each other."""
ROUNDS = 200
PASSES = 2
"""Times that the places of all vertices are slid at once, between those one by one."""
SHARES = (0.15, 0.4, 0.8)
"""Parts of the way to a neighbour's place that are tried."""
GAIN = 1e-4
TORN, SMALL = 1.1, 0.06
"""A piece smaller than this, relative to the extent, is held at one place if it is still stretched so."""
SEED = 20
TRIES, FEW_EDGES = 3, 1500
"""A mesh of few edges is tried several times, in other orders: the best is taken."""
SHORTEST = 1e-6
"""Relative to the extent; shorter edges are not measured."""


def drawn_poses(axis: Axis, basis: Floats, poses: Floats) -> AxisPoses:
    """The poses (k, r) of a model's particles with the modes ``basis`` (N, 3, r), as they are drawn.

    Links that are too long are shortened, as between the nodes of a table (``galewood.table.unstretched``).
    """
    moved, stretch = unstretched(axis.points_m, axis.parent, axis.displacement(basis) @ poses.T)
    return AxisPoses(moved, (axis.rotation(basis) @ poses.T) / stretch[:, None])


def calmed(wood: WeldedWood, feet: Feet, axis: Axis, poses: AxisPoses, still: Ints | None = None) -> Feet:
    """The feet of welded vertices (w,), held nearer to each other where edges are stretched.

    Some vertices ``still`` (k,) stay where they are held, such as those of a frond that touch the trunk.
    """
    tries = TRIES if len(wood.ends) < FEW_EDGES else 1
    paths, kept = axis_paths(axis), np.zeros(len(wood.place_m), bool)
    kept[still if still is not None else []] = True
    found = [_calmed(_Bark(wood, paths, poses, feet, kept), SEED + number) for number in range(tries)]
    best = min(found, key=lambda bark: float(bark.ratio.max(initial=0.0)))
    if still is None or not len(still):
        best.hold_small_pieces()
    return best.feet(feet.distance_m)


def _severity(ratio: Floats) -> float:
    """How far edges are stretched: the sum of a high power, in which the longest count most."""
    return float(np.power(np.maximum(ratio - 1.0, 0.0), 6).sum())


def _calmed(bark: _Bark, seed: int) -> _Bark:
    rng = np.random.default_rng(seed)
    for _ in range(PASSES):
        bark.relax_all(rng)
        bark.spread()
    bark.relax_all(rng)
    return bark


class _Bark:
    """The bark of a primitive in all poses, with the places that hold it."""

    def __init__(
        self, wood: WeldedWood, paths: AxisPaths, poses: AxisPoses, feet: Feet, still: np.ndarray
    ) -> None:
        self._still = still  # (w,)
        self._paths, self._poses = paths, poses
        length = np.linalg.norm(wood.place_m[wood.ends[:, 1]] - wood.place_m[wood.ends[:, 0]], axis=1)
        kept = length > SHORTEST * float(np.ptp(wood.place_m, axis=0).max())
        self._skin = Skin(wood.place_m, wood.ends[kept], length[kept])
        self._place, self._ends, self._length = self._skin.place_m, self._skin.ends, self._skin.length_m
        self._child, mark = paths.places(feet)
        self._mark = self._at_joints(self._child, mark)
        count = len(wood.place_m)
        self._now = self._drawn(np.arange(count), self._child, self._mark)
        both = np.concatenate([self._ends, self._ends[:, ::-1]])
        order = np.argsort(both[:, 0], kind="stable")
        self._edge, self._neighbour = np.tile(np.arange(len(self._ends)), 2)[order], both[order, 1]
        self._first = np.searchsorted(both[order, 0], np.arange(count + 1))
        self._rank = np.full(count, -1.0)
        self.ratio = self._ratios(self._now)
        """(e,) length of each edge over that at rest, the largest of all poses."""

    def _ratios(self, now: Floats) -> Floats:
        apart = now[self._ends[:, 0]] - now[self._ends[:, 1]]
        return (np.linalg.norm(apart, axis=2) / self._length[:, None]).max(axis=1, initial=0.0)

    def _drawn(self, vertex: Ints, child: Ints, mark: Floats) -> Floats:
        return drawn_at(self._place[vertex], child, mark, self._paths, self._poses)

    def _at_joints(self, child: Ints, mark: Floats) -> Floats:
        """The nearest places (v,) with joints: short edges feel the difference."""
        start = self._paths.mark_m[self._paths.parent[child]]
        step = np.maximum(self._paths.mark_m[child] - start, 1e-300) / JOINTS_PER_LINK
        return start + step * np.round((mark - start) / step)

    def spread(self) -> None:
        """Slide all places around stretched edges at once, if that shortens the longest of them."""
        stretched = np.flatnonzero(self.ratio > CALM)
        child, mark = spread(
            self._skin, self._child, self._mark, stretched, self._still, self._paths, self._poses
        )
        mark = self._at_joints(child, mark)
        now = self._drawn(np.arange(len(mark)), child, mark)
        ratio = self._ratios(now)
        if _severity(ratio) < _severity(self.ratio):
            self._child, self._mark, self._now, self.ratio = child, mark, now, ratio

    def relax_all(self, rng: np.random.Generator) -> None:
        """Move places one after the other until no edge is stretched."""
        for _ in range(ROUNDS):
            stretched = np.flatnonzero(self.ratio > CALM)
            if not len(stretched):
                break
            self.relax(stretched, rng)

    def relax(self, stretched: Ints, rng: np.random.Generator) -> None:
        """Move some places of stretched edges (s,) towards those of a neighbour, where it helps."""
        vertex = self._apart(np.unique(self._ends[stretched]), rng)
        row, around = self._around(vertex)
        edge, neighbour = self._edge[around], self._neighbour[around]
        worst, pick = np.zeros(len(vertex)), np.zeros(len(vertex), dtype=np.int64)
        np.maximum.at(worst, row, self.ratio[edge])
        wanted = self.ratio[edge] * rng.uniform(0.8, 1.0, len(edge))  # mostly that of the longest edge
        order = np.lexsort((wanted, row))
        pick[row[order]] = neighbour[order]
        child, mark = self._towards(vertex, pick, rng.choice(SHARES, len(vertex)))
        now = self._drawn(vertex, child, mark)
        apart = np.linalg.norm(now[row] - self._now[neighbour], axis=2)
        ratio = (apart / self._length[edge][:, None]).max(axis=1)
        after = np.zeros(len(vertex))
        np.maximum.at(after, row, ratio)
        better = (after < worst - GAIN) & ~self._still[vertex]
        self._child[vertex[better]], self._mark[vertex[better]] = child[better], mark[better]
        self._now[vertex[better]] = now[better]
        self.ratio[edge[better[row]]] = ratio[better[row]]

    def _apart(self, vertex: Ints, rng: np.random.Generator) -> Ints:
        """Some of the vertices, no two of them neighbours."""
        rank = rng.random(len(vertex))
        self._rank[vertex] = rank
        row, around = self._around(vertex)
        most = np.full(len(vertex), -1.0)
        np.maximum.at(most, row, self._rank[self._neighbour[around]])
        self._rank[vertex] = -1.0
        return vertex[rank > most]

    def _around(self, vertex: Ints) -> tuple[Ints, Ints]:
        """Rows of the incident edges of vertices (v,): index of the vertex (n,), and of the row (n,)."""
        count = self._first[vertex + 1] - self._first[vertex]
        row = np.repeat(np.arange(len(vertex)), count)
        within = np.arange(int(count.sum())) - np.repeat(np.cumsum(count) - count, count)
        return row, np.repeat(self._first[vertex], count) + within

    def _towards(self, vertex: Ints, other: Ints, share: Floats) -> tuple[Ints, Floats]:
        """Places a share of the way along the axis from those of vertices to those of others."""
        first, second = self._mark[vertex], self._mark[other]
        fork, together = self._paths.fork_m(self._child[vertex], first, self._child[other], second)
        step = np.where(together, share * (first + second - 2 * fork), 0.0)
        inwards = first - fork
        outwards = inwards <= 1e-12
        mark = np.where(outwards, first + step, first - np.minimum(step, inwards))
        child = np.where(outwards & together, self._child[other], self._child[vertex])
        child = self._paths.links(child, mark)
        return child, self._at_joints(child, mark)

    def hold_small_pieces(self) -> None:
        """Hold small pieces at one place that lie across the gap between two branches, such as a cylinder."""
        count = len(self._place)
        graph = coo_matrix((np.ones(len(self._ends)), self._ends.T), shape=(count, count))
        pieces, piece = connected_components(graph, directed=False)
        low, high = np.full((pieces, 3), np.inf), np.full((pieces, 3), -np.inf)
        np.minimum.at(low, piece, self._place)
        np.maximum.at(high, piece, self._place)
        worst = np.zeros(pieces)
        np.maximum.at(worst, piece[self._ends[:, 0]], self.ratio)
        small = np.linalg.norm(high - low, axis=1) < SMALL * float(np.ptp(self._place, axis=0).max())
        for number in np.flatnonzero(small & (worst > TORN)).tolist():
            own = np.flatnonzero(piece == number)
            middle = own[
                int(np.linalg.norm(self._place[own] - self._place[own].mean(axis=0), axis=1).argmin())
            ]
            self._child[own], self._mark[own] = self._child[middle], self._mark[middle]

    def feet(self, distance_m: Floats) -> Feet:
        """The places as feet."""
        return self._paths.feet(self._child, self._mark, distance_m)
