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
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import Bindings
from galewood.solid.skinning.embedding import piece_size
from galewood.tree import RenderPrimitive, unique_edges
from galewood.util import Floats, Ints

AVERAGING_ROUNDS = 4
WELD_DISTANCE = 1e-5
"""Relative to the extent; vertices nearer than this are one."""
SLOPE_ALONG, SLOPE_AROUND = 1.3, 0.1
"""Largest distance of two bindings along the axis, relative to the length of the edge between their vertices
along the axis, and to its whole length. The sum is above 1, so that beyond a fork bindings are again beside
their vertices."""
FORK_REACH, FORK_SHARE = 4.0, 0.05
"""Distance of two bindings, over the radius of the limb or over the extent, up to which it is limited."""
SMALL_PIECE = 0.15
"""Of a closed surface smaller than this, relative to the extent, also larger distances are limited, up to its
size."""
SLOPE_SWEEPS = 200
TORN_SLOPE = 1.5
"""Distance of two bindings, relative to the largest allowed, from which an edge between them is torn."""
AWAY_RADII = 2.0
"""A vertex that is bound again is held by a branch whose bark is farther by at most so many of its radii."""
LINE_DISTANCE = 0.15
"""Distance from a line of the axis, over the size of a piece, up to which the line runs through the piece."""
MOST_LINES, LINE_SAMPLES = 8, 256
"""Lines that are tried for a piece, those with the most of its bindings, and vertices that decide on one."""
LARGEST_DISTANCE = 0.1
"""Distance from the bark of its branch, over its size, from which a small piece is bound to one place."""


def wood_bindings(wood: RenderPrimitive, axis: Axis) -> Bindings:
    """The initial bindings of all vertices (n,) of a wood primitive.

    Sought from the middle of the ring around the vertex, so that a ring is bound to one place: where the axis
    does not run through the middle of a thin branch, its vertices would be bound far from each other.
    """
    if not len(wood.faces):
        return axis.nearest(wood.positions_m)
    welded = welded_primitive(wood)
    middle = _ring_middles(welded)
    nearest = without_islands(axis.nearest(middle), middle, welded, axis)
    limited = limited_slope(nearest, welded.place_m, welded.ends, axis)
    whole = with_single_lines(limited, middle, welded, axis)
    return with_rigid_pieces(whole, welded.place_m, welded.ends, axis).take(welded.same)


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


def without_islands(bindings: Bindings, middle_m: Floats, wood: WeldedPrimitive, axis: Axis) -> Bindings:
    """The bindings in which no part of a surface is held by a branch that the rest of it does not reach.

    Where twigs cross, some vertices are nearest to the axis of the other twig. The smaller parts, around
    which all edges lead to bindings far away along the axis, are bound again from the shore inwards: each
    vertex to the place found from the binding of its neighbour onwards, unless that is away from the bark.
    ``middle_m`` (w, 3) are the middles of the rings.
    """
    count, ends = len(middle_m), wood.ends
    surface, size_m = _small_pieces(wood.place_m, ends)
    patch = components(ends[~_is_torn(bindings, wood.place_m, ends, axis)], count)
    order = np.lexsort((patch, np.bincount(patch)[patch]))
    main = np.zeros(len(size_m), np.int64)
    main[surface[order]] = patch[order]  # the largest patch of each surface is written last
    unbound = patch != main[surface]
    bound = ~unbound
    by_length = ends[np.argsort(wood.squared_m2, kind="stable")]
    while True:
        shore = by_length[(unbound[by_length] & bound[by_length[:, ::-1]]).any(axis=1)]
        if not len(shore):
            return bindings
        vertex, first = np.unique(np.where(unbound[shore[:, 0]], *shore.T), return_index=True)
        before = bindings.take(vertex)
        found = axis.nearest_along(middle_m[vertex], bindings.child[shore[first].sum(axis=1) - vertex])
        room_m = np.maximum(AWAY_RADII * axis.radius_m[found.child], size_m[surface[vertex]])
        better = (found.distance_m <= before.distance_m + room_m) & (found.child != before.child)
        index = np.arange(count)
        index[vertex[better]] = count + np.flatnonzero(better)
        bindings = Bindings.concatenated([bindings, found]).take(index)
        unbound[vertex] = False
        bound[vertex[better]] = True


def _is_torn(bindings: Bindings, place_m: Floats, ends: Ints, axis: Axis) -> np.ndarray:
    """(e,) whether the bindings of edges are much farther apart along the axis than allowed."""
    child, arc = axis.paths.places(bindings)
    first, second = arc[ends[:, 0]], arc[ends[:, 1]]
    fork, together = axis.paths.fork_m(child[ends[:, 0]], first, child[ends[:, 1]], second)
    most = TORN_SLOPE * _largest_distance_m(child, place_m, ends, axis)
    return together & (first + second - 2 * fork > most)


def components(edges: Ints, count: int) -> Ints:
    """(count,) number of the connected component of each vertex."""
    graph = coo_matrix((np.ones(len(edges), bool), (edges[:, 0], edges[:, 1])), shape=(count, count))
    return np.asarray(connected_components(graph, directed=False)[1], np.int64)


def limited_slope(bindings: Bindings, place_m: Floats, ends: Ints, axis: Axis) -> Bindings:
    """The bindings of vertices (v,) at place_m (v, 3), near to those of the other ends of edges (e, 2)."""
    paths = axis.paths
    child, arc = paths.places(bindings)
    most = _largest_distance_m(child, place_m, ends, axis)
    kept = _of_one_fork(child, arc, place_m, ends, axis)
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


def _of_one_fork(child: Ints, arc: Floats, place_m: Floats, ends: Ints, axis: Axis) -> np.ndarray:
    """(e,) whether the bindings of edges meet in a fork nearby; limbs grown together meet far below.

    Near is what is within the thickness of the limb, or within the size of a small piece of the surface.
    """
    first, second = arc[ends[:, 0]], arc[ends[:, 1]]
    fork, together = axis.paths.fork_m(child[ends[:, 0]], first, child[ends[:, 1]], second)
    radius_m = axis.radius_m[axis.paths.common_ancestors(child[ends[:, 0]], child[ends[:, 1]])]
    piece, size_m = _small_pieces(place_m, ends)
    extent_m = float(np.ptp(place_m, axis=0).max())
    reach_m = np.maximum(np.maximum(FORK_REACH * radius_m, FORK_SHARE * extent_m), size_m[piece[ends[:, 0]]])
    return together & (first + second - 2 * fork < reach_m + _largest_distance_m(child, place_m, ends, axis))


def _small_pieces(place_m: Floats, ends: Ints) -> tuple[Ints, Floats]:
    """The connected piece (v,) of each vertex, and the size (k,) of each piece, m, 0 of large ones."""
    piece = components(ends, len(place_m))
    size_m = piece_size(place_m, piece)
    return piece, np.where(size_m < SMALL_PIECE * float(np.ptp(place_m, axis=0).max()), size_m, 0.0)


def with_single_lines(bindings: Bindings, middle_m: Floats, wood: WeldedPrimitive, axis: Axis) -> Bindings:
    """The bindings in which a torn piece is bound along one line of the axis, if one runs through it.

    Where twigs cross a limb that is a closed surface of its own, its rings are nearest to the axis of now the
    one, now the other. The limb bends with one of them. ``middle_m`` (w, 3) are the middles of the rings.
    """
    piece = components(wood.ends, len(middle_m))
    across = _is_torn(bindings, wood.place_m, wood.ends, axis)
    size_m = piece_size(wood.place_m, piece)
    torn: list[Ints] = [np.zeros(0, np.int64)]
    along: list[Bindings] = [bindings.take(torn[0])]
    for number in np.unique(piece[wood.ends[across, 0]]).tolist():
        own = np.flatnonzero(piece == number)
        most_m = LINE_DISTANCE * float(size_m[number])
        found = _along_one_line(middle_m[own], bindings.child[own], axis, most_m)
        if found is not None:
            torn.append(own)
            along.append(found)
    moved = np.concatenate(torn)
    changed = bindings.replaced(moved, Bindings.concatenated(along))
    ends = wood.ends[np.isin(wood.ends[:, 0], moved)]
    return limited_slope(changed, wood.place_m, ends, axis) if len(ends) else changed


def _along_one_line(middle_m: Floats, child: Ints, axis: Axis, most_m: float) -> Bindings | None:
    """Bindings of points (v, 3) to the line nearest to all of them, of those of some links (v,).

    None: no line is within ``most_m`` of all.
    """
    end, count = np.unique(axis.paths.line_ends[child], return_counts=True)
    tried = end[np.argsort(-count, kind="stable")[:MOST_LINES]].tolist()
    some_m = middle_m[:: -(-len(middle_m) // LINE_SAMPLES)]
    off_m = [np.linalg.norm(some_m - axis.nearest_on_path(some_m, one).at_m, axis=1).max() for one in tried]
    best = int(np.argmin(off_m))
    return axis.nearest_on_path(middle_m, tried[best]) if off_m[best] <= most_m else None


def with_rigid_pieces(bindings: Bindings, place_m: Floats, ends: Ints, axis: Axis) -> Bindings:
    """The bindings in which small pieces without a branch of their own are bound to one place.

    These are pieces that lie across the gap between branches, or away from the branch that holds them, such
    as a twig too small for the skeleton. They are bound where they are nearest to the bark of a thick branch.
    """
    piece, size_m = _small_pieces(place_m, ends)
    away = np.bincount(piece, bindings.distance_m > LARGEST_DISTANCE * size_m[piece]) > 0
    across = _is_torn(bindings, place_m, ends, axis)
    rigid = (away | (np.bincount(piece[ends[:, 0]], across, len(size_m)) > 0)) & (size_m > 0)
    order = np.lexsort((-axis.radius_m[bindings.child], bindings.distance_m, piece))
    start = order[np.unique(piece[order], return_index=True)[1]]  # of each piece
    own = np.flatnonzero(rigid[piece])
    return bindings.replaced(own, bindings.take(start[piece[own]]))


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
