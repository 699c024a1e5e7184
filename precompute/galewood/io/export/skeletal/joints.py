"""Rigid motion of a table's joints: what a vertex that hangs on a joint does (spec/formats/table.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from galewood.solid.skinning import Pose, joint_pose, node_pose, sine_and_cosine
from galewood.table import Table
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class RigidMotion:
    """Displacements (T, b, 3), m, and rotations (T, b, 4), quaternions x y z w with w > 0, of b bodies."""

    moved_m: Floats
    rotation: Floats


def quaternions(turn: Floats) -> Floats:
    """(…, 4) the rotations that are drawn for rotation vectors (…, 3) of the table.

    The cosine of their angle is at least 0, so w is at least 0.7.
    """
    sine_axis, cosine = sine_and_cosine(turn)
    half_cosine = np.sqrt(0.5 * (1.0 + cosine))
    return np.concatenate([sine_axis / (2.0 * half_cosine), half_cosine], axis=-1)


def rotated(rotation: Floats, arm: Floats) -> Floats:
    """Vectors (…, 3) turned by quaternions (…, 4)."""
    along, w = rotation[..., :3], rotation[..., 3:]
    return arm + 2.0 * np.cross(along, np.cross(along, arm) + w * arm)


def node_motion(table: Table, q: Floats) -> RigidMotion:
    """Motion of the nodes at the poses q (T, r)."""
    return _motion([node_pose(table, row) for row in q])


def joint_motion(table: Table, q: Floats) -> RigidMotion:
    """Motion of the joints at the poses q (T, r)."""
    return _motion([joint_pose(table, row) for row in q])


def _motion(poses: Sequence[Pose]) -> RigidMotion:
    moved = np.stack([pose.moved_m for pose in poses])
    return RigidMotion(moved, quaternions(np.stack([pose.turned for pose in poses])))


def joint_of_vertex(table: Table) -> Ints:
    """(v,) joint of every render vertex."""
    return table.vertex_joint.astype(np.int64)
