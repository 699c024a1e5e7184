"""Preparation of the welded wood for meshing: windings, holes and stray bodies; all repairs are reported."""

from __future__ import annotations

from dataclasses import dataclass

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


@dataclass(frozen=True)
class Bodies:
    """Vertices (n, 3) of bodies apart from the tree: those in the air, and those on the ground."""

    floating: Floats
    grounded: Floats


def solid_wood(wood: Surface) -> tuple[Surface, Bodies, dict[str, int], list[str]]:
    """Orient and close the wood; returns the surface, other bodies, repair counts and warnings.

    What floats apart from the wood is no wood: nothing carries it. Raises MeshError if nothing with a volume
    remains.
    """
    faces, turned = agree_windings(wood.faces)
    capped, loops = cap(Surface(wood.vertices, faces))
    kept, dropped = _without_flat_pieces(capped)
    outward, inverted = face_outwards(kept)
    alone, others, bodies = _one_tree(outward)
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
    if len(bodies.floating):
        warnings.append(
            "Pieces that float apart from the wood are taken for foliage: they move with the wood near them."
        )
    if others:
        warnings.append(
            f"The file contains {others + 1} separate bodies; only the largest on the ground has been kept."
        )
    return alone, bodies, repairs, warnings


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


def _one_tree(surface: Surface) -> tuple[Surface, int, Bodies]:
    """Keep the components whose boxes are chained to the largest one on the ground.

    Returns the surface, the number of other bodies on the ground, and all other bodies.
    """
    count, of_face = face_components(surface.faces, len(surface.vertices))
    if count == 1:
        return surface, 0, Bodies(np.zeros((0, 3)), np.zeros((0, 3)))
    low, high = piece_boxes(surface, of_face, count)
    group = _chained(low, high, STRAY_GAP * float(np.ptp(surface.vertices[:, 1])))
    volumes = np.bincount(group, np.abs(signed_volumes(surface, of_face, count)))
    bottoms = np.full(len(volumes), np.inf)
    np.minimum.at(bottoms, group, low[:, 1])
    ground = float(low[:, 1].min()) + ROOTED_HEIGHT_SHARE * float(np.ptp(surface.vertices[:, 1]))
    grounded = bottoms <= ground
    rooted = grounded & (volumes >= ROOTED_VOLUME_SHARE * np.where(grounded, volumes, 0.0).max())
    main = int(np.argmax(np.where(rooted, volumes, -1.0)))
    apart = np.arange(len(volumes)) != main

    def points(bodies: np.ndarray) -> Floats:
        return surface.vertices[np.unique(surface.faces[bodies[group][of_face]])]

    kept = compact(Surface(surface.vertices, surface.faces[(group == main)[of_face]]))
    return kept, int((apart & grounded).sum()), Bodies(points(apart & ~grounded), points(apart & grounded))


def _chained(low: Floats, high: Floats, gap: float) -> Ints:
    """Group number of each box; boxes closer than `gap` share a group. The largest boxes gather first."""
    group = np.full(len(low), -1, dtype=np.int32)
    rest = np.argsort(-(high - low).sum(axis=1), kind="stable")  # the boxes without a group
    number = -1
    while len(rest):
        number += 1
        stack, rest = [int(rest[0])], rest[1:]
        while stack:
            i = stack.pop()
            group[i] = number
            apart = np.maximum(np.maximum(low[rest] - high[i], low[i] - high[rest]), 0.0)
            near = np.einsum("ij,ij->i", apart, apart) <= gap**2
            stack += rest[near].tolist()
            rest = rest[~near]
    return group
