"""Geodesic level sets: distance of each vertex from the roots inside the wood, and sections at equal
distances.

The centres of the sections, linked through the slabs between them, form the skeleton.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from galewood.tets import FACES_OF_TET
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Faces:
    """Interior faces: corners (f, 3) and the two tets (f, 2) that share each one."""

    corners: Ints
    tets: Ints


@dataclass(frozen=True)
class Sections:
    """Sections of the wood at equal geodesic distances, ordered by level.

    level (s,), centre_m (s, 3), area_m2 (s, 3) as a vector, below (s,) and above (s,): the adjacent slab
    components. pair_tet, pair_piece and pair_slab list which tet belongs to which component in which slab; a
    tet may extend over several slabs.
    """

    level: Ints
    centre_m: Floats
    area_m2: Floats
    below: Ints
    above: Ints
    pair_tet: Ints
    pair_piece: Ints
    pair_slab: Ints


def inner_faces(tets: Ints) -> Faces:
    """Faces shared by two tets."""
    faces = np.sort(tets[:, FACES_OF_TET].reshape(-1, 3), axis=1)
    order = np.lexsort(faces.T[::-1])
    same = (faces[order[1:]] == faces[order[:-1]]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    return Faces(faces[first].astype(np.int32), np.column_stack([first // 4, second // 4]).astype(np.int32))


def geodesic_distance(vertices_m: Floats, tets: Ints, roots: Ints, faces: Faces) -> Floats:
    """Distance (n,) from the roots along tet edges and straight through shared faces."""
    pairs = np.concatenate([tets[:, [i, j]] for i in range(4) for j in range(i)])
    pairs = np.unique(np.sort(np.concatenate([pairs, _shortcuts(vertices_m, tets, faces)]), axis=1), axis=0)
    length = np.linalg.norm(vertices_m[pairs[:, 0]] - vertices_m[pairs[:, 1]], axis=1)
    graph = coo_matrix((length, (pairs[:, 0], pairs[:, 1])), shape=(len(vertices_m),) * 2).tocsr()
    return dijkstra(graph, directed=False, indices=roots, min_only=True)


def _shortcuts(vertices_m: Floats, tets: Ints, faces: Faces) -> Ints:
    """Pairs of vertices on opposite sides of a shared face whose connecting line crosses that face."""
    total = tets.sum(axis=1)
    inside = faces.corners.sum(axis=1)
    ends = np.column_stack([total[faces.tets[:, 0]] - inside, total[faces.tets[:, 1]] - inside])
    a, b, c = np.moveaxis(vertices_m[faces.corners], 1, 0)
    start, along = vertices_m[ends[:, 0]], vertices_m[ends[:, 1]] - vertices_m[ends[:, 0]]
    sides = [
        np.einsum("ij,ij->i", np.cross(p - start, q - start), along) for p, q in ((a, b), (b, c), (c, a))
    ]
    signs = np.sign(np.column_stack(sides))
    return ends[np.abs(signs.sum(axis=1)) == 3]


def cut_sections(vertices_m: Floats, tets: Ints, distance_m: Floats, faces: Faces, step_m: float) -> Sections:
    """All sections at distances (k + ½) step_m, and the wood components between them."""
    level = distance_m / step_m - 0.5  # equals k on section k
    tet_levels, face_levels = level[tets], level[faces.corners]
    cross_tet, cross_level = _expand(_first(tet_levels), _last(tet_levels))
    label = _joined(cross_tet, cross_level, *_expand(_first(face_levels), _last(face_levels)), faces)
    centre, area = _section_polygons(vertices_m, tets, level, cross_tet, cross_level)
    count = int(label.max()) + 1 if len(label) else 0
    size = np.maximum(np.linalg.norm(area, axis=1), 1e-300)
    total = np.bincount(label, size, count)
    centres = (
        np.stack([np.bincount(label, size * centre[:, k], count) for k in range(3)], axis=1) / total[:, None]
    )
    areas = np.stack([np.bincount(label, area[:, k], count) for k in range(3)], axis=1).astype(np.float64)
    pair_tet, pair_slab, piece = _slab_pieces(tet_levels, face_levels, faces)
    below = _lookup(pair_tet, pair_slab, piece, cross_tet, cross_level - 1)
    above = _lookup(pair_tet, pair_slab, piece, cross_tet, cross_level)
    _, first = np.unique(label, return_index=True)
    order = np.lexsort((first, cross_level[first]))
    chosen = first[order]
    return Sections(
        cross_level[chosen].astype(np.int32), centres[order], areas[order], below[chosen], above[chosen],
        pair_tet, piece, pair_slab,
    )  # fmt: skip


def _first(levels: Floats) -> Ints:
    """Lowest integer level above the minimum, at least 0."""
    return np.maximum(np.floor(levels.min(axis=1)).astype(np.int64) + 1, 0)


def _last(levels: Floats) -> Ints:
    """Highest integer level not above the maximum."""
    return np.floor(levels.max(axis=1)).astype(np.int64)


def _expand(first: Ints, last: Ints) -> tuple[Ints, Ints]:
    """Pairs (item, k) for every k from first to last of each item."""
    count = np.maximum(last - first + 1, 0)
    item = np.repeat(np.arange(len(first)), count)
    offset = np.arange(len(item)) - np.repeat(np.cumsum(count) - count, count)
    return item, first[item] + offset


def _slab_pieces(tet_levels: Floats, face_levels: Floats, faces: Faces) -> tuple[Ints, Ints, Ints]:
    """(tet, slab) pairs and the connected component of each; slab k lies between sections k and k + 1."""
    tet, slab = _expand(np.floor(tet_levels.min(axis=1)).astype(np.int64), _last(tet_levels))
    face, face_slab = _expand(np.floor(face_levels.min(axis=1)).astype(np.int64), _last(face_levels))
    return tet, slab, _joined(tet, slab, face, face_slab, faces)


def _joined(tet: Ints, level: Ints, face: Ints, face_level: Ints, faces: Faces) -> Ints:
    """Component of each (tet, level) pair; pairs are joined across faces that reach the same level."""
    key = _key(tet, level)
    order = np.argsort(key)
    ends = [order[np.searchsorted(key[order], _key(faces.tets[face, side], face_level))] for side in (0, 1)]
    graph = coo_matrix((np.ones(len(face)), (ends[0], ends[1])), shape=(len(tet),) * 2)
    return connected_components(graph, directed=False)[1]


def _key(tet: Ints, level: Ints) -> Ints:
    return tet.astype(np.int64) * (1 << 24) + level + 2


def _lookup(tet: Ints, level: Ints, value: Ints, ask_tet: Ints, ask_level: Ints) -> Ints:
    key = _key(tet, level)
    order = np.argsort(key)
    return value[order[np.searchsorted(key[order], _key(ask_tet, ask_level))]]


def _section_polygons(
    vertices_m: Floats, tets: Ints, level: Floats, cross_tet: Ints, cross_level: Ints
) -> tuple[Floats, Floats]:
    """Centre (p, 3) and area vector (p, 3), pointing away from the roots, of each tet's cross-section."""
    order = np.argsort(level[tets[cross_tet]], axis=1)
    corner = np.take_along_axis(tets[cross_tet], order, axis=1)
    height = level[corner] - cross_level[:, None]
    point = vertices_m[corner]

    def cut(i: int, j: int) -> Floats:
        share = -height[:, i] / np.maximum(height[:, j] - height[:, i], 1e-300)
        return point[:, i] + np.clip(share, 0.0, 1.0)[:, None] * (point[:, j] - point[:, i])

    below = (height < 0).sum(axis=1)[:, None]  # number of corners below the section: 1, 2 or 3
    p0 = np.where(below == 1, cut(0, 1), np.where(below == 2, cut(0, 2), cut(0, 3)))
    p1 = np.where(below == 1, cut(0, 2), np.where(below == 2, cut(0, 3), cut(1, 3)))
    p2 = np.where(below == 1, cut(0, 3), np.where(below == 2, cut(1, 3), cut(2, 3)))
    p3 = np.where(below == 2, cut(1, 2), p2)
    area = 0.5 * np.cross(p2 - p0, p3 - p1)
    triangle = (below != 2)[:, 0]
    area[triangle] = 0.5 * np.cross(p1 - p0, p2 - p0)[triangle]
    centre = np.where(below == 2, (p0 + p1 + p2 + p3) / 4, (p0 + p1 + p2) / 3)
    area *= np.sign(np.einsum("ij,ij->i", area, point[:, 3] - point[:, 0]))[:, None]
    return centre, area
