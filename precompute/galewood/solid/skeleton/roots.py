"""Clamped vertices: the lowest slab of the wood, without twigs that merely hang to the ground."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from galewood.solid.tets import tet_volumes
from galewood.util import Floats, Ints

CLAMPED_SHARE = 0.02  # relative to the wood's height
THICK_BASE_RATIO = 0.2  # relative to the volume (of a surface, the area) of the thickest base
MIN_HULL_POINTS = 4


def root_vertices(vertices_m: Floats, cells: Ints) -> Ints:
    """Indices (k,) of the vertices in the lowest 2 % that belong to a thick base.

    The cells are the tetrahedra of the wood, or the triangles around it.

    At least four vertices that span a plane are returned; the slab is enlarged if necessary.
    """
    heights = vertices_m[:, 1]
    low, size = float(heights.min()), float(np.ptp(heights))
    share = CLAMPED_SHARE
    while True:
        below = heights <= low + share * size
        chosen = _thick_bases(vertices_m, cells, below)
        if _spans_plane(vertices_m[chosen], size) or share > 0.5:
            return chosen
        share *= 1.5


def _thick_bases(vertices_m: Floats, cells: Ints, below: np.ndarray) -> Ints:
    touching = cells[below[cells].any(axis=1)]
    pairs = np.concatenate([touching[:, [0, k]] for k in range(1, cells.shape[1])])
    graph = coo_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(vertices_m),) * 2)
    _, label = connected_components(graph, directed=False)
    sizes = np.bincount(label[touching[:, 0]], _sizes(vertices_m, touching), label.max() + 1)
    thick = sizes >= THICK_BASE_RATIO * sizes.max()
    return np.flatnonzero(below & thick[label]).astype(np.int32)


def _sizes(vertices_m: Floats, cells: Ints) -> Floats:
    """Volume (m,) of tetrahedra, m³, or area of triangles, m²."""
    if cells.shape[1] == 4:
        return tet_volumes(vertices_m, cells)
    corner = vertices_m[cells]
    return np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1) / 2


def _spans_plane(points: Floats, size: float) -> bool:
    if len(points) < MIN_HULL_POINTS:
        return False
    singular = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(singular[1] > 1e-4 * size)
