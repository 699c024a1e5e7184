"""Binding of rendered to simulated geometry: barycentric weights of render vertices in the tetrahedra.

Wood vertices follow the tet that contains them. Each connected piece of foliage or twigs follows the single
point where it is nearest to the wood, so that leaf cards are not deformed. Only pieces as large as a crown
follow the wood vertex by vertex.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import KDTree

from galewood.mesh import RenderPrimitive, Surface, TreeMesh, face_components, weld_keeping_faces
from galewood.tets import TetMesh
from galewood.util import Floats, Ints, Singles

CANDIDATES = 24
CROWN_SIZE = 0.15  # relative to the height; larger pieces of foliage are not rigid
CROWN_NEIGHBOURS = 8
CHUNK = 20_000
INSIDE_M = 1e-9  # rounding of the distance of a point inside a tetrahedron


@dataclass(frozen=True)
class Anchors:
    """Attachment of points: tet (n,), barycentric weights (n, 4), distance in metres (n,)."""

    tet: Ints
    weight: Floats
    distance_m: Floats


def render_binding(tree: TreeMesh, mesh: TetMesh) -> csr_matrix:
    """Weights (render vertices × tet vertices), rows summing to one, primitives in the tree's order."""
    anchors = [_anchor_primitive(_as_stored(primitive), tree.height_m, mesh) for primitive in tree.primitives]
    return _matrix(anchors, mesh)


def points_binding(points_m: Floats | Singles, mesh: TetMesh) -> csr_matrix:
    """Weights (points × tet vertices) of points (n, 3) in the wood."""
    anchors = nearest_tets(np.asarray(points_m, np.float64), mesh)
    return _matrix([(mesh.tets[anchors.tet], anchors.weight)], mesh)


def _as_stored(primitive: RenderPrimitive) -> RenderPrimitive:
    """The primitive with positions rounded to 32 bits, as stored in the render mesh.

    A leaf equally near to two twigs is then bound to the same one when that file is read again.
    """
    return replace(primitive, positions_m=primitive.positions_m.astype(np.float32).astype(np.float64))


def _matrix(parts: list[tuple[Ints, Floats]], mesh: TetMesh) -> csr_matrix:
    """Sparse matrix from (vertex indices (n, k), weights (n, k)); k may differ between parts."""
    rows: list[csr_matrix] = []
    for index, weight in parts:
        pointer = np.arange(len(index) + 1) * index.shape[1]
        shape = (len(index), len(mesh.vertices_m))
        rows.append(csr_matrix((weight.ravel(), index.ravel(), pointer), shape=shape))
    total = _stacked(rows)
    total.sum_duplicates()
    total.eliminate_zeros()
    return total


def _stacked(rows: list[csr_matrix]) -> csr_matrix:
    from scipy.sparse import vstack

    return csr_matrix(vstack(rows, format="csr"))


def _anchor_primitive(primitive: RenderPrimitive, height_m: float, mesh: TetMesh) -> tuple[Ints, Floats]:
    if primitive.kind == "wood":
        anchors = nearest_tets(primitive.positions_m, mesh)
        return mesh.tets[anchors.tet], anchors.weight
    pieces = foliage_pieces(primitive)
    anchors = nearest_tets(primitive.positions_m, mesh)
    index, weight = _rigid(anchors, pieces, mesh)
    large = piece_size(primitive.positions_m, pieces) > CROWN_SIZE * height_m
    if large.any():
        loose = large[pieces]
        index, weight = _padded(index, weight, 4 * CROWN_NEIGHBOURS)
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


def _rigid(anchors: Anchors, piece: Ints, mesh: TetMesh) -> tuple[Ints, Floats]:
    holder = nearest_of_pieces(anchors.distance_m, piece)[piece]
    return mesh.tets[anchors.tet[holder]].copy(), anchors.weight[holder].copy()


def _padded(index: Ints, weight: Floats, width: int) -> tuple[Ints, Floats]:
    extra = ((0, 0), (0, width - index.shape[1]))
    return np.pad(index, extra), np.pad(weight, extra)


def _blended(positions_m: Floats, mesh: TetMesh) -> tuple[Ints, Floats]:
    """Distance-weighted mean motion of the nearest tets: a closed crown follows without tearing."""
    count = min(CROWN_NEIGHBOURS, len(mesh.tets))
    gap, near = KDTree(mesh.vertices_m[mesh.tets].mean(axis=1)).query(positions_m, k=count)
    gap, near = gap.reshape(len(positions_m), -1), near.reshape(len(positions_m), -1)
    share = 1.0 / np.maximum(gap, 1e-9) ** 2
    share /= share.sum(axis=1, keepdims=True)
    index = mesh.tets[near].reshape(len(positions_m), -1)
    return _padded(index, np.repeat(share / 4.0, 4, axis=1), 4 * CROWN_NEIGHBOURS)


def nearest_tets(points_m: Floats, mesh: TetMesh) -> Anchors:
    """The tet that contains or is nearest to each point (n, 3), with clamped barycentric weights."""
    parts = [_nearest_chunk(points_m[i : i + CHUNK], mesh) for i in range(0, len(points_m), CHUNK)]
    return Anchors(
        np.concatenate([p.tet for p in parts]),
        np.concatenate([p.weight for p in parts]),
        np.concatenate([p.distance_m for p in parts]),
    )


def _nearest_chunk(points_m: Floats, mesh: TetMesh) -> Anchors:
    corners = mesh.vertices_m[mesh.tets]
    count = min(CANDIDATES, len(mesh.tets))
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
    return Anchors(near[row, best].astype(np.int32), weight[row, best], gap[row, best])
