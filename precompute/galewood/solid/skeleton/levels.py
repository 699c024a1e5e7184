"""Geodesic level sets: distance of each vertex from the roots inside the wood, and sections at equal
distances.

The centres of the sections, linked through the slabs between them, form the skeleton. The wood is a solid of
tetrahedra (m, 4) or, before it is meshed, the surface around it: triangles (m, 3). Both are called cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from galewood.solid.tets import FACES_OF_TET
from galewood.util import Floats, Ints

EDGES_OF_TRIANGLE = np.array([[0, 1], [1, 2], [2, 0]])


@dataclass(frozen=True)
class Faces:
    """Faces between cells: corners (f, 3) or (f, 2), and the two cells (f, 2) that share each one."""

    corners: Ints
    cells: Ints


@dataclass(frozen=True)
class Sections:
    """Sections of the wood at equal geodesic distances, ordered by level.

    level (s,), centre_m (s, 3), area_m2 (s, 3) as a vector, below (s,) and above (s,): the adjacent slab
    components. pair_cell, pair_piece and pair_slab list which cell belongs to which component in which slab;
    a cell may extend over several slabs.
    """

    level: Ints
    centre_m: Floats
    area_m2: Floats
    below: Ints
    above: Ints
    pair_cell: Ints
    pair_piece: Ints
    pair_slab: Ints


def inner_faces(cells: Ints) -> Faces:
    """Faces shared by two cells: triangles between tetrahedra, or edges between triangles."""
    of_cell = FACES_OF_TET if cells.shape[1] == 4 else EDGES_OF_TRIANGLE
    faces = np.sort(cells[:, of_cell].reshape(-1, of_cell.shape[1]), axis=1)
    order = np.lexsort(faces.T[::-1])
    same = (faces[order[1:]] == faces[order[:-1]]).all(axis=1)
    pair = np.column_stack([order[:-1][same], order[1:][same]])
    return Faces(faces[pair[:, 0]].astype(np.int32), (pair // len(of_cell)).astype(np.int32))


def geodesic_distance(vertices_m: Floats, tets: Ints, roots: Ints, faces: Faces) -> Floats:
    """Distance (n,) from the roots along tet edges and straight through shared faces."""
    pairs = np.concatenate([tets[:, [i, j]] for i in range(4) for j in range(i)])
    return distance_along(vertices_m, np.concatenate([pairs, _shortcuts(vertices_m, tets, faces)]), roots)


def distance_along(vertices_m: Floats, pairs: Ints, roots: Ints) -> Floats:
    """Distance (n,) from the roots along straight lines between pairs of vertices (k, 2)."""
    pairs = np.unique(np.sort(pairs, axis=1), axis=0)
    length = np.linalg.norm(vertices_m[pairs[:, 0]] - vertices_m[pairs[:, 1]], axis=1)
    graph = coo_matrix((length, (pairs[:, 0], pairs[:, 1])), shape=(len(vertices_m),) * 2).tocsr()
    return dijkstra(graph, directed=False, indices=roots, min_only=True)


def _shortcuts(vertices_m: Floats, tets: Ints, faces: Faces) -> Ints:
    """Pairs of vertices on opposite sides of a shared face whose connecting line crosses that face."""
    total = tets.sum(axis=1)
    inside = faces.corners.sum(axis=1)
    ends = np.column_stack([total[faces.cells[:, 0]] - inside, total[faces.cells[:, 1]] - inside])
    a, b, c = np.moveaxis(vertices_m[faces.corners], 1, 0)
    start, along = vertices_m[ends[:, 0]], vertices_m[ends[:, 1]] - vertices_m[ends[:, 0]]
    sides = [
        np.einsum("ij,ij->i", np.cross(p - start, q - start), along) for p, q in ((a, b), (b, c), (c, a))
    ]
    signs = np.sign(np.column_stack(sides))
    return ends[np.abs(signs.sum(axis=1)) == 3]


def cut_sections(
    vertices_m: Floats, cells: Ints, distance_m: Floats, faces: Faces, step_m: float
) -> Sections:
    """All sections at distances (k + ½) step_m, and the wood components between them."""
    level = distance_m / step_m - 0.5  # equals k on section k
    cell_levels, face_levels = level[cells], level[faces.corners]
    cross_cell, cross_level = _expand(_first(cell_levels), _last(cell_levels))
    label = _joined(cross_cell, cross_level, *_expand(_first(face_levels), _last(face_levels)), faces)
    cut = _section_polygons if cells.shape[1] == 4 else _section_lines
    centre, area, size = cut(vertices_m, cells, level, cross_cell, cross_level)
    count = int(label.max()) + 1 if len(label) else 0
    size = np.maximum(size, 1e-300)
    total = np.bincount(label, size, count)
    centres = (
        np.stack([np.bincount(label, size * centre[:, k], count) for k in range(3)], axis=1) / total[:, None]
    )
    areas = np.stack([np.bincount(label, area[:, k], count) for k in range(3)], axis=1).astype(np.float64)
    pair_cell, pair_slab, piece = _slab_pieces(cell_levels, face_levels, faces)
    below = _lookup(pair_cell, pair_slab, piece, cross_cell, cross_level - 1)
    above = _lookup(pair_cell, pair_slab, piece, cross_cell, cross_level)
    _, first = np.unique(label, return_index=True)
    order = np.lexsort((first, cross_level[first]))
    chosen = first[order]
    return Sections(
        cross_level[chosen].astype(np.int32), centres[order], areas[order], below[chosen], above[chosen],
        pair_cell, piece, pair_slab,
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


def _slab_pieces(cell_levels: Floats, face_levels: Floats, faces: Faces) -> tuple[Ints, Ints, Ints]:
    """(cell, slab) pairs and the connected component of each; slab k lies between sections k and k + 1."""
    cell, slab = _expand(np.floor(cell_levels.min(axis=1)).astype(np.int64), _last(cell_levels))
    face, face_slab = _expand(np.floor(face_levels.min(axis=1)).astype(np.int64), _last(face_levels))
    return cell, slab, _joined(cell, slab, face, face_slab, faces)


def _joined(cell: Ints, level: Ints, face: Ints, face_level: Ints, faces: Faces) -> Ints:
    """Component of each (cell, level) pair; pairs are joined across faces that reach the same level."""
    key = _key(cell, level)
    order = np.argsort(key)
    ends = [order[np.searchsorted(key[order], _key(faces.cells[face, side], face_level))] for side in (0, 1)]
    graph = coo_matrix((np.ones(len(face)), (ends[0], ends[1])), shape=(len(cell),) * 2)
    return connected_components(graph, directed=False)[1]


def _key(cell: Ints, level: Ints) -> Ints:
    return cell.astype(np.int64) * (1 << 24) + level + 2


def _lookup(cell: Ints, level: Ints, value: Ints, ask_cell: Ints, ask_level: Ints) -> Ints:
    key = _key(cell, level)
    order = np.argsort(key)
    return value[order[np.searchsorted(key[order], _key(ask_cell, ask_level))]]


def _section_polygons(
    vertices_m: Floats, tets: Ints, level: Floats, cross_tet: Ints, cross_level: Ints
) -> tuple[Floats, Floats, Floats]:
    """Centre (p, 3), area vector (p, 3), away from the roots, and area (p,) of each tet's section."""
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
    return centre, area, np.linalg.norm(area, axis=1)


def _section_lines(
    vertices_m: Floats, triangles: Ints, level: Floats, cross: Ints, cross_level: Ints
) -> tuple[Floats, Floats, Floats]:
    """Middle (p, 3), contribution to the area vector (p, 3) and length (p,) of the line in each triangle.

    The lines around a closed limb run the same way round it, and ½ Σ a × b is the vector of the area inside.
    """
    corner = triangles[cross]
    order = np.argsort(level[corner], axis=1)
    point = np.take_along_axis(vertices_m[corner], order[:, :, None], axis=1)
    height = np.take_along_axis(level[corner], order, axis=1) - cross_level[:, None]

    def cut(i: Ints, j: Ints) -> Floats:
        row = np.arange(len(cross))
        share = -height[row, i] / np.maximum(height[row, j] - height[row, i], 1e-300)
        return point[row, i] + np.clip(share, 0.0, 1.0)[:, None] * (point[row, j] - point[row, i])

    one_below = height[:, 1] >= 0
    lowest, middle = np.zeros(len(cross), np.int64), np.ones(len(cross), np.int64)
    a = cut(lowest, np.where(one_below, middle, 2))
    b = cut(np.where(one_below, lowest, middle), np.full(len(cross), 2))
    first, second, third = np.moveaxis(vertices_m[corner], 1, 0)
    normal = np.cross(second - first, third - first)
    uphill = point[:, 2] - point[:, 0]
    turned = np.einsum("ij,ij->i", np.cross(normal, b - a), uphill) < 0
    a, b = np.where(turned[:, None], b, a), np.where(turned[:, None], a, b)
    return (a + b) / 2, 0.5 * np.cross(a, b), np.linalg.norm(b - a, axis=1)
