"""Twigs raised to a radius that the mesher resolves, and by how much, so that the physics can take it back.

The local radius is that of the largest ball which touches the surface from inside (the shrinking-ball
algorithm,
Ma, Bae & Choi 2012, "3D medial axis point approximation using nearest neighbors and the normal field").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from precompute.intake_repair import Surface, face_components
from precompute.intake_types import Floats, Ints
from precompute.wrap_kernels import inner_balls, triangle_grid

SAMPLE_LEVEL = 2
MAX_CORNER = 2.0  # a corner of a triangular cross-section lies two inscribed radii from its centre
MAX_GRID = 200


@dataclass(frozen=True)
class Thickened:
    """The raised surface, and at sample points (k, 3) on it the original radius over the new one, in (0,
    1]."""

    surface: Surface
    sample_points: Floats
    sample_ratio: Floats


def thicken(surface: Surface, floor_radius: float) -> Thickened:
    """Every piece's vertices moved outwards until the inscribed radius is at least `floor_radius`."""
    points, normals, face = surface_samples(surface)
    radius = inscribed_radius(surface, points, normals, face, floor_radius)
    vertex_radius, vertex_reach = _at_vertices(surface, points, normals, face, radius)
    corner = np.clip(vertex_reach / np.maximum(vertex_radius, 1e-12), 1.0, MAX_CORNER)
    move = np.maximum(floor_radius - vertex_radius, 0.0) * corner
    raised = Surface(surface.vertices + move[:, None] * outward_normals(surface), surface.faces)
    weight = _barycentric(surface, points, face)
    on_raised = np.einsum("ij,ijk->ik", weight, raised.vertices[raised.faces[face]])
    return Thickened(raised, on_raised, np.minimum(1.0, radius / floor_radius))


def outward_normals(surface: Surface) -> Floats:
    """Vertex normals (n, 3), faces weighted by their angle, so that a coarse ring's normals point from
    its axis."""
    corners = surface.vertices[surface.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    total = np.zeros_like(surface.vertices)
    for k in range(3):
        one = corners[:, (k + 1) % 3] - corners[:, k]
        two = corners[:, (k + 2) % 3] - corners[:, k]
        angle = np.arctan2(np.linalg.norm(np.cross(one, two), axis=1), np.einsum("ij,ij->i", one, two))
        np.add.at(total, surface.faces[:, k], normal * angle[:, None])
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)


def surface_samples(surface: Surface) -> tuple[Floats, Floats, Ints]:
    """Points (k, 3) with outward normals and their face: four to a face."""
    corners = surface.vertices[surface.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    chosen = np.flatnonzero(area > 0)
    weights = _lattice(SAMPLE_LEVEL)
    face = np.repeat(chosen, len(weights)).astype(np.int32)
    points = np.einsum("wk,fkd->fwd", weights, corners[chosen]).reshape(-1, 3)
    return points, (cross / np.maximum(area, 1e-300)[:, None])[face], face


def _lattice(n: int) -> Floats:
    """Centres (n², 3) of the n² equal triangles that a triangle splits into, as barycentric weights."""
    rows = [(3 * i + 1, 3 * j + 1) for i in range(n) for j in range(n - i)]
    rows += [(3 * i + 2, 3 * j + 2) for i in range(n - 1) for j in range(n - 1 - i)]
    ab = np.array(rows, dtype=np.float64) / (3 * n)
    return np.column_stack([ab, 1.0 - ab.sum(axis=1)])


def inscribed_radius(surface: Surface, points: Floats, normals: Floats, face: Ints, limit: float) -> Floats:
    """Radius (k,), at most `limit`, of the largest ball inside its own piece that touches each point."""
    _, piece = face_components(surface.faces, len(surface.vertices))
    triangles = np.ascontiguousarray(surface.vertices[surface.faces])
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    cell = max(2.0 * limit, float((high - low).max()) / MAX_GRID)
    shape = tuple(int(n) + 1 for n in (high - low) / cell)
    offsets, items = triangle_grid(triangles, low, cell, shape)
    radius = inner_balls(points, normals, face, piece, triangles, low, cell, shape, offsets, items, limit)
    return _smooth(points, piece[face], radius)


def _smooth(points: Floats, piece: Ints, radius: Floats, neighbours: int = 8) -> Floats:
    """Median over the nearest samples: a ball caught in a corner of a coarse cross-section is too small."""
    _, near = cKDTree(points).query(points, k=min(neighbours, len(points)))
    values = np.where(piece[near] == piece[:, None], radius[near], np.nan)
    return np.nanmedian(values, axis=1)


def _at_vertices(
    surface: Surface, points: Floats, normals: Floats, face: Ints, radius: Floats
) -> tuple[Floats, Floats]:
    """Mean radius (n,) and distance to the medial centre (n,) at each vertex, nearer samples counting
    more."""
    centre = points - radius[:, None] * normals
    total, total_radius, total_reach = np.zeros((3, len(surface.vertices)))
    for k in range(3):
        vertex = surface.faces[face, k]
        gap = np.linalg.norm(points - surface.vertices[vertex], axis=1)
        reach = np.linalg.norm(centre - surface.vertices[vertex], axis=1)
        weight = 1.0 / (gap + 0.1 * radius + 1e-12) ** 2
        np.add.at(total, vertex, weight)
        np.add.at(total_radius, vertex, weight * radius)
        np.add.at(total_reach, vertex, weight * np.minimum(reach, MAX_CORNER * radius))
    total = np.maximum(total, 1e-300)
    return total_radius / total, total_reach / total


def _barycentric(surface: Surface, points: Floats, face: Ints) -> Floats:
    a, b, c = np.moveaxis(surface.vertices[surface.faces[face]], 1, 0)
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    u = np.einsum("ij,ij->i", np.cross(c - b, points - b), normal) / square
    v = np.einsum("ij,ij->i", np.cross(a - c, points - c), normal) / square
    return np.column_stack([u, v, 1.0 - u - v])
