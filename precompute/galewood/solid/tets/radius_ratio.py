"""Ratio of the original to the thickened radius for each tetrahedron."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.tets.quality import boundary_faces
from galewood.solid.tets.thicken import Thickened
from galewood.tree import Surface, face_components
from galewood.util import Floats, Ints

NEIGHBOUR_COUNT = 12


def radius_ratio(raised: Thickened, vertices: Floats, tets: Ints, floor_m: float) -> Floats:
    """Original over thickened radius (m,) of each tet, from the nearest points on the surface of the solid.

    A twig starts inside its parent limb, where its surface says nothing about the limb. Points hidden inside
    the solid are therefore ignored.
    """
    points, face = scattered(raised.surface, floor_m / 2)
    skin, _ = scattered(Surface(vertices, boundary_faces(tets)), floor_m / 2)
    shown = KDTree(skin).query(points)[0] < floor_m
    if not shown.any():
        shown[:] = True
    ratio = _ratio_at(raised, points, face)[shown]
    gap, near = KDTree(points[shown]).query(vertices[tets].mean(axis=1), k=min(NEIGHBOUR_COUNT, len(ratio)))
    gap, near = gap.reshape(len(tets), -1), near.reshape(len(tets), -1)
    # Where a twig leaves a limb, both are near; the wood there belongs to the limb.
    return np.where(gap <= gap[:, :1] + floor_m / 2, ratio[near], 0.0).max(axis=1)


def _ratio_at(raised: Thickened, points: Floats, face: Ints) -> Floats:
    """Ratio (k,) at points (k, 3) on its surface, from the nearest sample of the same component."""
    _, of_face = face_components(raised.surface.faces, len(raised.surface.vertices))
    piece = of_face[face]
    sample_piece = piece[KDTree(points).query(raised.sample_points)[1]]
    ratio = np.ones(len(points))
    for label in np.unique(piece):
        own, samples = piece == label, sample_piece == label
        if samples.any():
            near = KDTree(raised.sample_points[samples]).query(points[own])[1]
            ratio[own] = raised.sample_ratio[samples][near]
    return ratio


def scattered(surface: Surface, spacing: float) -> tuple[Floats, Ints]:
    """Points (k, 3) about `spacing` apart on the surface, at least four per face, and their faces (k,).

    Additive R2 sequence (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
    """
    face, weight = scattered_weights(surface, spacing)
    return np.einsum("kw,kwd->kd", weight, surface.vertices[surface.faces][face]), face


def scattered_weights(surface: Surface, spacing: float) -> tuple[Ints, Floats]:
    """The points of `scattered` as faces (k,) and barycentric weights (k, 3)."""
    corners = surface.vertices[surface.faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    face = np.repeat(np.arange(len(corners)), np.maximum(4, np.ceil(area / spacing**2)).astype(np.int64))
    place = np.arange(len(face))[:, None] * np.array([0.7548776662466927, 0.5698402909980532]) % 1.0
    folded = np.where(place.sum(axis=1, keepdims=True) > 1.0, 1.0 - place, place)
    return face.astype(np.int32), np.column_stack([1.0 - folded.sum(axis=1), folded])
