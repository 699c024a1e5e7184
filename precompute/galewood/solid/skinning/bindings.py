"""Bindings of vertices to the axis, and arc lengths along it: where bindings lie, where their paths part."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Bindings:
    """Skinning weights of v vertices: each is bound to the link of the axis that ends at the point ``child``.

    ``share`` (v,) is the weight of that point, 1 − share that of its parent. ``at_m`` (v, 3) is the place on
    the link with these weights, about which the vertex turns; ``distance_m`` (v,) is the distance of what is
    bound there from the bark.
    """

    child: Ints
    share: Floats
    at_m: Floats
    distance_m: Floats

    def take(self, index: Ints) -> Bindings:
        """The bindings of some vertices (k,)."""
        return Bindings(self.child[index], self.share[index], self.at_m[index], self.distance_m[index])

    def replaced(self, index: Ints, by: Bindings) -> Bindings:
        """The bindings with those of some vertices (k,) replaced by others (k,); all distances stay."""
        child, share, at_m = self.child.copy(), self.share.copy(), self.at_m.copy()
        child[index], share[index], at_m[index] = by.child, by.share, by.at_m
        return Bindings(child, share, at_m, self.distance_m)

    @staticmethod
    def concatenated(parts: Sequence[Bindings]) -> Bindings:
        """The bindings of several parts, one after the other."""
        return Bindings(
            np.concatenate([part.child for part in parts]),
            np.concatenate([part.share for part in parts]),
            np.concatenate([part.at_m for part in parts]),
            np.concatenate([part.distance_m for part in parts]),
        )


@dataclass(frozen=True)
class AxisPaths:
    """Paths from the roots along the axis: points_m (p, 3), parent (p,) with −1 at roots.

    A place is a link, from the parent of ``child`` to it, and an arc length, its distance from the root.
    """

    points_m: Floats
    parent: Ints

    @cached_property
    def arc_m(self) -> Floats:
        """(p,) arc length of each point, m."""
        arc = np.zeros(len(self.parent))
        for point in self._outwards:
            up = int(self.parent[point])
            if up >= 0:
                arc[point] = arc[up] + float(np.linalg.norm(self.points_m[point] - self.points_m[up]))
        return arc

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
        end, reach = np.arange(len(self.parent)), self.arc_m.copy()
        for point in self._outwards[::-1]:
            up = int(self.parent[point])
            if up >= 0 and reach[point] > reach[up]:
                end[up], reach[up] = end[point], reach[point]
        return end

    def links_towards(self, end: Ints, arc_m: Floats) -> Ints:
        """The links (v,) at arc lengths (v,) on the paths to some points (v,)."""
        child = np.asarray(end, dtype=np.int64).copy()
        up = np.maximum(self.parent, 0)
        for jump in self._jumps[::-1]:
            far = jump[child]
            beyond = (self.arc_m[up[far]] > arc_m) & (self.parent[far] >= 0)
            child = np.where(beyond, far, child)
        return self.links(child, arc_m)

    def common_ancestors(self, one: Ints, other: Ints) -> Ints:
        """(k,) the last point that the paths to two points have in common; −1: they have different roots."""
        a = np.where(self.hops[one] >= self.hops[other], one, other)
        b = np.where(self.hops[one] >= self.hops[other], other, one)
        for k in range(len(self._jumps) - 1, -1, -1):
            far = self.hops[a] - self.hops[b] >= 2**k
            a = np.where(far, self._jumps[k][a], a)
        for k in range(len(self._jumps) - 1, -1, -1):
            up_a, up_b = self._jumps[k][a], self._jumps[k][b]
            a, b = np.where(up_a != up_b, up_a, a), np.where(up_a != up_b, up_b, b)
        return np.where(a == b, a, np.where(self.parent[a] == self.parent[b], self.parent[a], -1))

    def places(self, bindings: Bindings) -> tuple[Ints, Floats]:
        """The links (v,) of some bindings, and their arc lengths (v,), m."""
        child = np.asarray(bindings.child, dtype=np.int64).copy()
        start = self.arc_m[self.parent[child]]
        return child, start + bindings.share * (self.arc_m[child] - start)

    def bindings(self, child: Ints, arc_m: Floats, distance_m: Floats) -> Bindings:
        """The bindings to links (v,) at arc lengths (v,)."""
        up = self.parent[child]
        length = np.maximum(self.arc_m[child] - self.arc_m[up], 1e-300)
        share = np.clip((arc_m - self.arc_m[up]) / length, 0.0, 1.0)
        at_m = self.points_m[up] + share[:, None] * (self.points_m[child] - self.points_m[up])
        return Bindings(child, share, at_m, distance_m)

    def links(self, child: Ints, arc_m: Floats) -> Ints:
        """The links on which places lie that were moved from their links towards the root."""
        child = child.copy()
        while True:
            up = self.parent[child]
            below = (arc_m < self.arc_m[up]) & (self.parent[up] >= 0)
            if not below.any():
                return child
            child[below] = up[below]

    def fork_m(self, one: Ints, first: Floats, other: Ints, second: Floats) -> tuple[Floats, np.ndarray]:
        """Arc length (k,) at which the paths to two places part; and whether they have one root."""
        meet = self.common_ancestors(one, other)
        line = (meet == one) | (meet == other)
        return np.where(line, np.minimum(first, second), self.arc_m[meet]), meet >= 0
