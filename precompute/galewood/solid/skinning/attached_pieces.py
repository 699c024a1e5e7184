"""Pieces attached to the middle of a long edge: they move with that edge and not with the axis beside it.

The bark is drawn straight between its vertices, while the axis bends: a fruit beside the middle of a long
cylinder would leave it in a far bend. Such a piece gets a node of its own, which moves by the mean of the
joints of both ends of the edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from galewood.solid.skinning.distortion import Contacts, Distortion
from galewood.solid.skinning.node_poses import SkinLike
from galewood.solid.skinning.skin import MAX_NODES
from galewood.util import Floats, Ints

LEAST_GAP = 5e-4
"""Gap over the height from which a piece gets a node of its own."""
MOST_PIECES = 64
"""Pieces of a primitive that may get one, those with the largest gaps first."""
LEAST_LINK = 0.25
"""Shortest link to the node before it, relative to the length of the edge."""

SkinT = TypeVar("SkinT", bound=SkinLike)


def with_attached_pieces(skin: SkinT, distortion: Distortion, q: Sequence[Floats]) -> SkinT:
    """The skin in which pieces that left their edges in the farthest poses of q (T, f) stay with them."""
    poses = distortion.far_poses(skin, q)
    for _, contacts in distortion.contacts:
        before = distortion.gaps(skin, contacts, poses)
        wide = np.flatnonzero(before > LEAST_GAP)
        wide = wide[np.argsort(-before[wide], kind="stable")][:MOST_PIECES]
        if not len(wide):
            continue
        attached = _attached(skin, distortion.rest_m, contacts, wide)
        better = wide[distortion.gaps(attached, contacts, poses)[wide] < before[wide]]
        if len(better) < len(wide):
            attached = _attached(skin, distortion.rest_m, contacts, better)
        skin = attached
    return skin


@dataclass(frozen=True)
class _EdgeNode:
    """A node between the joints of the ends of an edge: its rows, its rest and the node before it."""

    basis: Floats
    turn: Floats
    rest_m: Floats
    parent: int


def _attached(skin: SkinT, rest_m: Floats, contacts: Contacts, pieces: Ints) -> SkinT:
    """The skin in which pieces (p,) move with the edges that they are nearest to."""
    joint = skin.vertex_joint.astype(np.int64)
    distance, added, first = contacts.distance_m(rest_m), list[_EdgeNode](), len(skin.node_rest_m)
    count = len(skin.joint_share)
    room = min(MAX_NODES - first, np.iinfo(np.uint16).max - count)
    for piece in pieces.tolist():
        own = np.flatnonzero(contacts.piece == piece)
        near = own[distance[own].argmin()]
        ends, share = joint[contacts.support_ends[near]], float(contacts.support_share[near])
        vertices = contacts.vertices(piece)
        if (joint[vertices] != joint[vertices[0]]).any():  # a frond along its rib
            continue
        if ends[0] == ends[1]:
            joint[vertices] = ends[0]
        elif len(added) < room:
            joint[vertices] = count + len(added)
            added.append(_edge_node(skin, ends, share))
    attached = replace(skin, vertex_joint=joint.astype(np.uint16))
    return _with_nodes(attached, added) if added else attached


def _edge_node(skin: SkinLike, ends: Ints, share: float) -> _EdgeNode:
    """The node between two joints (2,): it moves by the mean of both."""
    weight = np.array([1 - share, share])
    nodes = skin.joint_nodes[ends].astype(np.int64)  # (2, 2)
    second = skin.joint_share[ends].astype(np.float64)
    each = weight[:, None] * np.stack([1 - second, second], axis=1)
    basis, turn = (
        np.einsum("ab,abcr->cr", each, rows[nodes].astype(np.float64))
        for rows in (skin.node_basis, skin.node_turn)
    )
    rest = weight @ skin.joint_rest_m[ends].astype(np.float64)
    edge_m = float(np.linalg.norm(np.diff(skin.joint_rest_m[ends], axis=0)))
    return _EdgeNode(basis, turn, rest, _parent(skin, int(nodes.min()), rest, LEAST_LINK * edge_m))


def _parent(skin: SkinLike, node: int, rest_m: Floats, least_m: float) -> int:
    """A node, or one nearer to the root, not too near to a place: short links stretch unlike the limb."""
    while np.linalg.norm(skin.node_rest_m[node] - rest_m) < least_m and int(skin.node_parent[node]) != node:
        node = int(skin.node_parent[node])
    return node


def _with_nodes(skin: SkinT, added: list[_EdgeNode]) -> SkinT:
    """The skin with further nodes, each with a joint of its own."""
    first, count = len(skin.node_rest_m), len(added)
    own = np.arange(first, first + count)

    def longer(rows: npt.NDArray[Any], more: npt.ArrayLike) -> npt.NDArray[Any]:
        return np.concatenate([rows, np.asarray(more, rows.dtype)])

    return replace(
        skin,
        node_basis=longer(skin.node_basis, [one.basis for one in added]),
        node_turn=longer(skin.node_turn, [one.turn for one in added]),
        node_rest_m=longer(skin.node_rest_m, [one.rest_m for one in added]),
        node_parent=longer(skin.node_parent, [one.parent for one in added]),
        joint_nodes=longer(skin.joint_nodes, np.column_stack([own, own])),
        joint_share=longer(skin.joint_share, [0.0] * count),
        joint_rest_m=longer(skin.joint_rest_m, [one.rest_m for one in added]),
    )
