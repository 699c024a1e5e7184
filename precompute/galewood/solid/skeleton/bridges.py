"""Connections between the separate closed surfaces of a tree's limbs.

A modelled tree is often a set of tubes, each with its base inside its parent limb, and its twigs cross
each other. What tells a base from a crossing is how deep it lies inside a larger limb.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from galewood.solid.skeleton.levels import EDGES_OF_TRIANGLE
from galewood.util import Floats, Ints

MAX_GAP_SHARE = 0.03
"""Largest gap between a limb and its parent, relative to the height; else the nearest limb is the parent."""
MAX_DEPTH_RATIO = 3.0
"""Deepest that a limb reaches into its parent, relative to the parent's mean radius."""
MOST_PIECES = 16
"""Of an edge: its points are about a mean diameter of the limb apart."""


@dataclass(frozen=True)
class _Limb:
    """A closed surface: points_m (k, 3) along its edges, their normals, and the vertex (k,) next to each."""

    points_m: Floats
    normal: Floats
    vertex: Ints
    radius_m: float


def bridges(vertices_m: Floats, faces: Ints) -> Ints:
    """Pairs of vertices (k, 2) that connect all separate limbs of a surface with normals outwards.

    Each limb grows from a larger one: where it reaches deepest into it, or else where the gap is smallest.
    """
    count, part = _connected(len(vertices_m), faces[:, EDGES_OF_TRIANGLE].reshape(-1, 2))
    if count == 1:
        return np.zeros((0, 2), np.int64)
    normal, volume, radius_m = _shapes(vertices_m, faces, part)
    rank = np.argsort(np.argsort(-volume, kind="stable"))  # 0: the largest
    margin_m = MAX_GAP_SHARE * float(np.ptp(vertices_m[:, 1]))
    pairs: list[Ints] = [np.zeros((0, 2), np.int64)]
    values: list[Floats] = [np.zeros(0)]
    for number, limb in _limbs(vertices_m, faces, part, normal, radius_m):
        reach_m = margin_m + MAX_DEPTH_RATIO * limb.radius_m
        low, high = limb.points_m.min(axis=0) - reach_m, limb.points_m.max(axis=0) + reach_m
        near = ((vertices_m >= low) & (vertices_m <= high)).all(axis=1) & (rank[part] > rank[number])
        own = np.flatnonzero(near)
        if len(own):
            value, point = _gaps(vertices_m[own], limb, reach_m)
            near = np.isfinite(value)
            own, value, point = own[near], value[near], point[near]
            best = _best(value, part[own])
            pairs.append(np.column_stack([own[best], limb.vertex[point[best]]]))
            values.append(value[best])
    pair, value = np.concatenate(pairs), np.concatenate(values)
    chosen = pair[_best(value, part[pair[:, 0]])]
    return np.concatenate([chosen, _left_over(vertices_m, part, count, chosen)])


def _gaps(places_m: Floats, limb: _Limb, reach_m: float) -> tuple[Floats, Ints]:
    """Distance of places (k, 3) from a limb, negative inside it, and its nearest point (k,).

    Places farther away than ``reach_m`` are infinitely far.
    """
    gap, point = _nearest(limb.points_m, places_m, reach_m)
    point = np.where(np.isfinite(gap), point, 0)
    depth = -np.einsum("ij,ij->i", places_m - limb.points_m[point], limb.normal[point])
    inside = (depth > 0.5 * gap) & (depth < MAX_DEPTH_RATIO * limb.radius_m)
    return np.where(inside, -depth, gap), point


def _limbs(
    vertices_m: Floats, faces: Ints, part: Ints, normal: Floats, radius_m: Floats
) -> Iterator[tuple[int, _Limb]]:
    edges = np.unique(np.sort(faces[:, EDGES_OF_TRIANGLE].reshape(-1, 2), axis=1), axis=0)
    edges = edges[np.argsort(part[edges[:, 0]], kind="stable")]
    bounds = np.flatnonzero(np.diff(part[edges[:, 0]])) + 1
    for own in np.split(edges, bounds):
        number = int(part[own[0, 0]])
        length = np.linalg.norm(vertices_m[own[:, 1]] - vertices_m[own[:, 0]], axis=1)
        pieces = np.clip(np.ceil(length / max(2 * radius_m[number], 1e-9)), 1, MOST_PIECES).astype(int)
        edge = np.repeat(np.arange(len(own)), pieces)
        step = np.arange(len(edge)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
        share = ((step + 0.5) / pieces[edge])[:, None]
        a, b = own[edge].T
        across = (1 - share) * normal[a] + share * normal[b]
        points = (1 - share) * vertices_m[a] + share * vertices_m[b]
        across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
        yield number, _Limb(points, across, np.where(share[:, 0] < 0.5, a, b), float(radius_m[number]))


def _left_over(vertices_m: Floats, part: Ints, count: int, chosen: Ints) -> Ints:
    """Shortest connections of what the chosen ones leave apart from the largest group."""
    taken: list[Ints] = []
    while True:
        groups, group = _connected(count, part[np.concatenate([chosen, *taken])])
        if groups == 1:
            return np.concatenate([np.zeros((0, 2), np.int64), *taken])
        of_vertex = group[part]
        main = of_vertex == np.argmax(np.bincount(of_vertex))
        inner, outer = np.flatnonzero(main), np.flatnonzero(~main)
        gap, nearest = _nearest(vertices_m[inner], vertices_m[outer])
        best = _best(gap, of_vertex[outer])
        taken.append(np.column_stack([outer[best], inner[nearest[best]]]))


def _nearest(points_m: Floats, places_m: Floats, reach_m: float = np.inf) -> tuple[Floats, Ints]:
    """Distance (k,) of places (k, 3) from the nearest of some points, and its index (k,).

    A place with no point within ``reach_m`` is infinitely far.
    """
    gap, index = KDTree(points_m).query(places_m, distance_upper_bound=reach_m)
    return np.asarray(gap, np.float64), np.asarray(index, np.int64)


def _best(value: Floats, group: Ints) -> Ints:
    """Index of the smallest value of each group."""
    order = np.lexsort((value, group))
    _, first = np.unique(group[order], return_index=True)
    return order[first]


def _shapes(vertices_m: Floats, faces: Ints, part: Ints) -> tuple[Floats, Floats, Floats]:
    """Unit normal (n, 3) at every vertex; volume, m³, and mean radius 2V/A, m, of every part."""
    corner = vertices_m[faces]
    area = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 2
    normal = np.stack(
        [np.bincount(faces.ravel(), np.repeat(area[:, k], 3), len(vertices_m)) for k in range(3)], axis=1
    )
    of_face = part[faces[:, 0]]
    volume = np.abs(np.bincount(of_face, np.einsum("ij,ij->i", corner[:, 0], area) / 3))
    surface = np.bincount(of_face, np.linalg.norm(area, axis=1))
    length = np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    return normal / length, volume, 2 * volume / np.maximum(surface, 1e-300)


def _connected(count: int, pairs: Ints) -> tuple[int, Ints]:
    graph = coo_matrix((np.ones(len(pairs), np.int8), pairs.T), shape=(count, count))
    return connected_components(graph, directed=False)
