"""Places of neighbouring bark vertices on the axis, brought near to each other.

Where two branches fork, neighbouring vertices are held on different axes, and at places far apart: the whole
difference of their motion would fall on one edge. A fork hardly bends. So places are moved towards the root
until no two that are joined by an edge are farther apart along the axis than the edge is long, with some
allowance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from galewood.model.axis import Axis, Feet
from galewood.util import Floats, Ints

ALONG, AROUND = 1.3, 0.1
"""Largest distance of two places along the axis, relative to the length of the edge between their vertices
along the axis, and to its whole length. The sum is above 1, so that beyond a fork places are again beside
their vertices."""
REACH = 4.0
"""Distance of two places, relative to the radius of the limb, up to which they are brought near."""
SWEEPS = 200


@dataclass(frozen=True)
class AxisPaths:
    """Ways along the axis, a tree: points_m (p, 3), parent (p,) with −1 at roots.

    A place is a link, from the parent of ``child`` to it, and ``mark``, its distance from the root.
    """

    points_m: Floats
    parent: Ints

    @cached_property
    def mark_m(self) -> Floats:
        """(p,) distance from the root."""
        mark = np.zeros(len(self.parent))
        for point in self._outwards:
            up = int(self.parent[point])
            if up >= 0:
                mark[point] = mark[up] + float(np.linalg.norm(self.points_m[point] - self.points_m[up]))
        return mark

    @cached_property
    def hops(self) -> Ints:
        """(p,) number of links from the root."""
        hops = np.zeros(len(self.parent), dtype=np.int64)
        for point in self._outwards:
            if self.parent[point] >= 0:
                hops[point] = hops[self.parent[point]] + 1
        return hops

    @cached_property
    def _outwards(self) -> list[int]:
        """Points, parents first."""
        order, seen = list[int](), np.zeros(len(self.parent), dtype=bool)
        for start in range(len(self.parent)):
            trail, point = list[int](), start
            while point >= 0 and not seen[point]:
                seen[point] = True
                trail.append(point)
                point = int(self.parent[point])
            order += trail[::-1]
        return order

    @cached_property
    def _jumps(self) -> Ints:
        """(k, p) ancestors 1, 2, 4, … links nearer to the root; a root is its own."""
        own = np.arange(len(self.parent))
        rows = [np.where(self.parent >= 0, self.parent, own)]
        while 2 ** len(rows) <= int(self.hops.max(initial=0)):
            rows.append(rows[-1][rows[-1]])
        return np.array(rows)

    @cached_property
    def roots(self) -> Ints:
        """(p,) the root of each point."""
        root = np.arange(len(self.parent))
        for point in self._outwards:
            if self.parent[point] >= 0:
                root[point] = root[self.parent[point]]
        return root

    @cached_property
    def line_ends(self) -> Ints:
        """(p,) the end of the longest way on from each point."""
        end, reach = np.arange(len(self.parent)), self.mark_m.copy()
        for point in self._outwards[::-1]:
            up = int(self.parent[point])
            if up >= 0 and reach[point] > reach[up]:
                end[up], reach[up] = end[point], reach[point]
        return end

    def on_way(self, end: Ints, mark: Floats) -> Ints:
        """The links (v,) at a distance (v,) from the root on the ways to some points (v,)."""
        child = np.asarray(end, dtype=np.int64).copy()
        up = np.maximum(self.parent, 0)
        for jump in self._jumps[::-1]:
            far = jump[child]
            beyond = (self.mark_m[up[far]] > mark) & (self.parent[far] >= 0)
            child = np.where(beyond, far, child)
        return self.links(child, mark)

    def meeting(self, one: Ints, other: Ints) -> Ints:
        """(k,) the last point that the ways from the root to two points have in common; −1: other roots."""
        a = np.where(self.hops[one] >= self.hops[other], one, other)
        b = np.where(self.hops[one] >= self.hops[other], other, one)
        for k in range(len(self._jumps) - 1, -1, -1):
            far = self.hops[a] - self.hops[b] >= 2**k
            a = np.where(far, self._jumps[k][a], a)
        for k in range(len(self._jumps) - 1, -1, -1):
            up_a, up_b = self._jumps[k][a], self._jumps[k][b]
            a, b = np.where(up_a != up_b, up_a, a), np.where(up_a != up_b, up_b, b)
        return np.where(a == b, a, np.where(self.parent[a] == self.parent[b], self.parent[a], -1))

    def places(self, feet: Feet) -> tuple[Ints, Floats]:
        """The links (v,) of some feet, and their distance (v,) from the root."""
        child = np.asarray(feet.child, dtype=np.int64).copy()
        start = self.mark_m[self.parent[child]]
        return child, start + feet.share * (self.mark_m[child] - start)

    def feet(self, child: Ints, mark: Floats, distance_m: Floats) -> Feet:
        """The feet on links (v,) at a distance (v,) from the root."""
        up = self.parent[child]
        length = np.maximum(self.mark_m[child] - self.mark_m[up], 1e-300)
        share = np.clip((mark - self.mark_m[up]) / length, 0.0, 1.0)
        at_m = self.points_m[up] + share[:, None] * (self.points_m[child] - self.points_m[up])
        return Feet(child, share, at_m, distance_m)

    def links(self, child: Ints, mark: Floats) -> Ints:
        """The links on which places lie that were moved from their links towards the root."""
        child = child.copy()
        while True:
            up = self.parent[child]
            below = (mark < self.mark_m[up]) & (self.parent[up] >= 0)
            if not below.any():
                return child
            child[below] = up[below]

    def fork_m(self, one: Ints, first: Floats, other: Ints, second: Floats) -> tuple[Floats, np.ndarray]:
        """Distance (k,) from the root to where the ways to places part; and whether they have one root."""
        meet = self.meeting(one, other)
        line = (meet == one) | (meet == other)
        return np.where(line, np.minimum(first, second), self.mark_m[meet]), meet >= 0


def axis_paths(axis: Axis) -> AxisPaths:
    """The ways along an axis."""
    return AxisPaths(axis.points_m, np.asarray(axis.parent, dtype=np.int64))


def eased(feet: Feet, place_m: Floats, ends: Ints, axis: Axis) -> Feet:
    """The feet of vertices (v,) at place_m (v, 3), joined by edges (e, 2), near to each other."""
    paths = axis_paths(axis)
    child, mark = paths.places(feet)
    most = _most(feet, place_m, ends, axis)
    kept = _of_one_fork(child, mark, ends, most, paths, axis)
    ends, most = ends[kept], most[kept]
    for _ in range(SWEEPS):
        first, second = mark[ends[:, 0]], mark[ends[:, 1]]
        fork, _ = paths.fork_m(child[ends[:, 0]], first, child[ends[:, 1]], second)
        excess = first + second - 2 * fork - most
        over = np.flatnonzero(excess > 1e-6 * most + 1e-9)
        if not len(over):
            break
        _move(mark, ends[over], excess[over], fork[over], axis.radius_m[child])
        child = paths.links(child, mark)
    return paths.feet(child, mark, feet.distance_m)


def _most(feet: Feet, place_m: Floats, ends: Ints, axis: Axis) -> Floats:
    """(e,) largest distance of the places of edges, m: more along the axis than around it."""
    edge = place_m[ends[:, 1]] - place_m[ends[:, 0]]
    length = np.linalg.norm(edge, axis=1)
    child = feet.child
    along = axis.points_m[child] - axis.points_m[axis.parent[child]]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    lengthwise = np.abs(np.einsum("ei,vei->ve", edge, along[ends.T])).max(axis=0)
    return ALONG * lengthwise + AROUND * length


def _of_one_fork(
    child: Ints, mark: Floats, ends: Ints, most: Floats, paths: AxisPaths, axis: Axis
) -> np.ndarray:
    """(e,) whether the places of edges meet in a fork nearby; limbs grown together meet far below."""
    first, second = mark[ends[:, 0]], mark[ends[:, 1]]
    fork, together = paths.fork_m(child[ends[:, 0]], first, child[ends[:, 1]], second)
    radius_m = axis.radius_m[paths.meeting(child[ends[:, 0]], child[ends[:, 1]])]
    return together & (first + second - 2 * fork < REACH * radius_m + most)


def _move(mark: Floats, ends: Ints, excess: Floats, fork: Floats, radius: Floats) -> None:
    """Move places of edges (k, 2) towards the root by their excess, that on the thinner branch first."""
    thin = np.argmin(radius[ends] + 1e-9 * (mark[ends] < fork[:, None] + 1e-12), axis=1)
    row = np.arange(len(ends))
    thinner, thicker = ends[row, thin], ends[row, 1 - thin]
    room = mark[thinner] - fork
    moved = np.minimum(excess, room)
    rest = np.minimum(excess - moved, mark[thicker] - fork)
    target = mark.copy()
    np.minimum.at(target, thinner, mark[thinner] - moved)
    np.minimum.at(target, thicker, mark[thicker] - np.maximum(rest, 0.0))
    mark[:] = target
