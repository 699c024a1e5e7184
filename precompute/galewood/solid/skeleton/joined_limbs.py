"""Branches of a tree whose limbs are drawn as many closed surfaces that overlap, such as cylinders.

Level sets of such a surface are those of the single cylinders. So the limbs are joined first, as the mesher
does: thin ones are thickened, and a distance grid gives one surface around all. The radii are then corrected
by the volumes that both surfaces enclose, as those of the tetrahedra are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.skeleton.extraction import owners
from galewood.solid.skeleton.outline import Outline, TracedSurface, trace
from galewood.solid.skeleton.radius_correction import corrected_radii
from galewood.solid.tets import joined_surface, scattered
from galewood.tree import Surface, face_components, signed_volumes
from galewood.util import Floats, Int32s, Ints

JOINED_FACES = 12_000
"""Faces of the joined surface, about; its branches have a few sections per diameter."""
FEWEST_PIECES, MANY_PIECES, LINKED_SHARE = 12, 100, 0.4
"""Of a tree of chains: so many pieces at least, without further signs, and share with others at both ends."""
END_SHARE = 0.02
"""Part of the length of a piece that is its end."""
NEIGHBOUR_COUNT, REACH_RADII = 64, 1.6
FINEST_SPACING = 400
"""Least distance of the points on the surface, as a part of the height."""


@dataclass(frozen=True)
class _Line:
    """The outline as a line with the point (m,) that each face of the joined surface belongs to."""

    points_m: Floats
    parent: Int32s
    branch: Int32s
    tet_point: Int32s


def joined_outline(vertices_m: Floats, faces: Ints) -> Outline:
    """The branches inside closed surfaces that overlap; the y axis points up."""
    wood = Surface(vertices_m, faces)
    joined, recorded = joined_surface(wood, JOINED_FACES)
    traced = trace(joined.vertices, joined.faces)
    outline = traced.outline
    line = _Line(outline.points_m, outline.parent, outline.branch, _owners(joined, traced))
    ratio = corrected_radii(wood, joined, recorded, line)
    return replace(outline, radius_m=outline.radius_m * ratio)


def _owners(joined: Surface, traced: TracedSurface) -> Int32s:
    centre = joined.vertices[joined.faces].mean(axis=1)
    return owners(centre, traced.sections, traced.tree, traced.replacement, traced.outline.radius_m)


def is_chained(vertices_m: Floats, faces: Ints) -> bool:
    """Whether limbs are chains of closed surfaces: of hundreds, or many have another one at both ends.

    A limb that is one surface has its parent at its base, and nothing at its tip.
    """
    count, of_face = face_components(faces, len(vertices_m))
    if count < FEWEST_PIECES or count >= MANY_PIECES:
        return count >= MANY_PIECES
    piece = np.zeros(len(vertices_m), np.int64)
    piece[faces] = of_face[:, None]
    radius_m = _radii(vertices_m, faces, of_face, count)
    spacing_m = max(float(np.median(radius_m)), float(np.ptp(vertices_m[:, 1])) / FINEST_SPACING)
    skin, face = scattered(Surface(vertices_m, faces), spacing_m)
    of_skin, tree = of_face[face], KDTree(skin)
    links = sum(_has_others(_ends(vertices_m[piece == k]), k, tree, of_skin, radius_m) for k in range(count))
    return links >= LINKED_SHARE * count


def _ends(points_m: Floats) -> Floats:
    """(2, 3) centres of both ends of a long piece."""
    centred = points_m - points_m.mean(axis=0)
    along = centred @ np.linalg.svd(centred, full_matrices=False)[2][0]
    margin = END_SHARE * float(np.ptp(along))
    return np.stack([points_m[along <= along.min() + margin].mean(axis=0),
                     points_m[along >= along.max() - margin].mean(axis=0)])  # fmt: skip


def _has_others(ends_m: Floats, own: int, skin: KDTree, of_skin: Ints, radius_m: Floats) -> bool:
    """Whether another piece is at both ends of a piece: no farther than its surface is from its axis."""
    gap, near = skin.query(ends_m, k=min(NEIGHBOUR_COUNT, len(of_skin)))
    other = of_skin[near]
    reach = REACH_RADII * np.maximum(radius_m[other], radius_m[own])
    return bool(((other != own) & (gap <= reach)).any(axis=1).all())


def _radii(vertices_m: Floats, faces: Ints, of_face: Ints, count: int) -> Floats:
    """Mean radius (count,) 2 V / A of each piece, m."""
    surface = Surface(vertices_m, faces)
    corners = vertices_m[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    volume = np.abs(signed_volumes(surface, of_face, count))
    return 2 * volume / np.maximum(np.bincount(of_face, area, count), 1e-300)
