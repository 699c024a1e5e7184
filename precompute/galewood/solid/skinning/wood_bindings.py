"""Initial bindings of the wood: beside each vertex on the axis, with limited differences between neighbours.

A vertex is bound beside the middle of the ring around it. Where two branches fork, neighbouring vertices are
nearest to different branches, at places far apart, so that the whole difference of their motion would fall on
one edge. A fork hardly bends. So bindings are moved towards the root until no two that are joined by an edge
are farther apart along the axis than the edge is long, with some allowance: the slope of the arc length over
the surface is limited.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import Bindings
from galewood.tree import RenderPrimitive, unique_edges
from galewood.util import Floats, Ints

AVERAGING_ROUNDS = 4
WELD_DISTANCE = 1e-5
"""Relative to the extent; vertices nearer than this are one."""
SLOPE_ALONG, SLOPE_AROUND = 1.3, 0.1
"""Largest distance of two bindings along the axis, relative to the length of the edge between their vertices
along the axis, and to its whole length. The sum is above 1, so that beyond a fork bindings are again beside
their vertices."""
FORK_REACH = 4.0
"""Distance of two bindings, relative to the radius of the limb, up to which it is limited."""
SLOPE_SWEEPS = 200


def wood_bindings(wood: RenderPrimitive, axis: Axis) -> Bindings:
    """The initial bindings of all vertices (n,) of a wood primitive.

    Sought from the middle of the ring around the vertex, so that a ring is bound to one place: where the axis
    does not run through the middle of a thin branch, its vertices would be bound far from each other.
    """
    if not len(wood.faces):
        return axis.nearest(wood.positions_m)
    welded = welded_primitive(wood)
    nearest = axis.nearest(_ring_middles(welded))
    return limited_slope(nearest, welded.place_m, welded.ends, axis).take(welded.same)


@dataclass(frozen=True)
class WeldedPrimitive:
    """Vertices that are one: place_m (w, 3), the ``first`` (w,) vertex of each, and which of them
    each vertex is, ``same`` (n,).

    ``ends`` (e, 2) are the edges, ``squared_m2`` (e,) the squares of their lengths, not below a least one.
    """

    place_m: Floats
    first: Ints
    same: Ints
    ends: Ints
    squared_m2: Floats


def welded_primitive(primitive: RenderPrimitive) -> WeldedPrimitive:
    """The vertices of a primitive, each once."""
    place = primitive.positions_m
    unit_m = WELD_DISTANCE * float(np.ptp(place, axis=0).max())
    _, first, same = np.unique(np.round(place / unit_m), axis=0, return_index=True, return_inverse=True)
    same = np.ravel(same)
    ends = unique_edges(same[primitive.faces])
    ends = ends[ends[:, 0] != ends[:, 1]]
    squared = np.square(place[first][ends[:, 0]] - place[first][ends[:, 1]]).sum(axis=1)
    return WeldedPrimitive(place[first], first, same, ends, np.maximum(squared, unit_m**2))


def _ring_middles(wood: WeldedPrimitive) -> Floats:
    """(w, 3) positions averaged with their neighbours, weighted by the inverse square of the distance."""
    middle, count = wood.place_m, len(wood.place_m)
    both = np.concatenate([wood.ends, wood.ends[:, ::-1]])
    near = csr_matrix((np.tile(1.0 / wood.squared_m2, 2), (both[:, 0], both[:, 1])), shape=(count, count))
    total = np.asarray(near.sum(axis=1)).ravel()
    linked = total > 0
    for _ in range(AVERAGING_ROUNDS):
        mean = np.asarray(near @ middle) / np.maximum(total, 1e-300)[:, None]
        middle = np.where(linked[:, None], 0.4 * middle + 0.6 * mean, middle)
    return middle


def limited_slope(bindings: Bindings, place_m: Floats, ends: Ints, axis: Axis) -> Bindings:
    """The bindings of vertices (v,) at place_m (v, 3), near to those of the other ends of edges (e, 2)."""
    paths = axis.paths
    child, arc = paths.places(bindings)
    most = _largest_distance_m(child, place_m, ends, axis)
    kept = _of_one_fork(child, arc, ends, most, axis)
    ends, most = ends[kept], most[kept]
    for _ in range(SLOPE_SWEEPS):
        first, second = arc[ends[:, 0]], arc[ends[:, 1]]
        fork, _ = paths.fork_m(child[ends[:, 0]], first, child[ends[:, 1]], second)
        excess = first + second - 2 * fork - most
        over = np.flatnonzero(excess > 1e-6 * most + 1e-9)
        if not len(over):
            break
        _move(arc, ends[over], excess[over], fork[over], axis.radius_m[child])
        child = paths.links(child, arc)
    return paths.bindings(child, arc, bindings.distance_m)


def _largest_distance_m(child: Ints, place_m: Floats, ends: Ints, axis: Axis) -> Floats:
    """(e,) largest distance of the bindings of edges, m: more along the axis than around it."""
    edge = place_m[ends[:, 1]] - place_m[ends[:, 0]]
    length = np.linalg.norm(edge, axis=1)
    along = axis.points_m[child] - axis.points_m[axis.parent[child]]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    lengthwise = np.abs(np.einsum("ei,vei->ve", edge, along[ends.T])).max(axis=0)
    return SLOPE_ALONG * lengthwise + SLOPE_AROUND * length


def _of_one_fork(child: Ints, arc: Floats, ends: Ints, most: Floats, axis: Axis) -> np.ndarray:
    """(e,) whether the bindings of edges meet in a fork nearby; limbs grown together meet far below."""
    first, second = arc[ends[:, 0]], arc[ends[:, 1]]
    fork, together = axis.paths.fork_m(child[ends[:, 0]], first, child[ends[:, 1]], second)
    radius_m = axis.radius_m[axis.paths.common_ancestors(child[ends[:, 0]], child[ends[:, 1]])]
    return together & (first + second - 2 * fork < FORK_REACH * radius_m + most)


def _move(arc: Floats, ends: Ints, excess: Floats, fork: Floats, radius: Floats) -> None:
    """Move the bindings of edges (k, 2) towards the root by their excess, on the thinner branch first."""
    thin = np.argmin(radius[ends] + 1e-9 * (arc[ends] < fork[:, None] + 1e-12), axis=1)
    row = np.arange(len(ends))
    thinner, thicker = ends[row, thin], ends[row, 1 - thin]
    room = arc[thinner] - fork
    moved = np.minimum(excess, room)
    rest = np.minimum(excess - moved, arc[thicker] - fork)
    target = arc.copy()
    np.minimum.at(target, thinner, arc[thinner] - moved)
    np.minimum.at(target, thicker, arc[thicker] - np.maximum(rest, 0.0))
    arc[:] = target
