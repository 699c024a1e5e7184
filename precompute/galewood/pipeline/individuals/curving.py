"""The curved paths of a bending tree: its branches turn, and do not become longer.

A branch of direction t, turned by the rotation vector θ, points along t + θ × t + ½ θ × (θ × t) + …. The
second term is the linear motion; the third, added up along the branches, is the displacement of second order.
"""

from __future__ import annotations

import numpy as np

from galewood.pipeline.individuals.sway import Sway
from galewood.pipeline.reduction import Oscillators
from galewood.solid.model import BeamModel
from galewood.solid.skinning import Axis
from galewood.util import Floats, Ints

PAIRS = ((0, 0), (0, 1), (1, 1))
"""Products of the sway coordinates: x², xy, y², as the first terms of the pose."""


def curved_shapes(model: BeamModel, own: Oscillators, sway: Sway, arm_m: float) -> Floats:
    """(3, N, 3) displacement of the particles of a beam model per unit of x², xy and y², m.

    ``arm_m`` is the distance of the three particles beside each point.
    """
    axis = model.axis
    shapes = (sway.spread.T @ own.shapes).reshape(2, -1, 3).transpose(1, 2, 0)
    turned = axis.rotation(shapes)
    return np.stack([second_order(axis, turned, pair, arm_m) for pair in PAIRS])


def second_order(axis: Axis, turned: Floats, pair: tuple[int, int], arm_m: float) -> Floats:
    """(4p, 3) displacement of the particles per unit of a product of sways, with rotations (p, 3, 2)."""
    i, j = pair
    links, parent = axis.links, axis.parent[axis.links]
    along = axis.points_m[links] - axis.points_m[parent]
    one, other = turned[parent], turned[links]
    # the rotation is linear along a link: the mean of its products with itself
    shares = ((1 / 3, one, one), (1 / 3, other, other), (1 / 6, one, other), (1 / 6, other, one))
    step, moved = np.zeros_like(axis.points_m), np.zeros_like(axis.points_m)
    for share, a, b in shares:
        step[links] += share * _turned_twice(a[:, :, i], b[:, :, j], along)
    for point in _from_root(axis.parent):
        moved[point] = moved[axis.parent[point]] + step[point]
    beside = [
        moved + arm_m * _turned_twice(turned[:, :, i], turned[:, :, j], np.broadcast_to(unit, moved.shape))
        for unit in np.eye(3)
    ]
    both = 1.0 if i == j else 2.0
    return both * np.stack([moved, *beside], axis=1).reshape(-1, 3)


def _turned_twice(a: Floats, b: Floats, along: Floats) -> Floats:
    """(n, 3) ½ a × (b × along), symmetric in a and b."""
    return (np.cross(a, np.cross(b, along)) + np.cross(b, np.cross(a, along))) / 4


def _from_root(parent: Ints) -> list[int]:
    """Points that have a parent, each after it."""
    depth = np.full(len(parent), -1)
    depth[parent < 0] = 0
    while (depth < 0).any():
        depth = np.where(depth < 0, np.where(depth[parent] >= 0, depth[parent] + 1, -1), depth)
    order = np.argsort(depth, kind="stable")
    return order[depth[order] > 0].tolist()
