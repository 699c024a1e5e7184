"""Places primitives in the scene: as a whole, several times, or vertex by vertex."""

from __future__ import annotations

import numpy as np

from galewood.formats.gltf.primitive import Primitive
from galewood.formats.types import RawPart
from galewood.util import Floats, Ints


def moved_as_a_whole(primitive: Primitive, matrices: Floats) -> RawPart:
    """One part with a copy of the primitive for each of the matrices (k, 4, 4)."""
    count, copies = len(primitive.positions), len(matrices)
    positions = [primitive.positions @ m[:3, :3].T + m[:3, 3] for m in matrices]
    faces = [_wound(primitive.faces, m) + k * count for k, m in enumerate(matrices)]
    normals = None
    if primitive.normals is not None:
        normals = np.concatenate([_turned(primitive.normals, m) for m in matrices])
    return RawPart(
        labels=primitive.labels,
        positions=np.concatenate(positions),
        faces=np.concatenate(faces).astype(np.int32),
        normals=normals,
        uv=None if primitive.uv is None else np.tile(primitive.uv, (copies, 1)),
        colours=None if primitive.colours is None else np.tile(primitive.colours, (copies, 1)),
        material=primitive.material,
    )


def moved_by_vertex(primitive: Primitive, matrices: Floats) -> RawPart:
    """The primitive with a matrix (n, 4, 4) for each vertex, as a skin moves it."""
    normals = primitive.normals
    if normals is not None:
        linear = matrices[:, :3, :3]
        sound = np.abs(np.linalg.det(linear)) > 1e-30
        inverse = np.linalg.inv(np.where(sound[:, None, None], linear, np.eye(3)))
        normals = _unit(np.einsum("nji,nj->ni", inverse, normals))
    return RawPart(
        labels=primitive.labels,
        positions=np.einsum("nij,nj->ni", matrices[:, :3, :3], primitive.positions) + matrices[:, :3, 3],
        faces=_wound(primitive.faces, matrices.mean(axis=0) if len(matrices) else np.eye(4)),
        normals=normals,
        uv=primitive.uv,
        colours=primitive.colours,
        material=primitive.material,
    )


def _wound(faces: Ints, matrix: Floats) -> Ints:
    """The faces, reversed if the matrix mirrors them: they would otherwise be inside out."""
    return np.ascontiguousarray(faces[:, ::-1]) if np.linalg.det(matrix[:3, :3]) < 0 else faces


def _turned(normals: Floats, matrix: Floats) -> Floats:
    linear = matrix[:3, :3]
    if abs(np.linalg.det(linear)) < 1e-30:
        return normals
    return _unit(normals @ np.linalg.inv(linear))  # rows times (A⁻ᵀ)ᵀ


def _unit(rows: Floats) -> Floats:
    return rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), 1e-30)
