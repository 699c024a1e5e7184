"""Where a table's vertices are drawn. Twins: web/player/src/core/motion/nodePose.ts, shaders of
web/player/src/trees.

A node moves by Σ q · basis. The link from its parent to it is not drawn longer than at rest by more than
LONGEST: what it has in excess is taken off the node and all that come after it, so that branches bend instead
of stretching, even where the modes are linear or extrapolated. Its rotation vector is divided by the stretch
of that link before it was shortened, which a linear motion adds to the sine of the angle. A joint lies
between two nodes, and a vertex moves with its joint and turns about it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.table.format import Table
from galewood.util import Floats, Ints

LONGEST = 1.02
"""Length of a link between nodes, relative to rest, from which it is shortened."""
MOST_STRETCH = 2.0
"""Stretch of a link up to which it is taken off the rotation: that of a linear motion at an angle of 60°."""


@dataclass(frozen=True)
class NodePose:
    """Displacement (n, 3), m, and rotation vectors (n, 3) of the nodes in one pose.

    The length of a rotation vector is the sine of the angle while it is small (``turned``).
    """

    moved_m: Floats
    turned: Floats


def node_pose(table: Table, q: npt.ArrayLike, factor: float = 1.0) -> NodePose:
    """The nodes at the coordinates q (r,), with all displacements multiplied by ``factor``."""
    wide = factor * np.asarray(q, np.float64)
    rest = table.node_rest_m.astype(np.float64)
    moved, stretch = unstretched(rest, table.node_parent.astype(np.int64), table.node_basis @ wide)
    return NodePose(moved, (table.node_turn @ wide) / stretch[:, None])


def unstretched(rest_m: Floats, parent: Ints, moved_m: Floats) -> tuple[Floats, Floats]:
    """Displacements (n, 3, …) without what links have in excess, and the stretch (n, …) of each link, 1 to 2.

    ``parent`` (n,) comes before its children and is the point itself, or negative, at a root.
    """
    own = np.arange(len(parent))
    up = np.where(parent < 0, own, parent)
    wide = (..., *([None] * (moved_m.ndim - 2)))
    link = (rest_m - rest_m[up])[wide]
    now = link + moved_m - moved_m[up]
    length, rest = np.linalg.norm(now, axis=1), np.linalg.norm(link, axis=1)
    excess = now * np.maximum(1.0 - LONGEST * rest / np.maximum(length, 1e-12), 0.0)[:, None]
    for point in np.flatnonzero(up != own).tolist():
        excess[point] += excess[up[point]]
    stretch = np.clip(length / np.maximum(rest, 1e-12), 1.0, MOST_STRETCH)
    return moved_m - excess, stretch


def turned(arm_m: Floats, rotation: Floats) -> Floats:
    """Arms (…, 3) turned by rotation vectors (…, 3).

    The vector is half the curl of the displacement over the stretch of the link: the sine of the angle. The
    sine that is drawn never exceeds 1.
    """
    squared = np.square(rotation).sum(axis=-1, keepdims=True)
    axis = rotation / np.sqrt(np.sqrt(1.0 + squared * squared))
    cosine = np.sqrt(np.maximum(1.0 - np.square(axis).sum(axis=-1, keepdims=True), 0.0))
    along = (axis * arm_m).sum(axis=-1, keepdims=True) / (1.0 + cosine)
    return arm_m * cosine + np.cross(axis, arm_m) + axis * along


def drawn_positions(table: Table, rest_m: Floats, q: npt.ArrayLike, factor: float = 1.0) -> Floats:
    """(v, 3) where the vertices ``rest_m`` (v, 3) are drawn in the pose q (r,)."""
    pose = node_pose(table, q, factor)
    joint = table.vertex_joint.astype(np.int64)
    first, second = table.joint_nodes.astype(np.int64).T
    share = table.joint_share.astype(np.float64)[:, None]
    place = table.joint_rest_m.astype(np.float64)
    moved = (1 - share) * pose.moved_m[first] + share * pose.moved_m[second]
    turn = (1 - share) * pose.turned[first] + share * pose.turned[second]
    return (place + moved)[joint] + turned(rest_m - place[joint], turn[joint])


def joint_rows(table: Table, rows: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """(j, 3, r) rows of the joints from those of the nodes (n, 3, r): of the basis or of the turns."""
    first, second = table.joint_nodes.astype(np.int64).T
    share = table.joint_share[:, None, None]
    return ((1 - share) * rows[first] + share * rows[second]).astype(np.float32)


def vertex_rows(table: Table, rest_m: npt.NDArray[np.floating]) -> npt.NDArray[np.float32]:
    """(v, 3, r) displacement of the vertices ``rest_m`` (v, 3) per unit of q, for small motion."""
    joint = table.vertex_joint.astype(np.int64)
    arm = (rest_m - table.joint_rest_m[joint]).astype(np.float32)
    turn = joint_rows(table, table.node_turn)[joint]
    swung = np.cross(turn, arm[:, :, None], axis=1)
    return (joint_rows(table, table.node_basis)[joint] + swung).astype(np.float32)
