"""Preparation of the welded wood for meshing: windings, holes and stray bodies; all repairs are reported."""

from __future__ import annotations

import numpy as np

from galewood.tree.repair import (
    Surface,
    agree_windings,
    cap,
    compact,
    face_components,
    face_outwards,
    signed_volumes,
)
from galewood.util import Floats, Ints, MeshError

STRAY_GAP = 0.1  # relative to the wood's height; components farther apart are separate bodies
ROOTED_HEIGHT_SHARE = 0.05  # relative to the wood's height; components must reach below this to be rooted
ROOTED_VOLUME_SHARE = 0.1  # relative to the volume of the largest body


def solid_wood(wood: Surface) -> tuple[Surface, Floats, dict[str, int], list[str]]:
    """Orient and close the wood; returns the surface, discarded vertices, repair counts and warnings.

    The discarded vertices belong to separate bodies. Raises MeshError if nothing with a volume remains.
    """
    faces, turned = agree_windings(wood.faces)
    capped, loops = cap(Surface(wood.vertices, faces))
    kept, dropped = _without_flat_pieces(capped)
    outward, inverted = face_outwards(kept)
    alone, others, strays = _one_tree(outward)
    repairs = {
        "faces_turned": turned,
        "holes_capped": loops,
        "flat_pieces_dropped": dropped,
        "pieces_turned_inside_out": inverted,
        "pieces": face_components(alone.faces, len(alone.vertices))[0],
    }
    warnings: list[str] = []
    if inverted:
        warnings.append(f"{inverted} parts of the wood were inside out and have been reversed.")
    if loops:
        warnings.append(f"{loops} holes in the wood have been closed.")
    if others:
        warnings.append(
            f"The file contains {others + 1} separate bodies; only the largest on the ground has been kept."
        )
    return alone, strays, repairs, warnings


def _without_flat_pieces(surface: Surface) -> tuple[Surface, int]:
    count, of_face = face_components(surface.faces, len(surface.vertices))
    volumes = np.abs(signed_volumes(surface, of_face, count))
    low, high = piece_boxes(surface, of_face, count)
    diagonal = np.linalg.norm(high - low, axis=1)
    sound = volumes > 1e-9 * diagonal**3
    if not sound.any():
        raise MeshError(
            "no-volume", "unsuitable", "The wood encloses no volume.", "Upload a tree with solid branches."
        )
    return compact(Surface(surface.vertices, surface.faces[sound[of_face]])), int((~sound).sum())


def piece_boxes(surface: Surface, of_face: Ints, count: int) -> tuple[Floats, Floats]:
    """Lower and upper corners (count, 3) of each component's bounding box."""
    low, high = np.full((count, 3), np.inf), np.full((count, 3), -np.inf)
    corners = surface.vertices[surface.faces]
    np.minimum.at(low, of_face, corners.min(axis=1))
    np.maximum.at(high, of_face, corners.max(axis=1))
    return low, high


def _one_tree(surface: Surface) -> tuple[Surface, int, Floats]:
    """Keep the components whose boxes are chained to the largest one on the ground.

    Returns the surface, the number of discarded bodies and their vertices.
    """
    count, of_face = face_components(surface.faces, len(surface.vertices))
    if count == 1:
        return surface, 0, np.zeros((0, 3))
    low, high = piece_boxes(surface, of_face, count)
    group = _chained(low, high, STRAY_GAP * float(np.ptp(surface.vertices[:, 1])))
    volumes = np.bincount(group, np.abs(signed_volumes(surface, of_face, count)))
    bottoms = np.full(len(volumes), np.inf)
    np.minimum.at(bottoms, group, low[:, 1])
    ground = float(low[:, 1].min()) + ROOTED_HEIGHT_SHARE * float(np.ptp(surface.vertices[:, 1]))
    rooted = (bottoms <= ground) & (volumes >= ROOTED_VOLUME_SHARE * volumes.max())
    if not rooted.any():
        rooted = volumes == volumes.max()
    main = int(np.argmax(np.where(rooted, volumes, -1.0)))
    keep = (group == main)[of_face]
    strays = surface.vertices[np.unique(surface.faces[~keep])]
    return compact(Surface(surface.vertices, surface.faces[keep])), len(volumes) - 1, strays


def _chained(low: Floats, high: Floats, gap: float) -> Ints:
    """Group number of each box; boxes closer than `gap` share a group."""
    group = np.full(len(low), -1, dtype=np.int32)
    for number, start in enumerate(range(len(low))):
        if group[start] >= 0:
            continue
        group[start] = number
        stack = [start]
        while stack:
            i = stack.pop()
            apart = np.maximum(np.maximum(low - high[i], low[i] - high), 0.0)
            for j in np.flatnonzero((np.linalg.norm(apart, axis=1) <= gap) & (group < 0)):
                group[j] = number
                stack.append(int(j))
    return np.unique(group, return_inverse=True)[1].astype(np.int32)
