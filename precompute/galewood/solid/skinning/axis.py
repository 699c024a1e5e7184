"""The axis of the branches as a model moves it.

The axis is a tree of points with a displacement and a rotation each: those of the skeleton of the wood, or of
the frame of beams. A vertex is bound to a link between two points, which move and turn it by linear weights.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial import KDTree

from galewood.solid.beams import Frame
from galewood.solid.skeleton import Skeleton
from galewood.solid.skinning.bindings import AxisPaths, Bindings
from galewood.solid.skinning.embedding import nearest_tets
from galewood.solid.tets import TetMesh
from galewood.util import Floats, Ints

PLACES_PER_LINK = 4
"""Places along a link among which the nearest to a point is sought."""
COMPARED_PLACES = 32
"""Nearest places that are compared by their distance from the bark."""
AXIS_DISTANCE_WEIGHT = 0.1
"""Weight of the distance from the axis relative to that from the bark; decides among places inside wood."""


@dataclass(frozen=True)
class Axis:
    """Points of the axis, parents first, and how they follow the N particles of a model.

    points_m (p, 3), parent (p,) with −1 at roots, radius_m (p,) of the link to the parent. ``moved`` (p, N)
    gives the displacement of the points, ``turned`` (3p, 3N) the rotation vectors (half the curl) from the
    displacements, both flattened point by point.
    """

    points_m: Floats
    parent: Ints
    radius_m: Floats
    moved: csr_matrix
    turned: csr_matrix

    def displacement(self, basis: Floats) -> Floats:
        """(p, 3, r) displacement of the points for particles that move by ``basis`` (N, 3, r)."""
        n, _, r = basis.shape
        return np.asarray(self.moved @ basis.reshape(n, 3 * r)).reshape(-1, 3, r)

    def rotation(self, basis: Floats) -> Floats:
        """(p, 3, r) rotation vectors of the points, rad, for particles that move by ``basis`` (N, 3, r)."""
        n, _, r = basis.shape
        return np.asarray(self.turned @ basis.reshape(3 * n, r)).reshape(-1, 3, r)

    @cached_property
    def links(self) -> Ints:
        """(k,) points that have a parent."""
        return np.flatnonzero(self.parent >= 0)

    @cached_property
    def paths(self) -> AxisPaths:
        """The paths from the roots to its points."""
        return AxisPaths(self.points_m, np.asarray(self.parent, dtype=np.int64))

    def nearest(self, points_m: Floats) -> Bindings:
        """Bindings of points (v, 3) to the nearest places on the branches whose bark is nearest."""
        child = self.links
        start = self.points_m[self.parent[child]]
        step = (np.arange(PLACES_PER_LINK) + 0.5) / PLACES_PER_LINK
        places = start[:, None] + step[:, None] * (self.points_m[child] - start)[:, None]
        count = min(COMPARED_PLACES, places.shape[0] * places.shape[1])
        _, near = KDTree(places.reshape(-1, 3)).query(points_m, k=count)
        link = child[np.reshape(near, -1) // PLACES_PER_LINK]
        tried, cost_m = self._beside(np.repeat(points_m, count, axis=0), link)
        best = cost_m.reshape(len(points_m), count).argmin(axis=1)
        return tried.take(count * np.arange(len(points_m)) + best)

    def nearest_along(self, points_m: Floats, child: Ints) -> Bindings:
        """Bindings of points (v, 3) to near places, sought from some links (v,) on, from link to link."""
        child = np.asarray(child, np.int64).copy()
        _, cost_m = self._beside(points_m, child)
        sought, adjacent = np.arange(len(child)), self._adjacent
        while len(sought):
            first, count = adjacent.indptr[child[sought]], np.diff(adjacent.indptr)[child[sought]]
            row = np.repeat(np.arange(len(sought)), count)
            within = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
            link = adjacent.indices[first[row] + within].astype(np.int64)
            _, asked_m = self._beside(points_m[sought[row]], link)
            order = np.lexsort((asked_m, row))
            best = order[np.unique(row[order], return_index=True)[1]]
            best = best[asked_m[best] < cost_m[sought[row[best]]] - 1e-12]
            sought = sought[row[best]]
            child[sought], cost_m[sought] = link[best], asked_m[best]
        return self._beside(points_m, child)[0]

    def nearest_on_path(self, points_m: Floats, end: int) -> Bindings:
        """Bindings of points (v, 3) to the nearest places on the path from the root to a point."""
        path = [end]
        while self.parent[self.parent[path[-1]]] >= 0:
            path.append(int(self.parent[path[-1]]))
        link = np.tile(np.array(path), len(points_m))
        tried, cost_m = self._beside(np.repeat(points_m, len(path), axis=0), link)
        best = cost_m.reshape(len(points_m), len(path)).argmin(axis=1)
        return tried.take(len(path) * np.arange(len(points_m)) + best)

    def _beside(self, points_m: Floats, child: Ints) -> tuple[Bindings, Floats]:
        """Bindings of points (v, 3) to the nearest places on some links (v,), and what they cost (v,), m."""
        start = self.points_m[self.parent[child]]
        along, offset = self.points_m[child] - start, points_m - start
        squared = np.maximum(np.einsum("vi,vi->v", along, along), 1e-300)
        share = np.clip(np.einsum("vi,vi->v", offset, along) / squared, 0.0, 1.0)
        distance = np.linalg.norm(offset - share[:, None] * along, axis=1)
        apart = np.maximum(distance - self.radius_m[child], 0.0)
        bindings = Bindings(child, share, start + share[:, None] * along, apart)
        return bindings, apart + AXIS_DISTANCE_WEIGHT * distance

    @cached_property
    def _adjacent(self) -> csr_matrix:
        """(p, p) which links have a point in common; each is named by the point it ends at."""
        count, child = len(self.parent), self.links
        borne = csr_matrix((np.ones(len(child), bool), (self.parent[child], child)), shape=(count, count))
        later = child[self.parent[self.parent[child]] >= 0]
        next_ = csr_matrix((np.ones(len(later), bool), (self.parent[later], later)), shape=(count, count))
        return csr_matrix(csr_matrix(borne.T @ borne) + next_ + next_.T)


def axis_of_tets(mesh: TetMesh, skeleton: Skeleton) -> Axis:
    """The axis of a tetrahedral mesh: a point moves with the tet around it and turns with its section."""
    nearest = nearest_tets(skeleton.points_m, mesh)
    rows = np.arange(len(skeleton.points_m) + 1) * 4
    shape = (len(skeleton.points_m), len(mesh.vertices_m))
    moved = csr_matrix((nearest.weight.ravel(), mesh.tets[nearest.tet].ravel(), rows), shape=shape)
    section = _sections(mesh, skeleton, nearest.tet)
    turned = csr_matrix(section @ _half_curl(mesh))
    return Axis(skeleton.points_m, skeleton.parent.astype(np.int64), skeleton.radius_m, moved, turned)


def _sections(mesh: TetMesh, skeleton: Skeleton, nearest: Ints) -> csr_matrix:
    """(3p, 3m) mean over the tets of each point's section by volume; of an empty section the nearest tet."""
    points, tets = len(skeleton.points_m), len(mesh.tets)
    volume = _volumes(mesh)
    empty = np.flatnonzero(np.bincount(skeleton.tet_point, minlength=points) == 0)
    row = np.concatenate([skeleton.tet_point, empty])
    column = np.concatenate([np.arange(tets), nearest[empty]])
    weight = volume[column]
    weight = weight / np.bincount(row, weight, points)[row]
    axes = np.arange(3)
    return csr_matrix(
        (np.repeat(weight, 3), ((3 * row[:, None] + axes).ravel(), (3 * column[:, None] + axes).ravel())),
        shape=(3 * points, 3 * tets),
    )


def _volumes(mesh: TetMesh) -> Floats:
    corner = mesh.vertices_m[mesh.tets]
    edges = corner[:, 1:] - corner[:, :1]
    return np.maximum(np.abs(np.linalg.det(edges)) / 6.0, 1e-300)


def _half_curl(mesh: TetMesh) -> csr_matrix:
    """(3m, 3N) rotation vector of every tet: half the curl of its linear displacement."""
    corner = mesh.vertices_m[mesh.tets]
    inverse = np.linalg.inv((corner[:, 1:] - corner[:, :1]).transpose(0, 2, 1))
    gradient = np.concatenate([-inverse.sum(axis=1, keepdims=True), inverse], axis=1)  # (m, 4, 3)
    block = np.zeros((len(mesh.tets), 3, 4, 3))  # component, corner, displacement: ½ ∇N × u
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        block[:, a, :, c] = 0.5 * gradient[:, :, b]
        block[:, a, :, b] = -0.5 * gradient[:, :, c]
    column = 3 * mesh.tets[:, None, :, None] + np.arange(3)
    column = np.broadcast_to(column, block.shape)
    rows = 12 * np.arange(3 * len(mesh.tets) + 1)
    shape = (3 * len(mesh.tets), 3 * len(mesh.vertices_m))
    return csr_matrix((block.ravel(), column.ravel(), rows), shape=shape)


def axis_of_frame(frame: Frame, arm_m: float) -> Axis:
    """The axis of a frame of beams whose points are four particles each: itself and one along every axis."""
    count = len(frame.points_m)
    parent, radius = np.full(count, -1, np.int64), np.zeros(count)
    parent[frame.links[:, 1]] = frame.links[:, 0]
    radius[frame.links[:, 1]] = frame.radius_m
    moved = csr_matrix((np.ones(count), 4 * np.arange(count), np.arange(count + 1)), shape=(count, 4 * count))
    # ω = (u_y,z − u_z,y, u_z,x − u_x,z, u_x,y − u_y,x) / 2 with u_axis,component, over the length of the arm
    row, column, value = [], [], []
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        for particle, component, sign in ((1 + b, c, 0.5), (1 + c, b, -0.5)):
            for at, factor in ((particle, sign), (0, -sign)):
                row.append(3 * np.arange(count) + a)
                column.append(3 * (4 * np.arange(count) + at) + component)
                value.append(np.full(count, factor / arm_m))
    entries = (np.concatenate(value), (np.concatenate(row), np.concatenate(column)))
    return Axis(frame.points_m, parent, radius, moved, csr_matrix(entries, shape=(3 * count, 12 * count)))
