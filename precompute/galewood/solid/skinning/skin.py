"""The skin of a table: nodes on the axis, joints between them, and the joint of every vertex.

A node is a point of the axis of a branch, with one row of displacement and one of rotation per mode. A joint
is a place on the straight line between two nodes, whatever the axis does there: what lies beside that line
turns with the joint. A rendered vertex moves with its joint and turns about it. Nodes are chosen so
that joints deviate little from the model even in strong wind (``skinning.axis_simplification``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.constants import TURN_ARM
from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.axis_simplification import AxisMotion, SimplifiedAxis, simplify_axis
from galewood.solid.skinning.bindings import Bindings
from galewood.util import Floats, Ints

MAX_NODES = 768
JOINTS_PER_LINK = 32
"""Joints between two points of the axis; bindings between them are rounded to the nearest."""


@dataclass(frozen=True)
class MotionSamples:
    """What decides on the nodes: the basis of the model's particles (N, 3, r), and how far its modes move.

    ``strong`` (k, r) are poses in strong wind, ``rms`` (r,) is the RMS of each mode.
    """

    basis: Floats
    strong: Floats
    rms: Floats


@dataclass(frozen=True)
class Skin:
    """n nodes, j joints and the joint of each render vertex, as in a table (spec/formats/table.md)."""

    node_basis: npt.NDArray[np.float32]  # (n, 3, r) m per unit of q
    node_turn: npt.NDArray[np.float32]  # (n, 3, r) rotation vector per unit of q
    node_rest_m: npt.NDArray[np.float32]  # (n, 3)
    node_parent: npt.NDArray[np.uint16]  # (n,) the node before it on its branch or limb; its own index: none
    joint_nodes: npt.NDArray[np.uint16]  # (j, 2)
    joint_share: npt.NDArray[np.float32]  # (j,) weight of the second node
    joint_rest_m: npt.NDArray[np.float32]  # (j, 3)
    vertex_joint: npt.NDArray[np.uint16]  # (v,)
    rms_error_m: float  # RMS distance of joints from the model over all vertices, at the RMS of the motion
    max_error_m: float  # the same for the worst vertex


@dataclass(frozen=True)
class _Joints:
    """Places on links of the axis, ``share`` (j,) of the way to ``child``; the joint of each vertex (v,)."""

    child: Ints
    share: Floats
    vertex: Ints


def make_skin(
    axis: Axis, bindings: Bindings, motion: MotionSamples, tolerance_m: float, max_nodes: int = MAX_NODES
) -> Skin:
    """Choose nodes so that no point of the axis deviates by more than tolerance_m in the strong poses."""
    moved, turned = axis.displacement(motion.basis), axis.rotation(motion.basis)
    arm_m = TURN_ARM * float(np.ptp(axis.points_m[:, 1]))
    strong = AxisMotion(axis.points_m, axis.parent, moved @ motion.strong.T, turned @ motion.strong.T, arm_m)
    simplified = simplify_axis(strong, tolerance_m, max_nodes)
    joints = _joints(bindings, simplified)
    child, share = joints.child, joints.share
    first, second, weight = _node_weights(simplified, child, share)
    place = _blend(axis.points_m, first, second, weight)  # on the straight line between the nodes
    beside = _lerp(axis.points_m, axis.parent, child, share) - place
    swung = np.cross(_blend(turned, first, second, weight), beside[:, :, None], axis=1)
    off = _lerp(moved, axis.parent, child, share) - _blend(moved, first, second, weight) - swung
    count = np.bincount(joints.vertex, minlength=len(child))
    rms_error_m, max_error_m = _errors_m(off * motion.rms, count)
    nodes = simplified.nodes
    return Skin(
        moved[nodes].astype(np.float32),
        turned[nodes].astype(np.float32),
        axis.points_m[nodes].astype(np.float32),
        _parents(simplified).astype(np.uint16),
        np.column_stack([np.searchsorted(nodes, first), np.searchsorted(nodes, second)]).astype(np.uint16),
        weight.astype(np.float32),
        place.astype(np.float32),
        joints.vertex.astype(np.uint16),
        rms_error_m,
        max_error_m,
    )


def _joints(bindings: Bindings, simplified: SimplifiedAxis) -> _Joints:
    """The different bindings of all vertices, rounded to JOINTS_PER_LINK places on each link.

    What is bound to a rigid branch is bound to the place that carries it.
    """
    share = np.round(bindings.share * JOINTS_PER_LINK).astype(np.int64)
    base = simplified.base[bindings.child]
    child, share = np.where(base < 0, bindings.child, base), np.where(base < 0, share, JOINTS_PER_LINK)
    links, vertex = np.unique(np.column_stack([child, share]), axis=0, return_inverse=True)
    return _Joints(links[:, 0], links[:, 1] / JOINTS_PER_LINK, np.ravel(vertex))


def _errors_m(off: Floats, count: Ints) -> tuple[float, float]:
    """RMS and largest norm of deviations (j, 3, r) of joints that hold so many vertices (j,)."""
    error = np.linalg.norm(off.reshape(len(off), off.shape[1] * off.shape[2]), axis=1)
    rms = float(np.sqrt((np.square(error) * count).sum() / max(int(count.sum()), 1)))
    return rms, float(error.max(initial=0.0))


def _parents(simplified: SimplifiedAxis) -> Ints:
    """(n,) index of the node before each node on its branch, or of that which bears the branch."""
    nodes, count = simplified.nodes, len(simplified.base)
    is_node = np.zeros(count, bool)
    is_node[nodes] = True
    before = np.full(count, -1, np.int64)
    for line in simplified.lines:
        kept = line.points[is_node[line.points]]
        before[kept[1:]] = kept[:-1]
    index = np.searchsorted(nodes, before[nodes])
    return np.where(before[nodes] >= 0, index, np.arange(len(nodes)))


def _node_weights(simplified: SimplifiedAxis, child: Ints, share: Floats) -> tuple[Ints, Ints, Floats]:
    """The nodes before and after places on links (j,) of branches that bend, and the weight of the second."""
    first, second, weight = child.copy(), child.copy(), np.zeros(len(child))
    is_node = np.zeros(len(simplified.line), bool)
    is_node[simplified.nodes] = True
    for number in np.unique(simplified.line[child]).tolist():
        points = simplified.lines[number].points
        arc = simplified.arc_m[points]
        arc[0] = 0.0
        kept = np.flatnonzero(is_node[points])
        own = np.flatnonzero(simplified.line[child] == number)
        index = np.searchsorted(arc, simplified.arc_m[child[own]])
        before = np.maximum(index - 1, 0)
        at = arc[before] + share[own] * (arc[index] - arc[before])
        right = np.clip(np.searchsorted(arc[kept], at), 1, max(len(kept) - 1, 1))
        right = np.minimum(right, len(kept) - 1)
        left = np.maximum(right - 1, 0)
        span = np.maximum(arc[kept[right]] - arc[kept[left]], 1e-12)
        first[own], second[own] = points[kept[left]], points[kept[right]]
        weight[own] = np.clip((at - arc[kept[left]]) / span, 0.0, 1.0)
    return first, second, weight


def _lerp(values: Floats, parent: Ints, child: Ints, share: Floats) -> Floats:
    """Values (p, …) at places on links (j,)."""
    return _blend(values, parent[child], child, share)


def _blend(values: Floats, first: Ints, second: Ints, share: Floats) -> Floats:
    """Values (p, …) between two points (j,) each, with the weights of the second (j,)."""
    wide = share.reshape(-1, *([1] * (values.ndim - 1)))
    return (1 - wide) * values[first] + wide * values[second]
