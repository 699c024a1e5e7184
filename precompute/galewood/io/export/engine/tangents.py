"""Tangents of meshes that have a picture of normals (glTF 2.0, section 3.7.2.1)."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from galewood.io.export.gltf_file import ARRAY_BUFFER, GltfFile
from galewood.util import Floats, Ints

TANGENT_NAME = "TANGENT"
LEAST_AREA = 1e-12
"""Of a triangle in texture space, relative to the unit square: smaller ones have no direction."""


def add_tangents(file: GltfFile) -> None:
    """Add TANGENT to every mesh with texture coordinates whose material has a picture of normals."""
    splits = np.cumsum(file.counts)[:-1]
    positions, normals = np.split(file.rest_m(), splits), np.split(file.normals(), splits)
    parts = zip(file.gltf.meshes, positions, normals, file.texture_coordinates(), file.faces(), strict=True)
    for mesh, rest_m, normal, uv, faces in parts:
        primitive = mesh.primitives[0]
        bumpy = primitive.material is not None and file.gltf.materials[primitive.material].normalTexture
        if bumpy and uv is not None:
            rows = tangents(rest_m, normal, uv.astype(np.float64), faces)
            setattr(primitive.attributes, TANGENT_NAME, file.add_rows(rows, target=ARRAY_BUFFER))


def tangents(rest_m: Floats, normal: Floats, uv: Floats, faces: Ints) -> npt.NDArray[np.float32]:
    """(v, 4) unit tangents, orthogonal to the normals, and in w on which side the bitangent lies.

    The tangent points where u grows; the bitangent w (normal × tangent) where v becomes smaller, as glTF
    counts v from the top of a picture. Triangles at a vertex count by their angle there. Unlike MikkTSpace,
    no vertex is split: where a picture is mirrored along an edge, the vertices there take the side of the
    larger angles.

    Args:
        rest_m: (v, 3) vertices.
        normal: (v, 3) their normals.
        uv: (v, 2) texture coordinates.
        faces: (f, 3) triangles.
    """
    corner_m, corner_uv = rest_m[faces], uv[faces]
    edge_m, edge_uv = corner_m[:, 1:] - corner_m[:, :1], corner_uv[:, 1:] - corner_uv[:, :1]
    area = edge_uv[:, 0, 0] * edge_uv[:, 1, 1] - edge_uv[:, 1, 0] * edge_uv[:, 0, 1]
    side = np.where(np.abs(area) > LEAST_AREA, np.sign(area), 0.0)[:, None]
    along = side * (edge_m[:, 0] * edge_uv[:, 1, 1:] - edge_m[:, 1] * edge_uv[:, 0, 1:])
    down = side * (edge_m[:, 1] * edge_uv[:, 0, :1] - edge_m[:, 0] * edge_uv[:, 1, :1])
    along, down, sums = _unit(along), _unit(down), np.zeros((2, *rest_m.shape))
    for corner in range(3):
        angle = _angles(corner_m, corner)[:, None]
        np.add.at(sums[0], faces[:, corner], angle * along)
        np.add.at(sums[1], faces[:, corner], angle * down)
    across = sums[0] - (sums[0] * normal).sum(axis=1, keepdims=True) * normal
    lost = np.linalg.norm(across, axis=1) < 1e-9
    across[lost] = np.cross(normal[lost], np.eye(3)[np.abs(normal[lost]).argmin(axis=1)])
    tangent = _unit(across)
    w = np.where((np.cross(normal, tangent) * sums[1]).sum(axis=1) > 0, -1.0, 1.0)
    return np.column_stack([tangent, w]).astype(np.float32)


def _angles(corner_m: Floats, corner: int) -> Floats:
    """(f,) angle of each triangle at a corner, rad."""
    first = _unit(corner_m[:, (corner + 1) % 3] - corner_m[:, corner])
    second = _unit(corner_m[:, (corner + 2) % 3] - corner_m[:, corner])
    return np.arccos(np.clip((first * second).sum(axis=1), -1.0, 1.0))


def _unit(vectors: Floats) -> Floats:
    """Vectors (n, 3) of length 1; those of no length stay."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)
