"""Foliage as clumps, its connected pieces, and which of them the wood reaches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from galewood.formats import RawPart, alpha_coverage
from galewood.tree.missing.arms import triangle_areas
from galewood.tree.repair import Surface, face_components, weld_keeping_faces
from galewood.util import Floats, Ints

REACH_HEIGHT_SHARE = 0.15
"""Distance of a clump's centre from the wood beyond which it is not reached, relative to the height."""
REACH_RADIUS_RATIO = 0.8
"""The same relative to the RMS radius of the clump: a large clump around a branch is reached."""


@dataclass(frozen=True)
class Clumps:
    """k pieces of foliage: centre_m (k, 3), area_m2 (k,), RMS radius (k,) m, and the vertices of each.

    ``point_m`` (s, 3) and ``point_area_m2`` (s,) are its faces, ``clump`` (s,) the piece of each face.
    """

    centre_m: Floats
    area_m2: Floats
    radius_m: Floats
    point_m: Floats
    point_area_m2: Floats
    clump: Ints
    corner_m: Floats  # (s, 3, 3) corners of the faces
    order: Ints  # (s,) the faces, sorted by their piece
    start: Ints  # (k + 1,) where the faces of each piece begin in this order

    def __len__(self) -> int:
        return len(self.area_m2)

    def corners_of(self, number: int) -> Floats:
        """Corners (f, 3, 3) of the faces of a clump."""
        return self.corner_m[self.order[self.start[number] : self.start[number + 1]]]

    def unreached(self, wood_m: Floats, height_m: float) -> np.ndarray:
        """(k,) whether points on the wood (w, 3) are far from each clump."""
        if not len(wood_m):
            return np.ones(len(self), dtype=bool)
        apart, _ = KDTree(wood_m).query(self.centre_m)
        return np.asarray(
            apart > np.maximum(REACH_HEIGHT_SHARE * height_m, REACH_RADIUS_RATIO * self.radius_m)
        )


def clumps_of(parts: Sequence[RawPart]) -> Clumps:
    """The clumps of the parts that are leaves; what an image cuts out has no area."""
    corners: list[Floats] = [np.zeros((0, 3, 3))]
    areas: list[Floats] = [np.zeros(0)]
    pieces: list[Ints] = [np.zeros(0, dtype=np.int32)]
    count = 0
    for part in parts:
        welded = weld_keeping_faces(Surface(part.positions, part.faces))
        number, of_face = face_components(welded.faces, len(welded.vertices))
        triangles = part.positions[part.faces]
        corners.append(triangles)
        areas.append(triangle_areas(triangles) * alpha_coverage(part.material))
        pieces.append(of_face + count)
        count += number
    return _measured(np.concatenate(corners), np.concatenate(areas), np.concatenate(pieces), count)


def _measured(corner: Floats, area: Floats, clump: Ints, count: int) -> Clumps:
    weight = np.maximum(area, 1e-12)
    total = np.bincount(clump, weight, count)
    point = corner.mean(axis=1)
    mean = [np.bincount(clump, weight * point[:, k], count) / np.maximum(total, 1e-300) for k in range(3)]
    centre = np.stack(mean, axis=1)
    squared = np.square(corner - centre[clump][:, None]).sum(axis=2).mean(axis=1)
    radius = np.sqrt(np.bincount(clump, weight * squared, count) / np.maximum(total, 1e-300))
    start = np.concatenate([[0], np.cumsum(np.bincount(clump, minlength=count))]).astype(np.int32)
    order = np.argsort(clump, kind="stable").astype(np.int32)
    total = np.bincount(clump, area, count).astype(np.float64)
    return Clumps(centre, total, radius, point, area, clump, corner, order, start)


def clustered(place_m: Floats, weight: Floats, wide_m: float, most: int) -> Ints:
    """Cluster (n,) of each place (n, 3): as many as needed for a radius of ``wide_m``, at most ``most``.

    Farthest places first, then Lloyd's iterations; deterministic.
    """
    centres = [np.average(place_m, axis=0, weights=np.maximum(weight, 1e-12))]
    apart = np.linalg.norm(place_m - centres[0], axis=1)
    if apart.max() > wide_m:
        centres = [place_m[int(apart.argmax())]]
        apart = np.linalg.norm(place_m - centres[0], axis=1)
    while apart.max() > wide_m and len(centres) < most:
        centres.append(place_m[int(apart.argmax())])
        apart = np.minimum(apart, np.linalg.norm(place_m - centres[-1], axis=1))
    middle = np.array(centres)
    label = KDTree(middle).query(place_m)[1]
    for _ in range(8):
        total = np.maximum(np.bincount(label, weight, len(middle)), 1e-300)
        mean = [np.bincount(label, weight * place_m[:, k], len(middle)) / total for k in range(3)]
        own = np.bincount(label, weight, len(middle)) > 0
        middle = np.where(own[:, None], np.stack(mean, axis=1), middle)
        label = KDTree(middle).query(place_m)[1]
    return np.unique(label, return_inverse=True)[1].astype(np.int32)
