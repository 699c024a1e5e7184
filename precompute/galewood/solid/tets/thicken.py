"""Thickening of twigs to a radius that the mesher resolves, with the ratio that the physics needs to undo it.

The local radius is that of the largest ball that touches the surface from inside (after Ma, Bae & Choi 2012,
"3D medial axis point approximation using nearest neighbors and the normal field").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.tets.wrap_kernels import inner_balls, triangle_grid
from galewood.tree import Surface, face_components
from galewood.util import Floats, Ints

NEAR_SIDES = np.array([[0.02, 0.49, 0.49], [0.49, 0.02, 0.49], [0.49, 0.49, 0.02]])
MAX_MITRE = 2.0  # an edge of a triangular prism moves twice as far as its faces
MAX_GRID = 200


@dataclass(frozen=True)
class Thickened:
    """The thickened surface and, at sample points (k, 3) on it, the original over the new radius."""

    surface: Surface
    sample_points: Floats
    sample_ratio: Floats


def thicken(surface: Surface, floor_radius: float) -> Thickened:
    """Offset the vertices of every component until the inscribed radius is at least `floor_radius`."""
    points, normals, face = surface_samples(surface)
    radius = inscribed_radius(surface, points, normals, face, floor_radius)
    lack = np.maximum(floor_radius - _at_vertices(surface, face, radius), 0.0)
    normal, mitre = _normals_and_mitre(surface)
    raised = Surface(surface.vertices + (lack * mitre)[:, None] * normal, surface.faces)
    weight = _barycentric(surface, points, face)
    on_raised = np.einsum("ij,ijk->ik", weight, raised.vertices[raised.faces[face]])
    return Thickened(raised, on_raised, np.minimum(1.0, radius / floor_radius))


def _normals_and_mitre(surface: Surface) -> tuple[Floats, Floats]:
    """Vertex normals (n, 3), and the distance (n,) a vertex moves per unit offset of its faces.

    The distance is 1 on a plane and 2 on an edge of 60°. Faces are weighted by their corner angle, so that
    the normals of a coarse ring point away from its axis.
    """
    corners = surface.vertices[surface.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    angle = np.stack([_corner_angle(corners, k) for k in range(3)])
    total = np.zeros_like(surface.vertices)
    for k in range(3):
        np.add.at(total, surface.faces[:, k], normal * angle[k][:, None])
    total /= np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)
    along, weight = np.zeros((2, len(surface.vertices)))
    for k in range(3):
        vertex = surface.faces[:, k]
        np.add.at(along, vertex, angle[k] * np.einsum("ij,ij->i", total[vertex], normal))
        np.add.at(weight, vertex, angle[k])
    return total, np.clip(weight / np.maximum(along, 1e-12), 1.0, MAX_MITRE)


def _corner_angle(corners: Floats, k: int) -> Floats:
    one, two = corners[:, (k + 1) % 3] - corners[:, k], corners[:, (k + 2) % 3] - corners[:, k]
    return np.arctan2(np.linalg.norm(np.cross(one, two), axis=1), np.einsum("ij,ij->i", one, two))


def surface_samples(surface: Surface) -> tuple[Floats, Floats, Ints]:
    """Sample points (k, 3) with outward normals and face indices, near the middle of each side of each face.

    Two of the three lie half-way across a tube's facet, where the inscribed ball touches it.
    """
    corners = surface.vertices[surface.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    chosen = np.flatnonzero(area > 0)
    face = np.repeat(chosen, len(NEAR_SIDES)).astype(np.int32)
    points = np.einsum("wk,fkd->fwd", NEAR_SIDES, corners[chosen]).reshape(-1, 3)
    return points, (cross / np.maximum(area, 1e-300)[:, None])[face], face


def inscribed_radius(surface: Surface, points: Floats, normals: Floats, face: Ints, limit: float) -> Floats:
    """Radius (k,), at most `limit`, of the largest ball inside its component that touches each point."""
    _, piece = face_components(surface.faces, len(surface.vertices))
    triangles = np.ascontiguousarray(surface.vertices[surface.faces])
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    cell = max(2.0 * limit, float((high - low).max()) / MAX_GRID)
    shape = tuple(int(n) + 1 for n in (high - low) / cell)
    grid = (low, cell, shape, *triangle_grid(triangles, low, cell, shape))
    face_normals = np.zeros_like(triangles[:, 0])
    face_normals[face] = normals
    radius = inner_balls(points, normals, face, piece, face_normals, triangles, grid, limit)
    return _smooth(points, piece[face], radius)


def _smooth(points: Floats, piece: Ints, radius: Floats, neighbours: int = 8) -> Floats:
    """Median over the nearest samples: balls in the corners of a coarse cross-section are too small."""
    _, near = KDTree(points).query(points, k=min(neighbours, len(points)))
    values = np.where(piece[near] == piece[:, None], radius[near], np.nan)
    return np.nanmedian(values, axis=1)


def _at_vertices(surface: Surface, face: Ints, radius: Floats) -> Floats:
    """Smallest radius (n,) of the samples on the faces of each vertex; end caps have no samples."""
    result = np.full(len(surface.vertices), np.inf)
    for k in range(3):
        np.minimum.at(result, surface.faces[face, k], radius)
    return result


def _barycentric(surface: Surface, points: Floats, face: Ints) -> Floats:
    a, b, c = np.moveaxis(surface.vertices[surface.faces[face]], 1, 0)
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    u = np.einsum("ij,ij->i", np.cross(c - b, points - b), normal) / square
    v = np.einsum("ij,ij->i", np.cross(a - c, points - c), normal) / square
    return np.column_stack([u, v, 1.0 - u - v])
