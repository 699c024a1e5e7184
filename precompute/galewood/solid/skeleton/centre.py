"""Centre lines of the skeleton: L1-medial centring across the axis, then a local linear fit along each
branch.

Source: Huang, Wu, Cohen-Or, Gong, Zhang, Li & Chen 2013, "L1-medial skeleton of point cloud", eq. 2. Only its
attraction term is used: the level sets define the order of the points, so no repulsion is needed.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from galewood.util import Floats, Ints

ITERATION_COUNT = 10
RADII_OF_SUPPORT = 5.0
STEPS_OF_SUPPORT = 1.5
FIT_STEPS = 1.5
FIT_RADII = 1.0


def branch_lines(branch: Ints) -> list[Ints]:
    """Point indices of each branch from its base outwards (parents precede children in the arrays)."""
    order = np.argsort(branch, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(branch[order])) + 1)


def l1_centred(
    points_m: Floats,
    branch: Ints,
    parent: Ints,
    radius_m: Floats,
    samples_m: Floats,
    sample_branch: Ints,
    step_m: float,
) -> Floats:
    """Move points to the L1 median of the samples of their own branch, across the branch only."""
    result = points_m.copy()
    for line in branch_lines(branch):
        own = samples_m[sample_branch == branch[line[0]]]
        inner = line[1:-1]  # the base lies in the parent and the tip has wood on one side only
        if len(own) < 8 or not len(inner):
            continue
        tree = KDTree(own)
        for _ in range(ITERATION_COUNT):
            tangent = line_tangents(result[line])[1:-1]
            result[inner] += _attraction(result[inner], tangent, radius_m[inner], own, tree, step_m)
    return result


def _attraction(
    points_m: Floats, tangent: Floats, radius_m: Floats, samples_m: Floats, tree: KDTree, step_m: float
) -> Floats:
    support = np.maximum(RADII_OF_SUPPORT * radius_m, STEPS_OF_SUPPORT * step_m)
    near = tree.query_ball_point(points_m, support)
    move = np.zeros_like(points_m)
    for i, chosen in enumerate(near):
        if len(chosen) < 4:
            continue
        offset = samples_m[chosen] - points_m[i]
        along = offset @ tangent[i]
        slab = np.abs(along) <= STEPS_OF_SUPPORT * step_m
        offset = offset[slab] - along[slab, None] * tangent[i]
        gap = np.linalg.norm(offset, axis=1)
        weight = np.exp(-((gap / (0.5 * support[i])) ** 2)) / np.maximum(gap, 0.05 * radius_m[i] + 1e-9)
        if weight.sum() > 0:
            move[i] = weight @ offset / weight.sum()
    length = np.linalg.norm(move, axis=1)
    return move * np.minimum(1.0, radius_m / np.maximum(length, 1e-30))[:, None]


def line_tangents(line_m: Floats) -> Floats:
    """Unit tangents of a polyline by central differences."""
    ahead = np.concatenate([line_m[1:], line_m[-1:]])
    behind = np.concatenate([line_m[:1], line_m[:-1]])
    return unit(ahead - behind)


def unit(rows: Floats) -> Floats:
    """Rows scaled to unit length; zero rows become +y."""
    length = np.linalg.norm(rows, axis=1, keepdims=True)
    return np.where(length > 1e-12, rows / np.maximum(length, 1e-300), (0.0, 1.0, 0.0))


def fitted_lines(
    points_m: Floats, branch: Ints, parent: Ints, radius_m: Floats, step_m: float
) -> tuple[Floats, Floats]:
    """Points (p, 3) and unit tangents (p, 3) from a weighted linear fit around each point of its branch."""
    fitted, tangent = points_m.copy(), np.zeros_like(points_m)
    for line in branch_lines(branch):
        base = parent[line[0]]
        if len(line) == 1:
            start = points_m[base] if base >= 0 else points_m[line[0]] - (0.0, 1.0, 0.0)
            tangent[line] = unit(points_m[line] - start)
            continue
        fitted[line], tangent[line] = _local_linear(points_m[line], radius_m[line], step_m)
    return fitted, tangent


def _local_linear(line_m: Floats, radius_m: Floats, step_m: float) -> tuple[Floats, Floats]:
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line_m, axis=0), axis=1))])
    width = np.maximum(FIT_STEPS * step_m, FIT_RADII * radius_m)
    offset = arc[None, :] - arc[:, None]
    weight = np.exp(-0.5 * (offset / width[:, None]) ** 2)
    weight /= weight.sum(axis=1, keepdims=True)
    mean_offset = (weight * offset).sum(axis=1)
    mean = weight @ line_m
    spread = (weight * (offset - mean_offset[:, None]) ** 2).sum(axis=1)
    slope = (
        np.einsum("ij,ij,jk->ik", weight, offset - mean_offset[:, None], line_m)
        / np.maximum(spread, 1e-300)[:, None]
    )
    return mean - mean_offset[:, None] * slope, unit(slope)
