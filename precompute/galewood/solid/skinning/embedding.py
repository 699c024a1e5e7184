"""Embedding of rendered in simulated geometry: barycentric weights of render vertices in the tetrahedra.

Wood vertices follow the tet that contains them. Each connected piece of foliage or twigs follows the single
point where it is nearest to the wood, so that leaf cards are not deformed. Only pieces as large as a crown
follow the wood vertex by vertex. The embedding decides where masses, wind and pulls act; what is drawn is
bound to the axis (``galewood.solid.skinning.surface_bindings``).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, vstack
from scipy.spatial import KDTree

from galewood.solid.tets import TetMesh
from galewood.tree import RenderPrimitive, Surface, TreeMesh, face_components, weld_keeping_faces
from galewood.util import Floats, Ints, Singles

COMPARED_TETS = 24
LARGEST_RIGID_PIECE = 0.15  # relative to the height; larger pieces of foliage are deformed
BLENDED_TETS = 8
CHUNK_POINTS = 20_000
INSIDE_M = 1e-9  # rounding of the distance of a point inside a tetrahedron


@dataclass(frozen=True)
class EmbeddedPoints:
    """Points in the nearest tets: tet (n,), barycentric weights (n, 4), distance_m (n,) from it."""

    tet: Ints
    weight: Floats
    distance_m: Floats


def render_embedding(tree: TreeMesh, mesh: TetMesh) -> csr_matrix:
    """Weights (render vertices × tet vertices), rows summing to one, primitives in the tree's order."""
    parts = [_embedded(as_stored(primitive), tree.height_m, mesh) for primitive in tree.primitives]
    return _matrix(parts, mesh)


def points_embedding(points_m: Floats | Singles, mesh: TetMesh) -> csr_matrix:
    """Weights (points × tet vertices) of points (n, 3) in the wood."""
    points = nearest_tets(np.asarray(points_m, np.float64), mesh)
    return _matrix([(mesh.tets[points.tet], points.weight)], mesh)


def as_stored(primitive: RenderPrimitive) -> RenderPrimitive:
    """The primitive with positions rounded to 32 bits, as stored in the render mesh.

    A leaf equally near to two twigs then follows the same one when that file is read again.
    """
    return replace(primitive, positions_m=primitive.positions_m.astype(np.float32).astype(np.float64))


def _matrix(parts: list[tuple[Ints, Floats]], mesh: TetMesh) -> csr_matrix:
    """Sparse matrix from (vertex indices (n, k), weights (n, k)); k may differ between parts."""
    rows: list[csr_matrix] = []
    for index, weight in parts:
        pointer = np.arange(len(index) + 1) * index.shape[1]
        shape = (len(index), len(mesh.vertices_m))
        rows.append(csr_matrix((weight.ravel(), index.ravel(), pointer), shape=shape))
    total = csr_matrix(vstack(rows, format="csr"))
    total.sum_duplicates()
    total.eliminate_zeros()
    return total


def _embedded(primitive: RenderPrimitive, height_m: float, mesh: TetMesh) -> tuple[Ints, Floats]:
    points = nearest_tets(primitive.positions_m, mesh)
    if primitive.kind == "wood":
        return mesh.tets[points.tet], points.weight
    pieces = foliage_pieces(primitive)
    leader = nearest_of_pieces(points.distance_m, pieces)[pieces]
    index, weight = mesh.tets[points.tet[leader]], points.weight[leader]
    large = piece_size(primitive.positions_m, pieces) > LARGEST_RIGID_PIECE * height_m
    if large.any():
        loose = large[pieces]
        index, weight = _padded(index, weight, 4 * BLENDED_TETS)
        index[loose], weight[loose] = _blended(primitive.positions_m[loose], mesh)
    return index, weight


def foliage_pieces(primitive: RenderPrimitive) -> Ints:
    """Connected component (n,) of each vertex across seams; unused vertices are separate components."""
    welded = weld_keeping_faces(Surface(primitive.positions_m, primitive.faces))
    _, of_face = face_components(welded.faces, len(welded.vertices))
    piece = np.full(len(primitive.positions_m), -1, dtype=np.int64)
    piece[primitive.faces.ravel()] = np.repeat(of_face, 3)
    lone = np.flatnonzero(piece < 0)
    piece[lone] = int(of_face.max()) + 1 + np.arange(len(lone))
    return piece.astype(np.int32)


def piece_size(positions_m: Floats, piece: Ints) -> Floats:
    """Diagonal (count,) of the bounding box of each component, m."""
    count = int(piece.max()) + 1
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    np.minimum.at(low, piece, positions_m)
    np.maximum.at(high, piece, positions_m)
    return np.linalg.norm(high - low, axis=1)


def nearest_of_pieces(distance_m: Floats, piece: Ints) -> Ints:
    """For each component (count,), its vertex nearest to the wood, given the distances (n,) of all.

    Of several inside the wood the first is taken: a twig begins at its base, and may pierce another limb.
    """
    order = np.lexsort((np.where(distance_m < INSIDE_M, 0.0, distance_m), piece))
    _, first = np.unique(piece[order], return_index=True)
    return order[first].astype(np.int32)


def leading_vertices(primitive: RenderPrimitive, distance_m: Floats, largest_m: float) -> Ints:
    """The vertex (n,) that each vertex of foliage or twigs follows: that of its piece nearest to the wood.

    ``distance_m`` (n,) are the distances from the wood. Vertices of pieces larger than ``largest_m`` follow
    themselves.
    """
    piece = foliage_pieces(primitive)
    leader = nearest_of_pieces(distance_m, piece)[piece]
    loose = piece_size(primitive.positions_m, piece) > largest_m
    return np.where(loose[piece], np.arange(len(piece)), leader)


def _padded(index: Ints, weight: Floats, width: int) -> tuple[Ints, Floats]:
    extra = ((0, 0), (0, width - index.shape[1]))
    return np.pad(index, extra), np.pad(weight, extra)


def _blended(positions_m: Floats, mesh: TetMesh) -> tuple[Ints, Floats]:
    """Distance-weighted mean motion of the nearest tets: a closed crown follows without tearing."""
    count = min(BLENDED_TETS, len(mesh.tets))
    gap, near = KDTree(mesh.vertices_m[mesh.tets].mean(axis=1)).query(positions_m, k=count)
    gap, near = gap.reshape(len(positions_m), -1), near.reshape(len(positions_m), -1)
    share = 1.0 / np.maximum(gap, 1e-9) ** 2
    share /= share.sum(axis=1, keepdims=True)
    index = mesh.tets[near].reshape(len(positions_m), -1)
    return _padded(index, np.repeat(share / 4.0, 4, axis=1), 4 * BLENDED_TETS)


def nearest_tets(points_m: Floats, mesh: TetMesh) -> EmbeddedPoints:
    """The tet that contains or is nearest to each point (n, 3), with clamped barycentric weights."""
    starts = range(0, len(points_m), CHUNK_POINTS)
    parts = [_nearest_chunk(points_m[start : start + CHUNK_POINTS], mesh) for start in starts]
    return EmbeddedPoints(
        np.concatenate([p.tet for p in parts]),
        np.concatenate([p.weight for p in parts]),
        np.concatenate([p.distance_m for p in parts]),
    )


def _nearest_chunk(points_m: Floats, mesh: TetMesh) -> EmbeddedPoints:
    corners = mesh.vertices_m[mesh.tets]
    count = min(COMPARED_TETS, len(mesh.tets))
    _, near = KDTree(corners.mean(axis=1)).query(points_m, k=count)
    near = near.reshape(len(points_m), -1)
    inverse = np.linalg.inv((corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1))
    local = np.einsum("nkij,nkj->nki", inverse[near], points_m[:, None] - corners[near, 0])
    weight = np.concatenate([1.0 - local.sum(axis=2, keepdims=True), local], axis=2)
    weight = np.maximum(weight, 0.0)
    weight /= weight.sum(axis=2, keepdims=True)
    gap = np.linalg.norm(np.einsum("nkc,nkcd->nkd", weight, corners[near]) - points_m[:, None], axis=2)
    best = np.argmin(gap, axis=1)
    row = np.arange(len(points_m))
    return EmbeddedPoints(near[row, best].astype(np.int32), weight[row, best], gap[row, best])
