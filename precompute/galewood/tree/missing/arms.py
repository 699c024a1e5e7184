"""Arms of a piece of foliage: fronds that are joined where they grow, as in the crown of a palm."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import KDTree

from galewood.tree.repair import Surface, directed_edges, weld_keeping_faces
from galewood.util import Floats, Ints

HUB_LENGTH_SHARE = 0.15
"""Where arms are still joined: this near to their base, relative to the longest way along the surface."""
LEAST_ARM = 0.3
"""Shortest arm, relative to the longest."""
MIN_FROND_ASPECT_RATIO = 2.2
"""Length of a frond over its mean width, at least."""


def _ways(vertices_m: Floats, faces: Ints, base_m: Floats) -> tuple[Surface, Floats]:
    """The welded piece, and the length (v,) of the shortest way along its edges from the vertex nearest to a
    place (3,), m; infinite where there is none.
    """
    welded = weld_keeping_faces(Surface(vertices_m, faces))
    base = int(np.linalg.norm(welded.vertices - base_m, axis=1).argmin())
    edges = directed_edges(welded.faces)
    length = np.linalg.norm(welded.vertices[edges[:, 0]] - welded.vertices[edges[:, 1]], axis=1)
    graph = coo_matrix((np.maximum(length, 1e-9), edges.T), shape=(len(welded.vertices),) * 2).tocsr()
    return welded, np.asarray(dijkstra(graph, directed=False, indices=base), dtype=np.float64)


def arms_of(vertices_m: Floats, faces: Ints, base_m: Floats) -> Ints:
    """Number (f,) of each face's arm, counted from 0; all 0 if the piece has no separate, slender arms.

    ``base_m`` (3,) is where the piece grows. What is cut off at a small distance from there along the surface
    are the arms; faces of the hub between them belong to the nearest.
    """
    return arms_and_ways(vertices_m, faces, base_m)[0]


def arms_and_ways(vertices_m: Floats, faces: Ints, base_m: Floats) -> tuple[Ints, Floats]:
    """As ``arms_of``; also the way (f, 3) from the base to the corners of the faces along the surface, m."""
    welded, way = _ways(vertices_m, faces, base_m)
    longest = float(way[np.isfinite(way)].max())
    outer = way > HUB_LENGTH_SHARE * longest
    beyond = outer[welded.faces].all(axis=1)
    of_corner = way[welded.faces]
    whole = np.zeros(len(faces), dtype=np.int32)
    if not beyond.any():
        return whole, of_corner
    kept = welded.faces[beyond]
    pairs = np.concatenate([kept[:, :2], kept[:, 1:]])
    graph = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(welded.vertices),) * 2)
    _, label = connected_components(graph, directed=False)
    farthest = np.zeros(int(label.max()) + 1)
    np.maximum.at(farthest, label[kept[:, 0]], np.where(np.isfinite(way), way, 0.0)[kept].max(axis=1))
    arms = np.flatnonzero(farthest > LEAST_ARM * longest)
    if len(arms) < 2:
        return whole, of_corner
    middle = vertices_m[faces].mean(axis=1)
    result = np.zeros(len(faces), dtype=np.int32)
    best = np.full(len(faces), np.inf)
    own_label = np.where(beyond, label[welded.faces[:, 0]], -1)
    for number, arm in enumerate(arms.tolist()):
        mine = own_label == arm
        apart = np.asarray(KDTree(middle[mine]).query(middle)[0], dtype=np.float64)
        apart[mine] = -1.0
        nearer = apart < best
        result[nearer], best[nearer] = number, apart[nearer]
    area = np.bincount(result, triangle_areas(vertices_m[faces]), len(arms))
    slender = farthest[arms] ** 2 > MIN_FROND_ASPECT_RATIO * area
    return (result if slender.all() else whole), of_corner


def triangle_areas(corners_m: Floats) -> Floats:
    """Area (f,) of triangles (f, 3, 3), m²."""
    cross = np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0])
    return np.asarray(np.linalg.norm(cross, axis=1) / 2, dtype=np.float64)
