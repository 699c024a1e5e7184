"""Bones for a tree: which nodes of the table become bones, and how many may be left out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.io.export.skeletal.joints import RigidMotion, rotated
from galewood.table import Table
from galewood.util import Floats, Ints

Mask = npt.NDArray[np.bool_]
MAX_POSES = 48
"""Most poses that bones are chosen and weights are fitted by."""


@dataclass(frozen=True)
class Skeleton:
    """Bones, parents before children."""

    node: Ints
    """(b,) node of the table that the bone follows."""
    parent: Ints
    """(b,) parent of the bone; −1: none."""
    place_m: Floats
    """(b, 3) place at rest."""
    of_node: Ints
    """(n,) bone of each node: its own, or that of the nearest node towards the root that has one."""
    beyond_node: Ints
    """(n,) first bone after each node along its branch; −1: none."""
    name: tuple[str, ...]


def parents_of(table: Table) -> Ints:
    """(n,) parent of each node; −1: none."""
    parent = table.node_parent.astype(np.int64)
    return np.where(parent == np.arange(len(parent)), -1, parent)


def samples(motion: RigidMotion) -> RigidMotion:
    """At most MAX_POSES frames of a motion, evenly spaced."""
    count = len(motion.moved_m)
    chosen = np.unique(np.linspace(0, count - 1, min(count, MAX_POSES)).astype(np.int64))
    return RigidMotion(motion.moved_m[chosen], motion.rotation[chosen])


def choose_bones(table: Table, motion: RigidMotion, most: int) -> Skeleton:
    """At most ``most`` nodes as bones: again and again, the node that then carries those after it best.

    What is reduced is the sum of the squared distances of all nodes from where their bones carry them.
    ``motion``: of all nodes in some poses. Nodes of no parent are always bones.
    """
    parent, rest = parents_of(table), table.node_rest_m.astype(np.float64)
    chosen = parent < 0
    if most >= len(parent):
        chosen[:] = True
    else:
        error, carries = _carried_error(rest, motion), _descent(parent)
        while chosen.sum() < most:
            chosen[_best(error, carries, _bearers(parent, chosen), chosen)] = True
    node = np.flatnonzero(chosen)
    bone = np.full(len(parent), -1)
    bone[node] = np.arange(len(node))
    above = np.where(parent[node] >= 0, _bearers(parent, chosen)[np.maximum(parent[node], 0)], -1)
    return Skeleton(
        node,
        np.where(above >= 0, bone[above], -1),
        rest[node],
        bone[_bearers(parent, chosen)],
        _beyond(main_children(parent), bone),
        bone_names(parent, node),
    )


def _bearers(parent: Ints, chosen: Mask) -> Ints:
    """(n,) the node itself if chosen, else the nearest chosen one towards the root. Parents come first."""
    found = np.arange(len(parent))
    for node in range(len(parent)):
        if not chosen[node]:
            found[node] = found[parent[node]]
    return found


def _descent(parent: Ints) -> Mask:
    """(n, n) whether the second node is the first or comes after it on the way from the root."""
    found = np.eye(len(parent), dtype=np.bool_)
    for node, above in enumerate(parent):
        if above >= 0:
            found[:, node] |= found[:, above]
    return found


def _carried_error(rest: Floats, motion: RigidMotion) -> Floats:
    """(n, n) squared distance, m², of the second node from where the first carries it; sum over the poses."""
    found = np.zeros((len(rest), len(rest)))
    arm = rest[None] - rest[:, None]
    for moved, rotation in zip(motion.moved_m, motion.rotation, strict=True):
        carried = moved[:, None] + rotated(rotation[:, None], arm) - arm
        found += np.square(carried - moved[None]).sum(axis=2)
    return found


def _best(error: Floats, carries: Mask, parent_bone: Ints, chosen: Mask) -> int:
    """The node not yet chosen that reduces the error most."""
    now = error[parent_bone, np.arange(len(parent_bone))]
    # a new bone takes over the nodes after it whose bones come before it
    takes_over = carries & carries[parent_bone].T
    gain = np.where(takes_over, now[None] - error, 0.0).sum(axis=1)
    return int(np.argmax(np.where(chosen, -np.inf, gain)))


def main_children(parent: Ints) -> Ints:
    """(n,) the child of each node that most nodes hang on, with which its branch goes on; −1: none."""
    weight = np.ones(len(parent))
    for node in range(len(parent) - 1, -1, -1):
        if parent[node] >= 0:
            weight[parent[node]] += weight[node]
    main_child = np.full(len(parent), -1)
    for node, above in enumerate(parent):
        if above >= 0 and (main_child[above] < 0 or weight[node] > weight[main_child[above]]):
            main_child[above] = node
    return main_child


def _beyond(main_child: Ints, bone: Ints) -> Ints:
    """(n,) first bone after each node along its branch; −1: none."""
    found = np.full(len(main_child), -1)
    for node in range(len(main_child) - 1, -1, -1):
        if main_child[node] >= 0:
            found[node] = bone[main_child[node]] if bone[main_child[node]] >= 0 else found[main_child[node]]
    return found


def branch_of_node(table: Table) -> tuple[Ints, Ints]:
    """(n,) branch of each node and (branches,) parent branch, −1: none; branch 0 begins at the first root.

    A branch goes on with the child that most nodes hang on; the other children begin branches.
    """
    parent = parents_of(table)
    main_child = main_children(parent)
    branch, parent_branch = np.full(len(parent), -1), list[int]()
    for node in range(len(parent)):
        above = parent[node]
        if above >= 0 and main_child[above] == node:
            branch[node] = branch[above]
        else:
            branch[node] = len(parent_branch)
            parent_branch.append(-1 if above < 0 else int(branch[above]))
    return branch, np.array(parent_branch, np.int64)


def levels(parent_branch: Ints) -> Ints:
    """(branches,) 0 for the trunk, 1 for its branches, and so on; parents come first."""
    level = np.zeros(len(parent_branch), np.int64)
    for branch, above in enumerate(parent_branch):
        level[branch] = 0 if above < 0 else level[above] + 1
    return level


def bone_names(parent: Ints, node: Ints) -> tuple[str, ...]:
    """Names of bones: bone_000, bone_001, …; the number is the node's in the table."""
    digits = max(3, len(str(len(parent) - 1)))
    return tuple(f"bone_{int(one):0{digits}d}" for one in node)
