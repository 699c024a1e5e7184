"""Smoothing of the skinning weights, so that no edge is drawn much longer than at rest in a far bend.

The outer side of a thick limb stretches where it bends in one place, and the skin of a fork where its
branches bend apart. Once the motion of a tree is known, vertices of edges that are stretched too far in far
poses are bound a little nearer to each other along the axis, one neighbour after the other, if that shortens
the longest edge around them (relaxation). So a bend is spread over more edges. Between those passes all are
moved at once (``galewood.solid.skinning.stretch_minimisation``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import AxisPaths, Bindings
from galewood.solid.skinning.embedding import piece_size
from galewood.solid.skinning.skin import JOINTS_PER_LINK
from galewood.solid.skinning.stretch_minimisation import (
    SLIDING_RINGS,
    AxisPoses,
    EdgeMesh,
    StretchMinimisation,
    axis_poses,
    hardest_poses,
    longest_m,
    posed_positions,
)
from galewood.solid.skinning.surface_bindings import vertex_bindings
from galewood.solid.skinning.wood_bindings import WeldedPrimitive, components, welded_primitive
from galewood.tree import RenderPrimitive, TreeMesh
from galewood.util import Floats, Ints

LARGEST_STRETCH = 1.03
"""Length of an edge, relative to rest, from which its vertices are bound nearer to each other."""
STEP_SHARES = (0.15, 0.4, 0.8)
"""Parts of the way to a neighbour's binding that are tried."""
LEAST_GAIN = 1e-4
TORN_STRETCH, SMALL_PIECE = 1.1, 0.06
"""A piece smaller than this, relative to the extent, is bound to one place if it is still stretched so."""
RELAXATION_SEED = 20
FEW_EDGES = 1500
"""A mesh of few edges is tried several times, in other orders: the best is taken."""
SHORTEST_EDGE = 1e-6
"""Relative to the extent; shorter edges are not measured."""


@dataclass(frozen=True)
class Effort:
    """How long weights are smoothed: a table of the first second takes less.

    Edges longer than ``stretch`` are relaxed in at most ``rounds``; all bindings are moved at once in so many
    ``passes``, for the hardest of the ``poses`` in every mesh, and small meshes are tried ``tries`` times.
    """

    stretch: float
    rounds: int
    passes: int
    poses: int
    tries: int


THOROUGH_SMOOTHING = Effort(stretch=LARGEST_STRETCH, rounds=200, passes=2, poses=14, tries=3)
QUICK_SMOOTHING = Effort(stretch=1.06, rounds=60, passes=0, poses=14, tries=1)


def smoothed_bindings(tree: TreeMesh, axis: Axis, basis: Floats, q: Floats, effort: Effort) -> Bindings:
    """The bindings of every render vertex of a tree, with smoothed weights of its wood and fronds.

    Args:
        tree: The drawn mesh.
        axis: Its axis.
        basis: Modes (N, 3, r) of the model's particles.
        q: Far poses (k, r) in which no edge shall stretch much.
        effort: How long they are smoothed.
    """
    poses = axis_poses(axis, basis, q)

    def smoothing(part: RenderPrimitive, bindings: Bindings, fixed: Ints) -> Bindings:
        if not len(part.faces):
            return bindings
        welded = welded_primitive(part)
        fixed = np.unique(welded.same[fixed])
        own = bindings.take(welded.first)
        return smoothed_weights(welded, own, axis, poses, fixed, effort).take(welded.same)

    return vertex_bindings(tree, axis, smoothing)


def smoothed_weights(
    welded: WeldedPrimitive,
    bindings: Bindings,
    axis: Axis,
    poses: AxisPoses,
    fixed: Ints | None = None,
    effort: Effort = THOROUGH_SMOOTHING,
) -> Bindings:
    """The bindings of welded vertices (w,), nearer to each other where edges are stretched in some poses.

    Some vertices ``fixed`` (k,) keep their bindings, such as those of a frond that touch the trunk.
    """
    tries = effort.tries if len(welded.ends) < FEW_EDGES else 1
    is_fixed = np.zeros(len(welded.place_m), bool)
    is_fixed[fixed if fixed is not None else []] = True
    mesh = EdgeMesh(welded.place_m, welded.ends, np.sqrt(welded.squared_m2))
    poses = hardest_poses(mesh, bindings, axis.paths, poses, effort.poses)
    found = [
        _smoothed(
            _Relaxation(welded, axis.paths, poses, bindings, is_fixed), effort, RELAXATION_SEED + number
        )
        for number in range(tries)
    ]
    best = min(found, key=lambda mesh: float(mesh.ratio.max(initial=0.0)))
    if fixed is None or not len(fixed):
        best.bind_small_pieces_rigidly()
    return best.bindings(bindings.distance_m)


def _smoothed(mesh: _Relaxation, effort: Effort, seed: int) -> _Relaxation:
    rng = np.random.default_rng(seed)
    for _ in range(effort.passes):
        mesh.relax_all(effort, rng)
        mesh.minimise()
    mesh.relax_all(effort, rng)
    return mesh


def _severity(ratio: Floats) -> float:
    """How far edges are stretched: the sum of a high power, in which the longest count most."""
    return float(np.power(np.maximum(ratio - 1.0, 0.0), 6).sum())


class _Relaxation:
    """The mesh of a primitive in all poses, with the places on the axis that its vertices are bound to."""

    def __init__(
        self,
        welded: WeldedPrimitive,
        paths: AxisPaths,
        poses: AxisPoses,
        bindings: Bindings,
        is_fixed: np.ndarray,
    ) -> None:
        self._is_fixed = is_fixed  # (w,)
        self._paths, self._poses = paths, poses
        length = np.linalg.norm(welded.place_m[welded.ends[:, 1]] - welded.place_m[welded.ends[:, 0]], axis=1)
        kept = length > SHORTEST_EDGE * float(np.ptp(welded.place_m, axis=0).max())
        self._mesh = EdgeMesh(welded.place_m, welded.ends[kept], length[kept])
        self._place, self._ends, self._length = self._mesh.place_m, self._mesh.ends, self._mesh.length_m
        self._child, arc = paths.places(bindings)
        self._arc = self._at_joints(self._child, arc)
        count = len(welded.place_m)
        self._now = self._posed(np.arange(count), self._child, self._arc)
        both = np.concatenate([self._ends, self._ends[:, ::-1]])
        order = np.argsort(both[:, 0], kind="stable")
        self._edge, self._neighbour = np.tile(np.arange(len(self._ends)), 2)[order], both[order, 1]
        self._first = np.searchsorted(both[order, 0], np.arange(count + 1))
        self._rank = np.full(count, -1.0)
        self.ratio = self._ratios(self._now)
        """(e,) length of each edge over that at rest, the largest of all poses."""

    def _ratios(self, now: Floats) -> Floats:
        return longest_m(now, self._ends[:, 0], now, self._ends[:, 1]) / self._length

    def _posed(self, vertex: Ints, child: Ints, arc: Floats) -> Floats:
        return posed_positions(self._place[vertex], child, arc, self._paths, self._poses)

    def _at_joints(self, child: Ints, arc: Floats) -> Floats:
        """The nearest places (v,) with joints: short edges feel the difference."""
        start = self._paths.arc_m[self._paths.parent[child]]
        step = np.maximum(self._paths.arc_m[child] - start, 1e-300) / JOINTS_PER_LINK
        return start + step * np.round((arc - start) / step)

    def minimise(self) -> None:
        """Move all bindings around stretched edges at once, if that shortens the longest of them."""
        around = self._mesh.around(np.flatnonzero(self.ratio > LARGEST_STRETCH), SLIDING_RINGS)
        free = around[~self._is_fixed[around]]
        child, arc = self._child, self._arc
        if len(free):
            problem = StretchMinimisation(self._mesh, child, arc, free, self._paths, self._poses)
            child, arc = problem.places()
        arc = self._at_joints(child, arc)
        now = self._posed(np.arange(len(arc)), child, arc)
        ratio = self._ratios(now)
        if _severity(ratio) < _severity(self.ratio):
            self._child, self._arc, self._now, self.ratio = child, arc, now, ratio

    def relax_all(self, effort: Effort, rng: np.random.Generator) -> None:
        """Move bindings one after the other until no edge is stretched."""
        for _ in range(effort.rounds):
            stretched = np.flatnonzero(self.ratio > effort.stretch)
            if not len(stretched):
                break
            self.relax(stretched, rng)

    def relax(self, stretched: Ints, rng: np.random.Generator) -> None:
        """Move some bindings of stretched edges (s,) towards those of a neighbour, where it helps."""
        vertex = self._independent(np.unique(self._ends[stretched]), rng)
        row, around = self._around(vertex)
        edge, neighbour = self._edge[around], self._neighbour[around]
        worst, pick = np.zeros(len(vertex)), np.zeros(len(vertex), dtype=np.int64)
        np.maximum.at(worst, row, self.ratio[edge])
        wanted = self.ratio[edge] * rng.uniform(0.8, 1.0, len(edge))  # mostly that of the longest edge
        order = np.lexsort((wanted, row))
        pick[row[order]] = neighbour[order]
        child, arc = self._towards(vertex, pick, rng.choice(STEP_SHARES, len(vertex)))
        now = self._posed(vertex, child, arc)
        ratio = longest_m(now, row, self._now, neighbour) / self._length[edge]
        after = np.zeros(len(vertex))
        np.maximum.at(after, row, ratio)
        better = (after < worst - LEAST_GAIN) & ~self._is_fixed[vertex]
        self._child[vertex[better]], self._arc[vertex[better]] = child[better], arc[better]
        self._now[vertex[better]] = now[better]
        self.ratio[edge[better[row]]] = ratio[better[row]]

    def _independent(self, vertex: Ints, rng: np.random.Generator) -> Ints:
        """A random independent set of the vertices: no two of them neighbours."""
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
        first, second = self._arc[vertex], self._arc[other]
        fork, together = self._paths.fork_m(self._child[vertex], first, self._child[other], second)
        step = np.where(together, share * (first + second - 2 * fork), 0.0)
        inwards = first - fork
        outwards = inwards <= 1e-12
        arc = np.where(outwards, first + step, first - np.minimum(step, inwards))
        child = np.where(outwards & together, self._child[other], self._child[vertex])
        child = self._paths.links(child, arc)
        return child, self._at_joints(child, arc)

    def bind_small_pieces_rigidly(self) -> None:
        """Bind small pieces to one place that lie across the gap between two branches, such as a cylinder."""
        count = len(self._place)
        piece = components(self._ends, count)
        worst = np.zeros(int(piece.max()) + 1)
        np.maximum.at(worst, piece[self._ends[:, 0]], self.ratio)
        small = piece_size(self._place, piece) < SMALL_PIECE * float(np.ptp(self._place, axis=0).max())
        for number in np.flatnonzero(small & (worst > TORN_STRETCH)).tolist():
            own = np.flatnonzero(piece == number)
            middle = own[
                int(np.linalg.norm(self._place[own] - self._place[own].mean(axis=0), axis=1).argmin())
            ]
            self._child[own], self._arc[own] = self._child[middle], self._arc[middle]

    def bindings(self, distance_m: Floats) -> Bindings:
        """The bindings to the places."""
        return self._paths.bindings(self._child, self._arc, distance_m)
