"""Skin weights fitted to the motion of a table's joints (linear blend skinning, at most four bones)."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from galewood.io.export.skeletal.joints import RigidMotion, rotated
from galewood.io.export.skeletal.skeleton import Skeleton
from galewood.table import Table
from galewood.util import Floats, Ints

BONES_PER_VERTEX = 4
POINTS_PER_JOINT = 6
"""Vertices of a joint that its weights are fitted to: those farthest out in six directions."""
WEIGHT_REGULARISATION = 1e-6
"""Share of the mean squared motion added to the normal equations, so that equal bones share evenly."""


def candidates(table: Table, skeleton: Skeleton) -> Ints:
    """(j, 4) bones that may move each joint: of its two nodes, the next one outwards, and the one before.

    Where there is no other one, the first is repeated.
    """
    node = table.joint_nodes.astype(np.int64).T
    first, second = skeleton.of_node[node]
    above = np.where(skeleton.parent[first] >= 0, skeleton.parent[first], first)
    below = np.where(skeleton.beyond_node[node[1]] >= 0, skeleton.beyond_node[node[1]], second)
    return np.stack([first, second, above, below], axis=1)


def fitted_weights(
    table: Table, rest_m: Floats, skeleton: Skeleton, bones: RigidMotion, joints: RigidMotion
) -> tuple[Ints, Floats]:
    """Bones (j, 4) and weights (j, 4), ≥ 0, of sum 1, that move the vertices of each joint as the table does.

    Args:
        table: The table.
        rest_m: Vertices at rest (v, 3).
        skeleton: The bones.
        bones: Their motion in some poses.
        joints: The motion of the joints in the same poses.
    """
    used = candidates(table, skeleton)
    gram, aimed = _normal_equations(_points(table, rest_m), used, skeleton, bones, joints, table)
    repeated = np.array([[(row[:k] == row[k]).any() for k in range(BONES_PER_VERTEX)] for row in used])
    best, weights = np.full(len(used), np.inf), np.zeros(used.shape)
    weights[:, 0] = 1.0
    for count in range(1, BONES_PER_VERTEX + 1):
        for chosen in combinations(range(BONES_PER_VERTEX), count):
            part = list(chosen)
            found = _solved(gram[:, part][:, :, part], aimed[:, part])
            full = np.zeros(used.shape)
            full[:, part] = found
            error = np.einsum("ja,jab,jb->j", full, gram, full) - 2 * np.einsum("ja,ja->j", full, aimed)
            allowed = (found >= 0).all(axis=1) & ~repeated[:, part].any(axis=1)
            better = allowed & (error < best)
            best[better], weights[better] = error[better], full[better]
    return used, weights / weights.sum(axis=1, keepdims=True)


def _points(table: Table, rest_m: Floats) -> Floats:
    """(j, POINTS_PER_JOINT, 3) places at rest by which the motion of a joint's vertices is judged."""
    joint = table.vertex_joint.astype(np.int64)
    points = np.repeat(table.joint_rest_m.astype(np.float64)[:, None], POINTS_PER_JOINT, axis=1)
    order = np.argsort(joint, kind="stable")
    bounds = np.searchsorted(joint[order], np.arange(len(points) + 1))
    for j in range(len(points)):
        mine = rest_m[order[bounds[j] : bounds[j + 1]]]
        if len(mine):
            points[j, :3], points[j, 3:] = mine[mine.argmin(axis=0)], mine[mine.argmax(axis=0)]
    return points


def _normal_equations(
    points: Floats, used: Ints, skeleton: Skeleton, bones: RigidMotion, joints: RigidMotion, table: Table
) -> tuple[Floats, Floats]:
    """Gram matrices (j, 4, 4) of what the bones do to the points, and their products (j, 4) with the aim."""
    place = table.joint_rest_m.astype(np.float64)
    count = len(used)
    gram, aimed = np.zeros((count, BONES_PER_VERTEX, BONES_PER_VERTEX)), np.zeros((count, BONES_PER_VERTEX))
    for frame in range(len(bones.moved_m)):
        arm = points - place[:, None]
        turn = joints.rotation[frame][:, None]
        aim = joints.moved_m[frame][:, None] + rotated(turn, arm) - arm
        moved = np.empty((BONES_PER_VERTEX, *points.shape))
        for k in range(BONES_PER_VERTEX):
            bone = used[:, k]
            reach = points - skeleton.place_m[bone][:, None]
            turn = bones.rotation[frame][bone][:, None]
            moved[k] = bones.moved_m[frame][bone][:, None] + rotated(turn, reach) - reach
        gram += np.einsum("ajpx,bjpx->jab", moved, moved)
        aimed += np.einsum("ajpx,jpx->ja", moved, aim)
    mean = np.trace(gram, axis1=1, axis2=2)[:, None, None] / BONES_PER_VERTEX
    return gram + WEIGHT_REGULARISATION * (mean + 1e-12) * np.eye(BONES_PER_VERTEX), aimed


def _solved(gram: Floats, aimed: Floats) -> Floats:
    """(j, k) minima of ½ wᵀ G w − aᵀ w with Σ w = 1 (Lagrange multiplier)."""
    count, k = aimed.shape
    system = np.ones((count, k + 1, k + 1))
    system[:, :k, :k], system[:, k, k] = gram, 0.0
    right = np.concatenate([aimed, np.ones((count, 1))], axis=1)
    return np.linalg.solve(system, right[:, :, None])[:, :k, 0].astype(np.float64)
