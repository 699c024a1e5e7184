"""Checks of a tetrahedral mesh: connectivity, orientation, volume and extent."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from galewood.util import Floats, Ints

FACES_OF_TET = np.array([[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]])  # outward for a positively oriented tet
GROWTH_ROUNDS = 6


def tet_volumes(vertices: Floats, tets: Ints) -> Floats:
    """Signed volumes (m,)."""
    a, b, c, d = np.moveaxis(vertices[tets], 1, 0)
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6.0


def boundary_faces(tets: Ints) -> Ints:
    """Faces (k, 3) that belong to exactly one tet, oriented outwards."""
    faces = tets[:, FACES_OF_TET].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[first[count == 1]]


def largest_component(vertices: Floats, tets: Ints) -> tuple[Floats, Ints, int]:
    """The largest component connected through faces, positively oriented, without unused vertices.

    Returns vertices, tets and the number of components removed.
    """
    keys = np.sort(tets[:, FACES_OF_TET].reshape(-1, 3), axis=1)
    _, face = np.unique(keys, axis=0, return_inverse=True)
    owner = np.repeat(np.arange(len(tets)), 4)
    incidence = coo_matrix(
        (np.ones(len(owner)), (owner, face.reshape(-1))), shape=(len(tets), int(face.max()) + 1)
    ).tocsr()
    count, label = connected_components(incidence @ incidence.T, directed=False)
    volumes = np.abs(tet_volumes(vertices, tets))
    tets = tets[label == np.argmax(np.bincount(label, volumes))]
    negative = tet_volumes(vertices, tets) < 0
    tets[negative] = tets[negative][:, [0, 1, 3, 2]]
    used, inverse = np.unique(tets, return_inverse=True)
    return np.ascontiguousarray(vertices[used]), inverse.reshape(-1, 4).astype(np.int32), int(count) - 1


def restore_volume(vertices: Floats, tets: Ints, wanted: float) -> Floats:
    """Offset the surface vertices along their normals by a common distance until the volume is `wanted`.

    Decimation cuts corners and the mesher stays within its envelope; both remove the same thickness from
    trunk and twigs. Vertices of tets that the offset would invert are not moved.
    """
    faces = boundary_faces(tets)
    result = vertices
    held = np.zeros(len(vertices), dtype=bool)
    for _ in range(GROWTH_ROUNDS):
        missing = wanted - float(tet_volumes(result, tets).sum())
        normal, area = vertex_normals(result, faces)
        if abs(missing) < 1e-4 * wanted:
            break
        move = normal * (missing / area)
        move[held] = 0.0
        before = tet_volumes(result, tets)
        turned = tet_volumes(result + move, tets) < 0.3 * before
        held[np.unique(tets[turned])] = True
        move[held] = 0.0
        if (tet_volumes(result + move, tets) <= 0).any():
            break
        result = result + move
    return result


def vertex_normals(vertices: Floats, faces: Ints) -> tuple[Floats, float]:
    """Unit normals (n, 3), zero at vertices without faces, and the total area of the faces."""
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    total = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(total, faces[:, k], cross)
    length = np.linalg.norm(total, axis=1, keepdims=True)
    return total / np.maximum(length, 1e-300), float(np.linalg.norm(cross, axis=1).sum() / 2)


def lost_extent(before: Floats, after: Floats) -> float:
    """Largest loss over the six sides of the bounding box, relative to its size."""
    size = float(np.ptp(before, axis=0).max())
    low = (after.min(axis=0) - before.min(axis=0)) / size
    high = (before.max(axis=0) - after.max(axis=0)) / size
    return float(max(low.max(), high.max(), 0.0))


def quality_report(vertices: Floats, tets: Ints) -> dict[str, Any]:
    """Counts, volume and the worst element quality (6√2 V / l_rms³; 1 for a regular tet)."""
    volumes = tet_volumes(vertices, tets)
    corners = vertices[tets]
    pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
    square = np.mean([((corners[:, i] - corners[:, j]) ** 2).sum(axis=1) for i, j in pairs], axis=0)
    shape = 6.0 * np.sqrt(2.0) * volumes / square**1.5
    return {
        "tets": len(tets),
        "vertices": len(vertices),
        "components": 1,
        "volume_m3": float(volumes.sum()),
        "shape_min": float(shape.min()),
        "shape_5_percent": float(np.percentile(shape, 5)),
        "shape_median": float(np.median(shape)),
    }
