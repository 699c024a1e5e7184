"""Correction of the radius ratio by comparing the volume of the input surface with that of the meshed solid.

The solid is thicker than the input wherever a twig is thinner than the mesher resolves and where close twigs
fuse. For each stretch of the skeleton, the volume enclosed by the input surface is compared with that of the
solid: the ratio of the volumes is that of the cross-sections, and its square root that of the radii. Mass and
stiffness thus correspond to the input wood.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.skeleton.centre import line_tangents
from galewood.solid.tets import TetMesh, scattered_weights, tet_volumes
from galewood.tree import Surface, TreeMesh
from galewood.util import Floats, Int32s

SAMPLES_PER_STEP = 6.0
SMOOTHING_ROUNDS = 2
"""Rounds of adding the neighbours on the branch to each stretch; a single stretch has only two or three tets.
"""
SMALLEST_SHARE = 0.5
"""Lower limit of the result, relative to the ratio recorded by the thickening."""
LARGEST_RATIO = 1.15
"""Upper limit of the result: decimation removes at most a little from the corners of a limb."""


class Line(Protocol):
    """The part of a Skeleton that is used here; ``tet_point`` (m,) is the point that each cell belongs to."""

    @property
    def points_m(self) -> Floats: ...
    @property
    def parent(self) -> Int32s: ...
    @property
    def branch(self) -> Int32s: ...
    @property
    def tet_point(self) -> Int32s: ...


def with_corrected_radii(tree: TreeMesh, mesh: TetMesh, line: Line) -> TetMesh:
    """The mesh with its radius ratio corrected by the volume of the tree's wood surface."""
    ratio = corrected_ratio(Surface(tree.wood_vertices_m, tree.wood_faces), mesh, line)
    return replace(mesh, radius_ratio=ratio)


def corrected_ratio(wood: Surface, solid: TetMesh, line: Line) -> Floats:
    """Radius of the input wood over that of the solid (m,), in (0, LARGEST_RATIO], for each tetrahedron."""
    volume_m3 = input_volume(wood, solid.vertices_m[solid.tets].mean(axis=1), line)
    meshed = _sums(line.tet_point, tet_volumes(solid.vertices_m, solid.tets), line)
    recorded = _mean_of_stretch(solid.radius_ratio, line)
    return _ratio(volume_m3, meshed, recorded, line)[line.tet_point]


def corrected_radii(wood: Surface, joined: Surface, recorded: Floats, line: Line) -> Floats:
    """Radius of the input wood over that of the joined surface (p,) at each point of a line.

    ``recorded`` (m,) is the ratio by which each face of the joined surface was thickened; the line says which
    point the faces belong to.
    """
    centre = joined.vertices[joined.faces].mean(axis=1)
    volume_m3, around = (input_volume(surface, centre, line) for surface in (wood, joined))
    return _ratio(volume_m3, around, _mean_of_stretch(recorded, line), line)


def _ratio(volume_m3: Floats, meshed: Floats, recorded: Floats, line: Line) -> Floats:
    both = np.column_stack([volume_m3, meshed])
    for _ in range(SMOOTHING_ROUNDS):
        both = _with_neighbours(both, line)
    ratio = np.sqrt(np.maximum(both[:, 0], 0.0) / np.maximum(both[:, 1], 1e-300))
    return np.clip(ratio, SMALLEST_SHARE * recorded, LARGEST_RATIO)


def input_volume(wood: Surface, centre: Floats, line: Line) -> Floats:
    """Volume (p,), m³, of the input wood around each skeleton point; centre (m, 3) of each cell, m.

    By the divergence theorem across the branch, A = ½ ∮ x·n for each closed outline and any origin, so that
    several twigs in one stretch add up.
    """
    step_m = float(np.median(np.linalg.norm(line.points_m[1:] - line.points_m[line.parent[1:]], axis=1)))
    face, weight = scattered_weights(wood, step_m / SAMPLES_PER_STEP)
    corners = wood.vertices[wood.faces]
    point = np.einsum("kw,kwd->kd", weight, corners[face])
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    normal /= np.bincount(face, minlength=len(corners))[:, None]
    stretch = line.tet_point[KDTree(centre).query(point)[1]]
    away = point - line.points_m[stretch]
    along = _axes(normal[face], stretch, line)[stretch]
    away -= np.einsum("ij,ij->i", away, along)[:, None] * along
    return _sums(stretch, np.einsum("ij,ij->i", away, normal[face]) / 2, line)


def _sums(stretch: Int32s, values: Floats, line: Line) -> Floats:
    """Sums (p,) of the values (k,) that belong to each stretch."""
    return np.bincount(stretch, values, len(line.parent)).astype(np.float64)


def _axes(normal: Floats, stretch: Int32s, line: Line) -> Floats:
    """Unit axis (p, 3) of the surface around each point: the direction most perpendicular to its normals.

    Branch ends and trunk bases, which face along the skeleton, are given no weight.
    """
    area = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    facing = np.einsum("ki,ki->k", normal, _tangents(line)[stretch]) / area
    weight = (1.0 - np.clip(facing, -1.0, 1.0) ** 2) ** 2 / area
    outer = np.einsum("k,ki,kj->kij", weight, normal, normal)
    tensor = np.stack([_sums(stretch, column, line) for column in outer.reshape(-1, 9).T], axis=1)
    return np.linalg.eigh(_with_neighbours(tensor, line).reshape(-1, 3, 3))[1][:, :, 0]


def _tangents(line: Line) -> Floats:
    """Unit tangents (p, 3) along each point's branch, including the point that the branch grows from."""
    tangent = np.zeros_like(line.points_m)
    for number in range(int(line.branch.max()) + 1):
        own = np.flatnonzero(line.branch == number)
        base = line.parent[own[0]]
        before = line.points_m[base : base + 1] if base >= 0 else np.zeros((0, 3))
        tangent[own] = line_tangents(np.concatenate([before, line.points_m[own]]))[-len(own) :]
    return tangent


def _with_neighbours(values: Floats, line: Line) -> Floats:
    """The values of each stretch (p, k) plus those of its neighbours on the same branch."""
    child = np.flatnonzero((line.parent >= 0) & (line.branch[line.parent] == line.branch))
    total = values.copy()
    total[child] += values[line.parent[child]]
    np.add.at(total, line.parent[child], values[child])
    return total


def _mean_of_stretch(ratio: Floats, line: Line) -> Floats:
    count = _sums(line.tet_point, np.ones(len(ratio)), line)
    return _sums(line.tet_point, ratio, line) / np.maximum(count, 1.0)
