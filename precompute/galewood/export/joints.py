"""Rigid motion of a table's joints: what a vertex that hangs on a joint does (docs/formats/table.md)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.skinning import node_pose
from galewood.table import Table
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class RigidMotion:
    """Displacements (T, b, 3), m, and rotations (T, b, 4), quaternions x y z w with w > 0, of b bodies."""

    moved_m: Floats
    rotation: Floats


def quaternions(turn: Floats) -> Floats:
    """(…, 4) the rotations that are drawn for rotation vectors (…, 3) of the table (``node_pose.turned``).

    The sine of the angle is |ω| (1 + |ω|⁴)^(−1/4) ≤ 1, so that the cosine is at least 0 and w at least 0.7.
    """
    squared = np.square(turn).sum(axis=-1, keepdims=True)
    sine_axis = turn / np.sqrt(np.sqrt(1.0 + squared * squared))
    cosine = np.sqrt(np.maximum(1.0 - np.square(sine_axis).sum(axis=-1, keepdims=True), 0.0))
    half_cosine = np.sqrt(0.5 * (1.0 + cosine))
    return np.concatenate([sine_axis / (2.0 * half_cosine), half_cosine], axis=-1)


def rotated(rotation: Floats, arm: Floats) -> Floats:
    """Vectors (…, 3) turned by quaternions (…, 4)."""
    along, w = rotation[..., :3], rotation[..., 3:]
    return arm + 2.0 * np.cross(along, np.cross(along, arm) + w * arm)


def node_motion(table: Table, q: Floats) -> RigidMotion:
    """Motion of the nodes at the poses q (T, r)."""
    poses = [node_pose(table, row) for row in q]
    moved = np.stack([pose.moved_m for pose in poses])
    return RigidMotion(moved, quaternions(np.stack([pose.turned for pose in poses])))


def joint_motion(table: Table, q: Floats) -> RigidMotion:
    """Motion of the joints at the poses q (T, r)."""
    first, second = table.joint_nodes.astype(np.int64).T
    share = table.joint_share.astype(np.float64)[:, None]
    moved, turn = [], []
    for row in q:
        pose = node_pose(table, row)
        moved.append((1 - share) * pose.moved_m[first] + share * pose.moved_m[second])
        turn.append((1 - share) * pose.turned[first] + share * pose.turned[second])
    return RigidMotion(np.stack(moved), quaternions(np.stack(turn)))


def joint_of_vertex(table: Table) -> Ints:
    """(v,) joint of every render vertex."""
    return table.vertex_joint.astype(np.int64)
