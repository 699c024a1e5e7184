"""Pieces that hang on the middle of a long edge: they move with that edge and not with the axis beside it.

The bark is drawn straight between its vertices, while the axis bends: a fruit beside the middle of a long
cylinder would leave it in a far bend. Such a piece gets a node of its own, which moves by the mean of what
holds both ends of the edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.pipeline.drawn_figures import Contacts, DrawnFigures
from galewood.reduction import MAX_NODES
from galewood.table import Table
from galewood.util import Floats, Ints

NEAR = 5e-4
"""Gap over the height from which a piece gets a node of its own."""
MOST = 64
"""Pieces that may get one, those with the largest gaps first."""
SHORTEST = 0.25
"""Shortest link to the node before it, relative to the length of the edge."""


def with_borne_pieces(table: Table, figures: DrawnFigures, q: Sequence[Floats]) -> Table:
    """The table in which pieces that left their edges in the farthest poses of q (T, f) stay with them."""
    poses = figures.far_poses(table, q)
    for number in range(len(figures.contacts)):
        contacts = figures.contacts[number][1]
        before = figures.gaps(table, contacts, poses)
        wide = np.flatnonzero(before > NEAR)
        wide = wide[np.argsort(-before[wide], kind="stable")][:MOST]
        if not len(wide):
            continue
        held = _held(table, figures, contacts, wide)
        better = wide[figures.gaps(held, contacts, poses)[wide] < before[wide]]
        table = held if len(better) == len(wide) else _held(table, figures, contacts, better)
    return table


@dataclass(frozen=True)
class _Held:
    """A place between what holds the ends of an edge: rows of a node, its rest and the node before it."""

    basis: Floats
    turn: Floats
    rest_m: Floats
    parent: int


def _held(table: Table, figures: DrawnFigures, contacts: Contacts, pieces: Ints) -> Table:
    """The table in which pieces (p,) move with the edges that they are nearest to."""
    joint = table.vertex_joint.astype(np.int64)
    distance, added, first = contacts.distance_m(figures.rest_m), list[_Held](), len(table.node_rest_m)
    count = len(table.joint_share)
    room = min(MAX_NODES - first, np.iinfo(np.uint16).max - count)
    for piece in pieces.tolist():
        own = np.flatnonzero(contacts.piece == piece)
        near = own[distance[own].argmin()]
        ends, share = joint[contacts.bearer_ends[near]], float(contacts.bearer_share[near])
        vertices = contacts.vertices(piece)
        if (joint[vertices] != joint[vertices[0]]).any():  # a frond along its rib
            continue
        if ends[0] == ends[1]:
            joint[vertices] = ends[0]
        elif len(added) < room:
            joint[vertices] = count + len(added)
            added.append(_between(table, ends, share))
    held = replace(table, vertex_joint=joint.astype(np.uint16))
    return _with_nodes(held, added) if added else held


def _between(table: Table, ends: Ints, share: float) -> _Held:
    """The place between two joints (2,): it moves by the mean of both."""
    weight = np.array([1 - share, share])
    nodes = table.joint_nodes[ends].astype(np.int64)  # (2, 2)
    second = table.joint_share[ends].astype(np.float64)
    each = weight[:, None] * np.stack([1 - second, second], axis=1)
    basis, turn = (
        np.einsum("ab,abcr->cr", each, rows[nodes].astype(np.float64))
        for rows in (table.node_basis, table.node_turn)
    )
    rest = weight @ table.joint_rest_m[ends].astype(np.float64)
    edge_m = float(np.linalg.norm(np.diff(table.joint_rest_m[ends], axis=0)))
    return _Held(basis, turn, rest, _before(table, int(nodes.min()), rest, SHORTEST * edge_m))


def _before(table: Table, node: int, rest_m: Floats, least_m: float) -> int:
    """A node, or one nearer to the root, not too near to a place: short links stretch unlike the limb."""
    while np.linalg.norm(table.node_rest_m[node] - rest_m) < least_m and int(table.node_parent[node]) != node:
        node = int(table.node_parent[node])
    return node


def _with_nodes(table: Table, added: list[_Held]) -> Table:
    """The table with further nodes, each with a joint of its own."""
    first, count = len(table.node_rest_m), len(added)
    own = np.arange(first, first + count)

    def longer(rows: npt.NDArray[Any], more: npt.ArrayLike) -> npt.NDArray[Any]:
        return np.concatenate([rows, np.asarray(more, rows.dtype)])

    return replace(
        table,
        node_basis=longer(table.node_basis, [one.basis for one in added]),
        node_turn=longer(table.node_turn, [one.turn for one in added]),
        node_rest_m=longer(table.node_rest_m, [one.rest_m for one in added]),
        node_parent=longer(table.node_parent, [one.parent for one in added]),
        joint_nodes=longer(table.joint_nodes, np.column_stack([own, own])),
        joint_share=longer(table.joint_share, [0.0] * count),
        joint_rest_m=longer(table.joint_rest_m, [one.rest_m for one in added]),
    )
