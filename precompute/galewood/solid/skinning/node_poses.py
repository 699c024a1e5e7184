"""Pose of a skin: where its vertices are drawn. The shaders of web/player/src/trees do the same.

A node moves by Σ q · basis. The stretch of the links between nodes is limited: the link from its parent to
a node is not drawn longer than LONGEST_LINK times its length at rest. What it has in excess is taken off
the node and all that come after it, so that branches bend instead of stretching, even where the modes are
linear or extrapolated. The rotation vector of a node is divided by the stretch of that link before it was
shortened, which a linear motion adds to the sine of the angle. A joint blends two nodes linearly; a vertex
moves with its joint and turns about it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Protocol

import numpy as np
import numpy.typing as npt

from galewood.constants import LONGEST_LINK, MOST_LINK_STRETCH
from galewood.util import Floats, Ints


class SkinLike(Protocol):
    """A skin of n nodes, j joints and v vertices in r modes: ``Skin`` or a table (spec/formats/table.md)."""

    __dataclass_fields__: ClassVar[dict[str, Any]]

    @property
    def node_basis(self) -> npt.NDArray[np.float32]: ...
    @property
    def node_turn(self) -> npt.NDArray[np.float32]: ...
    @property
    def node_rest_m(self) -> npt.NDArray[np.float32]: ...
    @property
    def node_parent(self) -> npt.NDArray[np.uint16]: ...
    @property
    def joint_nodes(self) -> npt.NDArray[np.uint16]: ...
    @property
    def joint_share(self) -> npt.NDArray[np.float32]: ...
    @property
    def joint_rest_m(self) -> npt.NDArray[np.float32]: ...
    @property
    def vertex_joint(self) -> npt.NDArray[np.uint16]: ...


@dataclass(frozen=True)
class Pose:
    """Displacement (n, 3), m, and rotation vectors (n, 3) of nodes or joints.

    The length of a rotation vector is the sine of the angle while it is small (``turned``).
    """

    moved_m: Floats
    turned: Floats


def node_pose(skin: SkinLike, q: npt.ArrayLike, factor: float = 1.0) -> Pose:
    """The nodes at the coordinates q (r,), with all displacements multiplied by ``factor``."""
    wide = factor * np.asarray(q, np.float64)
    rest = skin.node_rest_m.astype(np.float64)
    moved, stretch = limit_stretch(rest, skin.node_parent.astype(np.int64), skin.node_basis @ wide)
    return Pose(moved, (skin.node_turn @ wide) / stretch[:, None])


def joint_pose(skin: SkinLike, q: npt.ArrayLike, factor: float = 1.0) -> Pose:
    """The joints, each blended from its two nodes, as in ``node_pose``."""
    nodes = node_pose(skin, q, factor)
    first, second = skin.joint_nodes.astype(np.int64).T
    share = skin.joint_share.astype(np.float64)[:, None]
    return Pose(
        (1 - share) * nodes.moved_m[first] + share * nodes.moved_m[second],
        (1 - share) * nodes.turned[first] + share * nodes.turned[second],
    )


def limit_stretch(rest_m: Floats, parent: Ints, moved_m: Floats) -> tuple[Floats, Floats]:
    """Displacements (n, 3, …) without what links have in excess, and the stretch (n, …) of each link, 1 to 2.

    ``parent`` (n,) comes before its children and is the point itself, or negative, at a root.
    """
    own = np.arange(len(parent))
    up = np.where(parent < 0, own, parent)
    wide = (..., *([None] * (moved_m.ndim - 2)))
    link = (rest_m - rest_m[up])[wide]
    now = link + moved_m - moved_m[up]
    length, rest = np.linalg.norm(now, axis=1), np.linalg.norm(link, axis=1)
    excess = now * np.maximum(1.0 - LONGEST_LINK * rest / np.maximum(length, 1e-12), 0.0)[:, None]
    for point in np.flatnonzero(up != own).tolist():
        excess[point] += excess[up[point]]
    stretch = np.clip(length / np.maximum(rest, 1e-12), 1.0, MOST_LINK_STRETCH)
    return moved_m - excess, stretch


def sine_and_cosine(rotation: Floats) -> tuple[Floats, Floats]:
    """Axis times sine (…, 3), and cosine (…, 1), of the angles that are drawn for rotation vectors (…, 3).

    A vector is half the curl of the displacement over the stretch of the link: the sine of the angle. The
    sine that is drawn, |ω| (1 + |ω|⁴)^(−1/4), never exceeds 1.
    """
    squared = np.square(rotation).sum(axis=-1, keepdims=True)
    axis = rotation / np.sqrt(np.sqrt(1.0 + squared * squared))
    return axis, np.sqrt(np.maximum(1.0 - np.square(axis).sum(axis=-1, keepdims=True), 0.0))


def turned(arm_m: Floats, rotation: Floats) -> Floats:
    """Arms (…, 3) turned by rotation vectors (…, 3)."""
    axis, cosine = sine_and_cosine(rotation)
    along = (axis * arm_m).sum(axis=-1, keepdims=True) / (1.0 + cosine)
    return arm_m * cosine + np.cross(axis, arm_m) + axis * along


def drawn_positions(skin: SkinLike, rest_m: Floats, q: npt.ArrayLike, factor: float = 1.0) -> Floats:
    """(v, 3) where the vertices ``rest_m`` (v, 3) of the bind pose are drawn in the pose q (r,)."""
    pose = joint_pose(skin, q, factor)
    joint = skin.vertex_joint.astype(np.int64)
    place = skin.joint_rest_m.astype(np.float64)
    return (place + pose.moved_m)[joint] + turned(rest_m - place[joint], pose.turned[joint])


def drawn_tracks(skin: SkinLike, rest_m: Floats, q: Floats) -> Floats:
    """(k, v, 3) where the vertices ``rest_m`` (v, 3) are drawn in each of the poses q (k, r)."""
    rest, place = skin.node_rest_m.astype(np.float64), skin.joint_rest_m.astype(np.float64)
    moved, stretch = limit_stretch(rest, skin.node_parent.astype(np.int64), skin.node_basis @ q.T)
    turns = (skin.node_turn @ q.T) / stretch[:, None]
    first, second = skin.joint_nodes.astype(np.int64).T
    share = skin.joint_share.astype(np.float64)[:, None, None]
    joint = skin.vertex_joint.astype(np.int64)
    moved_of, turn_of = (
        ((1 - share) * nodes[first] + share * nodes[second])[joint].transpose(2, 0, 1)
        for nodes in (moved, turns)
    )
    drawn = place[joint] + moved_of + turned(rest_m - place[joint], turn_of)
    return np.asarray(drawn, np.float64)


def joint_rows(skin: SkinLike, rows: npt.NDArray[np.float32]) -> npt.NDArray[np.float32]:
    """(j, 3, r) rows of the joints from those of the nodes (n, 3, r): of the basis or of the turns."""
    first, second = skin.joint_nodes.astype(np.int64).T
    share = skin.joint_share[:, None, None]
    return ((1 - share) * rows[first] + share * rows[second]).astype(np.float32)


def vertex_rows(skin: SkinLike, rest_m: npt.NDArray[np.floating]) -> npt.NDArray[np.float32]:
    """(v, 3, r) displacement of the vertices ``rest_m`` (v, 3) per unit of q, for small motion."""
    joint = skin.vertex_joint.astype(np.int64)
    arm = (rest_m - skin.joint_rest_m[joint]).astype(np.float32)
    turn = joint_rows(skin, skin.node_turn)[joint]
    swung = np.cross(turn, arm[:, :, None], axis=1)
    return (joint_rows(skin, skin.node_basis)[joint] + swung).astype(np.float32)
