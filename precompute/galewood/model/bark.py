"""Places on the axis that hold the bark."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_matrix

from galewood.mesh import RenderPrimitive
from galewood.model.axis import Axis, Feet
from galewood.util import Floats

ROUNDS = 4
SHORTEST = 1e-5
"""Relative to the extent; vertices nearer than this are one."""


def bark_feet(wood: RenderPrimitive, axis: Axis) -> Feet:
    """The place of every vertex (n,) of a wood primitive.

    Sought from the middle of the ring around the vertex, so that a ring is held at one place: where the axis
    does not run through the middle of a thin branch, its vertices would be held far from each other.
    """
    return axis.feet(_middles(wood))


def _middles(wood: RenderPrimitive) -> Floats:
    """(n, 3) positions averaged with their neighbours, weighted by the inverse square of the distance."""
    place, faces = wood.positions_m, wood.faces
    if not len(faces):
        return place
    unit_m = SHORTEST * float(np.ptp(place, axis=0).max())
    _, first, same = np.unique(np.round(place / unit_m), axis=0, return_index=True, return_inverse=True)
    same = np.ravel(same)
    ends = same[np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])]
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    ends = ends[ends[:, 0] != ends[:, 1]]
    middle = place[first]
    squared = np.square(middle[ends[:, 0]] - middle[ends[:, 1]]).sum(axis=1)
    weight = 1.0 / np.maximum(squared, unit_m**2)
    both = np.concatenate([ends, ends[:, ::-1]])
    near = csr_matrix((np.tile(weight, 2), (both[:, 0], both[:, 1])), shape=(len(first), len(first)))
    total = np.asarray(near.sum(axis=1)).ravel()
    linked = total > 0
    for _ in range(ROUNDS):
        mean = np.asarray(near @ middle) / np.maximum(total, 1e-300)[:, None]
        middle = np.where(linked[:, None], 0.4 * middle + 0.6 * mean, middle)
    return middle[same]
