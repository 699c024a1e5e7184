"""Axes of known shape with wood around them, and poses that bend them."""

from __future__ import annotations

import numpy as np
from galewood.solid.skinning import Axis
from galewood.solid.skinning.stretch_minimisation import AxisPoses
from galewood.tree.types import RenderPrimitive
from galewood.util import Floats, Ints
from scipy.sparse import csr_matrix

from tests.precompute.fixtures import tree_meshes as make


def axis_of(points_m: Floats, parent: Ints, radius_m: float) -> Axis:
    """An axis that no model moves."""
    none = csr_matrix((0, 0))
    return Axis(points_m, parent, np.full(len(parent), radius_m), none, none)


def path_to_root(parent: Ints, point: int) -> list[int]:
    """A point and all points between it and the root, found by walking."""
    path = [point]
    while parent[path[-1]] >= 0:
        path.append(int(parent[path[-1]]))
    return path


def pole(count: int = 41, length_m: float = 4.0) -> Axis:
    """A straight axis along y."""
    points = np.zeros((count, 3))
    points[:, 1] = np.linspace(0, length_m, count)
    return axis_of(points, np.arange(-1, count - 1), 0.2)


def pole_wood() -> RenderPrimitive:
    """A tube around ``pole``."""
    tube = make.tube((0, 0, 0), (0, 4, 0), 0.2, 0.2, sides=10, rings=21)
    return RenderPrimitive("wood_0", "wood", tube.vertices, tube.faces)


def pole_with_branch(points: int = 101, beside: int = 20) -> Axis:
    """A pole of 10 m with a branch from its middle; the points are the particles, and do not turn."""
    stem = np.stack([np.zeros(points), np.linspace(0, 10, points), np.zeros(points)], axis=1)
    branch = np.stack([np.arange(1, beside + 1) * 0.1, np.full(beside, 5.0), np.zeros(beside)], axis=1)
    parent = np.concatenate(
        [np.arange(-1, points - 1), [points // 2], np.arange(points, points + beside - 1)]
    )
    count = points + beside
    moved, turned = csr_matrix(np.eye(count)), csr_matrix((3 * count, 3 * count))
    points_m = np.concatenate([stem, branch]).astype(np.float64)
    return Axis(points_m, parent, np.full(count, 0.1), moved, turned)


def bent(axis: Axis, angle: Floats) -> AxisPoses:
    """One pose of a straight axis whose points lean by angles (p,), rad, towards x."""
    step = np.diff(axis.points_m[:, 1], prepend=0.0)
    now = np.cumsum(np.stack([np.sin(angle) * step, np.cos(angle) * step, 0 * step], axis=1), axis=0)
    turn = np.stack([0 * angle, 0 * angle, -np.sin(angle)], axis=1)
    return AxisPoses((now - axis.points_m)[:, :, None], turn[:, :, None])


def flared() -> tuple[Axis, RenderPrimitive, AxisPoses]:
    """A stem of 6 m whose foot is 0.9 m thick, bent by 0.6 rad in one pose, mostly in its lower half."""
    height = np.linspace(0, 6, 49)
    axis = axis_of(np.stack([0 * height, height, 0 * height], axis=1), np.arange(-1, 48), 0.3)
    tube = make.tube((0, 0, 0), (0, 6, 0), 0.9, 0.2, sides=8, rings=13)
    wood = RenderPrimitive("wood_0", "wood", tube.vertices, tube.faces)
    return axis, wood, bent(axis, 0.6 * (1 - np.exp(-height / 2)))
