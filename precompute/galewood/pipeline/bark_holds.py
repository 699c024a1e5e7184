"""Holds the bark so that it does not tear at a far sway, once the motion of a tree is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from galewood.mesh import RenderPrimitive
from galewood.model import Feet, chosen, holds_of, welded_wood
from galewood.pipeline.drawn_figures import HEADINGS, SWAY
from galewood.pipeline.surface import RenderMesh
from galewood.reduction import calmed, drawn_poses
from galewood.util import Floats, Ints


def with_calm_bark(mesh: RenderMesh, basis: Floats, q: Sequence[Floats], height_m: float) -> RenderMesh:
    """The mesh held so that its wood and fronds do not stretch much at a sway of a fifth of the height.

    ``basis`` (N, 3, r) are the modes, ``q`` (T, r) the training runs, whose farthest sways are scaled.
    """
    if mesh.figures is None:
        return mesh
    poses = drawn_poses(mesh.axis, basis, _far_poses(mesh, basis, np.concatenate(q), height_m))

    def improved(part: RenderPrimitive, feet: Feet, still: Ints) -> Feet:
        if not len(part.faces):
            return feet
        welded = welded_wood(part)
        kept = np.unique(welded.same[still])
        return chosen(calmed(welded, chosen(feet, welded.first), mesh.axis, poses, kept), welded.same)

    return replace(mesh, feet=holds_of(mesh.figures.tree, mesh.axis, improved))


def _far_poses(mesh: RenderMesh, basis: Floats, q: Floats, height_m: float) -> Floats:
    """(k, r) the pose of the farthest sway towards each of several headings, scaled to the same sway."""
    top = mesh.axis.displacement(basis)[int(mesh.axis.points_m[:, 1].argmax())]
    moved = q @ top.T
    sway = np.linalg.norm(moved, axis=1)
    heading = np.floor((np.arctan2(moved[:, 2], moved[:, 0]) / (2 * np.pi) + 1) * HEADINGS) % HEADINGS
    poses: list[Floats] = [np.zeros((0, q.shape[1]))]
    for number in range(HEADINGS):
        own = np.flatnonzero((heading == number) & (sway > 1e-9))
        if len(own):
            far = int(own[sway[own].argmax()])
            poses.append(q[far : far + 1] * (SWAY * height_m / sway[far]))
    return np.concatenate(poses)
