"""One closed solid around overlapping, touching or open components, by a signed distance grid and marching
cubes.
"""

from __future__ import annotations

import fast_simplification
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from skimage.measure import marching_cubes

from galewood.solid.tets.wrap_kernels import band_squares, signed, vote
from galewood.tree import Surface, compact, face_components, signed_volumes
from galewood.util import Floats

BAND_CELLS = 2.0
MARGIN_CELLS = 4
DECIMATION_AGGRESSIVENESS = 5  # of the decimation; 2 stops too early, 7 loses volume
JITTER_CELLS = 0.01237  # in cells; keeps rays off vertices and edges, which often have round coordinates


def wrap(surface: Surface, cell: float) -> Surface:
    """Outer surface of the union of all closed components, at a resolution of `cell`."""
    field, low = signed_distance(surface, cell)
    vertices, triangles, _, _ = marching_cubes(field, 0.0, gradient_direction="descent")
    solid = Surface(vertices.astype(np.float64) * cell + low, triangles.astype(np.int32))
    return without_inner_shells(solid)


def signed_distance(surface: Surface, cell: float) -> tuple[NDArray[np.float32], Floats]:
    """Signed distance field in cells (negative inside), and the position of its first grid point."""
    low = surface.vertices.min(axis=0) - MARGIN_CELLS * cell
    extent = surface.vertices.max(axis=0) - low + MARGIN_CELLS * cell
    shape = tuple(int(n) for n in np.ceil(extent / cell) + 1)
    triangles = np.ascontiguousarray(((surface.vertices - low) / cell)[surface.faces])
    field = band_squares(triangles, shape, BAND_CELLS)
    signed(field, votes_for_inside(triangles, shape))
    return field, low


def votes_for_inside(triangles: Floats, shape: tuple[int, ...]) -> NDArray[np.int8]:
    """How many of three rays, one per axis, place each grid point inside the union; two are a majority."""
    votes = np.zeros(shape, dtype=np.int8)
    jitter = np.array([JITTER_CELLS, JITTER_CELLS * 1.618])
    for axis in range(3):
        vote(triangles, axis, jitter, votes)
    return votes


def without_inner_shells(surface: Surface) -> Surface:
    """The surface without inner shells, that is, components of non-positive volume."""
    count, of_face = face_components(surface.faces, len(surface.vertices))
    volumes = signed_volumes(surface, of_face, count)
    outer = volumes > 1e-9 * volumes.max()
    return compact(Surface(surface.vertices, surface.faces[outer[of_face]]))


def decimate(surface: Surface, faces: int) -> Surface:
    """Reduce the surface to about `faces` triangles by quadric error (fast-simplification)."""
    if len(surface.faces) <= faces:
        return surface
    points = np.ascontiguousarray(surface.vertices)
    triangles = np.ascontiguousarray(surface.faces, dtype=np.int32)
    simplified = fast_simplification.simplify(
        points, triangles, target_count=faces, agg=DECIMATION_AGGRESSIVENESS
    )
    return compact(Surface(simplified[0].astype(np.float64), simplified[1].astype(np.int32)))


def whole_part(surface: Surface) -> tuple[Floats, float]:
    """Vertices of the largest part of a closed surface, and its share of the volume.

    Decimation can pinch a twig until four faces share an edge. Such an edge does not connect its faces here,
    because a tetrahedral mesh falls apart there.
    """
    edges = np.sort(surface.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    _, edge, count = np.unique(edges, axis=0, return_inverse=True, return_counts=True)
    edge = edge.reshape(-1)
    order = np.argsort(edge, kind="stable")
    pair = (order // 3)[(count == 2)[edge[order]]].reshape(-1, 2)
    graph = coo_matrix((np.ones(len(pair)), (pair[:, 0], pair[:, 1])), shape=(len(surface.faces),) * 2)
    parts, of_face = connected_components(graph, directed=False)
    volumes = signed_volumes(surface, of_face, parts)
    largest = surface.faces[of_face == np.argmax(volumes)]
    return surface.vertices[np.unique(largest)], float(volumes.max() / max(volumes.sum(), 1e-300))
