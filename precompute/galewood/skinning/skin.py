"""The nodes of a table and how what is drawn follows them.

A node is a point of the axis of a branch, with one row of displacement and one of rotation per mode. A joint
is a place between two nodes; a rendered vertex moves with its joint and turns about it. Nodes are chosen so
that joints deviate little from the model even in strong wind (``galewood.reduction.knots``).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from galewood.reduction.knots import AxisMotion, Knots, choose_knots
from galewood.util import Floats, Ints

MAX_NODES = 768
JOINTS_PER_LINK = 32
"""Joints between two points of the axis; the bark between them is held by the nearest."""
TURN_ARM = 0.02
"""Arm at which rotation counts as displacement when nodes are chosen, relative to the height."""


class AxisLike(Protocol):
    """The axis of the branches (``galewood.model.Axis``)."""

    @property
    def points_m(self) -> Floats: ...
    @property
    def parent(self) -> Ints: ...
    def displacement(self, basis: Floats) -> Floats: ...
    def rotation(self, basis: Floats) -> Floats: ...


class FeetLike(Protocol):
    """Places on the axis that hold the render vertices (``galewood.model.Feet``)."""

    @property
    def child(self) -> Ints: ...
    @property
    def share(self) -> Floats: ...


@dataclass(frozen=True)
class Motion:
    """What decides on the nodes: the basis of the model's particles (N, 3, r), and how far its modes move.

    ``strong`` (k, r) are poses in strong wind, ``rms`` (r,) is the RMS of each mode.
    """

    basis: Floats
    strong: Floats
    rms: Floats


@dataclass(frozen=True)
class Nodes:
    """n nodes, j joints and the joint of each render vertex."""

    basis: npt.NDArray[np.float32]  # (n, 3, r) m per unit of q
    turn: npt.NDArray[np.float32]  # (n, 3, r) rotation vector per unit of q
    rest_m: npt.NDArray[np.float32]  # (n, 3)
    parent: npt.NDArray[np.uint16]  # (n,) the node before it on its branch or limb; its own index: none
    joint_nodes: npt.NDArray[np.uint16]  # (j, 2)
    joint_share: npt.NDArray[np.float32]  # (j,) share of the second node
    joint_rest_m: npt.NDArray[np.float32]  # (j, 3)
    vertex_joint: npt.NDArray[np.uint16]  # (v,)
    rms_error_m: float  # RMS distance of joints from the model over all vertices, at the RMS of the motion
    max_error_m: float  # the same for the worst vertex


def make_nodes(
    axis: AxisLike, feet: FeetLike, motion: Motion, tolerance_m: float, max_nodes: int = MAX_NODES
) -> Nodes:
    """Choose nodes so that no point of the axis deviates by more than tolerance_m in the strong poses."""
    moved, turned = axis.displacement(motion.basis), axis.rotation(motion.basis)
    arm_m = TURN_ARM * float(np.ptp(axis.points_m[:, 1]))
    strong = AxisMotion(axis.points_m, axis.parent, moved @ motion.strong.T, turned @ motion.strong.T, arm_m)
    knots = choose_knots(strong, tolerance_m, max_nodes)
    share = np.round(feet.share * JOINTS_PER_LINK).astype(np.int64)
    links, vertex = np.unique(np.column_stack([feet.child, share]), axis=0, return_inverse=True)
    child, share = links[:, 0], links[:, 1] / JOINTS_PER_LINK
    first, second, between = _between(knots, axis.parent, child, share)
    rigid = knots.base[child] >= 0
    place = _lerp(axis.points_m, axis.parent, child, share)
    place[rigid] = axis.points_m[knots.base[child[rigid]]]
    nodes = knots.nodes
    joints = np.column_stack([np.searchsorted(nodes, first), np.searchsorted(nodes, second)])
    off = _lerp(moved, axis.parent, child, share) - (
        (1 - between)[:, None, None] * moved[first] + between[:, None, None] * moved[second]
    )
    error = np.linalg.norm((off * motion.rms)[~rigid].reshape(int((~rigid).sum()), -1), axis=1)
    error = np.concatenate([error, [0.0]]) if not len(error) else error
    count = np.bincount(np.ravel(vertex), minlength=len(child))[~rigid]
    total = max(int(count.sum()), 1)
    return Nodes(
        moved[nodes].astype(np.float32),
        turned[nodes].astype(np.float32),
        axis.points_m[nodes].astype(np.float32),
        _parents(knots, axis.parent).astype(np.uint16),
        joints.astype(np.uint16),
        between.astype(np.float32),
        place.astype(np.float32),
        np.ravel(vertex).astype(np.uint16),
        float(np.sqrt((np.square(error[: len(count)]) * count).sum() / total)),
        float(error.max()),
    )


def _parents(knots: Knots, parent: Ints) -> Ints:
    """(n,) index of the node before each node on its branch, or of that which bears the branch."""
    is_node = np.zeros(len(parent), bool)
    is_node[knots.nodes] = True
    before = np.full(len(parent), -1, np.int64)
    for line in knots.lines:
        held = line.points[is_node[line.points]]
        before[held[1:]] = held[:-1]
    for node in knots.nodes.tolist():
        if knots.base[node] >= 0:
            before[node] = knots.base[node]
    index = np.searchsorted(knots.nodes, before[knots.nodes])
    return np.where(before[knots.nodes] >= 0, index, np.arange(len(knots.nodes)))


def _between(knots: Knots, parent: Ints, child: Ints, share: Floats) -> tuple[Ints, Ints, Floats]:
    """The nodes before and after places on links (j,), and the share of the second."""
    first, second, between = knots.base[child].copy(), knots.base[child].copy(), np.zeros(len(child))
    is_node = np.zeros(len(parent), bool)
    is_node[knots.nodes] = True
    for number in np.unique(knots.line[child[first < 0]]).tolist():
        line = knots.lines[number]
        points = line.points
        mark = knots.mark_m[points]
        mark[0] = 0.0
        held = np.flatnonzero(is_node[points])
        own = np.flatnonzero((knots.line[child] == number) & (knots.base[child] < 0))
        index = np.searchsorted(mark, knots.mark_m[child[own]])
        before = np.maximum(index - 1, 0)
        at = mark[before] + share[own] * (mark[index] - mark[before])
        right = np.clip(np.searchsorted(mark[held], at), 1, max(len(held) - 1, 1))
        right = np.minimum(right, len(held) - 1)
        left = np.maximum(right - 1, 0)
        span = np.maximum(mark[held[right]] - mark[held[left]], 1e-12)
        first[own], second[own] = points[held[left]], points[held[right]]
        between[own] = np.clip((at - mark[held[left]]) / span, 0.0, 1.0)
    return first, second, between


def _lerp(values: Floats, parent: Ints, child: Ints, share: Floats) -> Floats:
    """Values (p, …) at places on links (j,)."""
    wide = share.reshape(-1, *([1] * (values.ndim - 1)))
    return (1 - wide) * values[parent[child]] + wide * values[child]
