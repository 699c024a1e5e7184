"""Motion of the branches: what the outer half of a crown does beyond following the bending trunk."""

from __future__ import annotations

import numpy as np

from galewood.table import Table
from galewood.util import Array, Floats, Ints


def trunk_nodes(table: Table) -> Ints:
    """The nodes of the trunk from its foot up: where it forks, it continues with the limb of longest reach.

    That is how the skeleton divides a tree into branches.
    """
    rest_m, parent = table.node_rest_m.astype(np.float64), table.node_parent.astype(np.int64)
    root = int(np.flatnonzero(parent == np.arange(len(parent)))[0])
    length_m = np.linalg.norm(rest_m - rest_m[parent], axis=1)
    reach_m, after = np.zeros(len(parent)), np.full(len(parent), -1)
    for node in range(len(parent) - 1, -1, -1):  # a parent is never a later node
        before, far_m = parent[node], reach_m[node] + length_m[node]
        if before != node and (after[before] < 0 or far_m > reach_m[before]):
            reach_m[before], after[before] = far_m, node
    trunk = [root]
    while after[trunk[-1]] >= 0:
        trunk.append(int(after[trunk[-1]]))
    return np.array(trunk)


def outer_nodes(table: Table) -> Ints:
    """The half of the other nodes that is farthest from the trunk at its height; none on a pole."""
    trunk, rest_m = trunk_nodes(table), table.node_rest_m.astype(np.float64)
    branch = np.setdiff1d(np.arange(len(rest_m)), trunk)
    if not len(branch):
        return branch
    axis_m = _at_heights(rest_m[trunk], rest_m[trunk][None], rest_m[branch])[0]
    far_m = np.hypot(*(rest_m[branch] - axis_m)[:, [0, 2]].T)
    return branch[far_m >= np.median(far_m)]


def branch_motion_m(table: Table, track_m: Floats) -> float | None:
    """How far the outer half of the crown moves relative to the trunk at its height, m; None on a pole.

    ``track_m`` (T, n, 3) is the displacement of the table's nodes. Of each node, the root mean square over
    time about its mean; of all of them, the median.
    """
    trunk, outer, rest_m = trunk_nodes(table), outer_nodes(table), table.node_rest_m.astype(np.float64)
    if not len(outer):
        return None
    own = relative_to_trunk(rest_m, trunk, outer, track_m)
    own -= own.mean(axis=0)
    return float(np.median(np.sqrt(np.square(own).sum(axis=2).mean(axis=0))))


def relative_to_trunk(rest_m: Floats, trunk: Ints, nodes: Ints, track_m: Floats) -> Floats:
    """(T, m, 3) displacement, m, of m nodes less that of the trunk at their height; ``track_m`` (T, n, 3)."""
    return track_m[:, nodes] - _at_heights(rest_m[trunk], track_m[:, trunk], rest_m[nodes])


def _at_heights(trunk_m: Floats, values: Array, points_m: Floats) -> Floats:
    """(T, m, 3) values (T, k, 3) at the trunk (k, 3), interpolated to the heights of points (m, 3)."""
    order = np.argsort(trunk_m[:, 1], kind="stable")  # a trunk may hang over at its top
    height_m, values = trunk_m[order, 1], values[:, order]
    if len(height_m) == 1:
        return np.repeat(values, len(points_m), axis=1)
    upper = np.clip(np.searchsorted(height_m, points_m[:, 1]), 1, len(height_m) - 1)
    rise_m = np.maximum(height_m[upper] - height_m[upper - 1], 1e-9)
    share = np.clip((points_m[:, 1] - height_m[upper - 1]) / rise_m, 0.0, 1.0)[None, :, None]
    return (1.0 - share) * values[:, upper - 1] + share * values[:, upper]
