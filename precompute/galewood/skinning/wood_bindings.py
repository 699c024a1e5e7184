"""Places on the axis that hold the bark."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from galewood.mesh import RenderPrimitive
from galewood.model.axis import Axis, Feet, chosen
from galewood.model.eased import eased
from galewood.util import Floats, Ints

ROUNDS = 4
SHORTEST = 1e-5
"""Relative to the extent; vertices nearer than this are one."""


def bark_feet(wood: RenderPrimitive, axis: Axis) -> Feet:
    """The place of every vertex (n,) of a wood primitive.

    Sought from the middle of the ring around the vertex, so that a ring is held at one place: where the axis
    does not run through the middle of a thin branch, its vertices would be held far from each other.
    """
    if not len(wood.faces):
        return axis.feet(wood.positions_m)
    welded = welded_wood(wood)
    feet = eased(axis.feet(_middles(welded)), welded.place_m, welded.ends, axis)
    return chosen(feet, welded.same)


@dataclass(frozen=True)
class WeldedWood:
    """Vertices that are one: place_m (w, 3), the ``first`` (w,) vertex of each, and which of them
    each vertex is, ``same`` (n,).

    ``ends`` (e, 2) are the edges, ``squared`` (e,) the squares of their lengths, at least of ``unit_m``.
    """

    place_m: Floats
    first: Ints
    same: Ints
    ends: Ints
    squared: Floats


def welded_wood(wood: RenderPrimitive) -> WeldedWood:
    """The vertices of a wood primitive, each once."""
    place, faces = wood.positions_m, wood.faces
    unit_m = SHORTEST * float(np.ptp(place, axis=0).max())
    _, first, same = np.unique(np.round(place / unit_m), axis=0, return_index=True, return_inverse=True)
    same = np.ravel(same)
    ends = same[np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])]
    ends = np.unique(np.sort(ends, axis=1), axis=0)
    ends = ends[ends[:, 0] != ends[:, 1]]
    squared = np.square(place[first][ends[:, 0]] - place[first][ends[:, 1]]).sum(axis=1)
    return WeldedWood(place[first], first, same, ends, np.maximum(squared, unit_m**2))


def _middles(wood: WeldedWood) -> Floats:
    """(w, 3) positions averaged with their neighbours, weighted by the inverse square of the distance."""
    middle, count = wood.place_m, len(wood.place_m)
    both = np.concatenate([wood.ends, wood.ends[:, ::-1]])
    near = csr_matrix((np.tile(1.0 / wood.squared, 2), (both[:, 0], both[:, 1])), shape=(count, count))
    total = np.asarray(near.sum(axis=1)).ravel()
    linked = total > 0
    for _ in range(ROUNDS):
        mean = np.asarray(near @ middle) / np.maximum(total, 1e-300)[:, None]
        middle = np.where(linked[:, None], 0.4 * middle + 0.6 * mean, middle)
    return middle
