"""How much wood was drawn in each stretch of the solid, so that thickened twigs weigh and bend as drawn.

The solid that is meshed is thicker than the drawing wherever a twig is thinner than the mesher resolves, and
where twigs lie so close that they fuse. Stretch by stretch along the skeleton, the drawn surface's own volume
is compared with the solid's: the ratio of the volumes is that of the cross-sections, and its root that of the
radii.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Protocol

import numpy as np
from scipy.spatial import KDTree

from galewood.mesh import Surface, TreeMesh
from galewood.skeleton.centre import line_tangents
from galewood.tets import TetMesh, scattered_weights, tet_volumes
from galewood.util import Floats, Int32s

SAMPLES_PER_STEP = 6.0
SMOOTHING = 2
"""Rounds of adding each stretch's neighbours on its branch to it: a stretch alone holds two or three tets."""
DOUBT = 0.5
"""The result is not believed below this share of what the thickening itself noted."""
MOST = 1.15
"""Nor above this: decimation takes a little off a limb's corners, never more."""


class Solid(Protocol):
    """What of a TetMesh is needed here."""

    @property
    def vertices_m(self) -> Floats: ...
    @property
    def tets(self) -> Int32s: ...
    @property
    def radius_ratio(self) -> Floats: ...


class Line(Protocol):
    """What of a Skeleton is needed here."""

    @property
    def points_m(self) -> Floats: ...
    @property
    def parent(self) -> Int32s: ...
    @property
    def branch(self) -> Int32s: ...
    @property
    def tet_point(self) -> Int32s: ...


def with_corrected_radii(tree: TreeMesh, mesh: TetMesh, line: Line) -> TetMesh:
    """The mesh with the ratio of radii that its skeleton and the drawing's volume give."""
    ratio = drawn_ratio(Surface(tree.wood_vertices_m, tree.wood_faces), mesh, line)
    return replace(mesh, radius_ratio=ratio)


def drawn_ratio(wood: Surface, solid: Solid, line: Line) -> Floats:
    """Radius of the drawn wood over the solid's (m,), in (0, MOST], for each tetrahedron."""
    drawn = drawn_volume(wood, solid, line)
    meshed = _sums(line.tet_point, tet_volumes(solid.vertices_m, solid.tets), line)
    noted = _mean_of_stretch(solid.radius_ratio, line)
    both = np.column_stack([drawn, meshed])
    for _ in range(SMOOTHING):
        both = _with_neighbours(both, line)
    ratio = np.sqrt(np.maximum(both[:, 0], 0.0) / np.maximum(both[:, 1], 1e-300))
    return np.clip(ratio, DOUBT * noted, MOST)[line.tet_point]


def drawn_volume(wood: Surface, solid: Solid, line: Line) -> Floats:
    """Volume (p,) m³ of the drawn wood around each skeleton point.

    By the divergence theorem across the branch: A = ½ ∮ x·n for each closed outline, whatever the origin, so
    that wood of several twigs in one stretch adds up.
    """
    centre = solid.vertices_m[solid.tets].mean(axis=1)
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
    """(p,) sums of the values (k,) that belong to each stretch."""
    return np.bincount(stretch, values, len(line.parent)).astype(np.float64)


def _axes(normal: Floats, stretch: Int32s, line: Line) -> Floats:
    """Unit axis (p, 3) of the surface around each point: the direction that its normals are across to.

    Ends of branches and feet of trunks, which face along the skeleton, do not count.
    """
    area = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    facing = np.einsum("ki,ki->k", normal, _tangents(line)[stretch]) / area
    weight = (1.0 - np.clip(facing, -1.0, 1.0) ** 2) ** 2 / area
    outer = np.einsum("k,ki,kj->kij", weight, normal, normal)
    tensor = np.stack([_sums(stretch, column, line) for column in outer.reshape(-1, 9).T], axis=1)
    return np.linalg.eigh(_with_neighbours(tensor, line).reshape(-1, 3, 3))[1][:, :, 0]


def _tangents(line: Line) -> Floats:
    """Unit tangents (p, 3) along each point's own branch, the point that it grows from before it."""
    tangent = np.zeros_like(line.points_m)
    for number in range(int(line.branch.max()) + 1):
        own = np.flatnonzero(line.branch == number)
        base = line.parent[own[0]]
        before = line.points_m[base : base + 1] if base >= 0 else np.zeros((0, 3))
        tangent[own] = line_tangents(np.concatenate([before, line.points_m[own]]))[-len(own) :]
    return tangent


def _with_neighbours(values: Floats, line: Line) -> Floats:
    """Each stretch's values (p, k) with those of its neighbours on the same branch added."""
    child = np.flatnonzero((line.parent >= 0) & (line.branch[line.parent] == line.branch))
    total = values.copy()
    total[child] += values[line.parent[child]]
    np.add.at(total, line.parent[child], values[child])
    return total


def _mean_of_stretch(ratio: Floats, line: Line) -> Floats:
    count = _sums(line.tet_point, np.ones(len(ratio)), line)
    return _sums(line.tet_point, ratio, line) / np.maximum(count, 1.0)
