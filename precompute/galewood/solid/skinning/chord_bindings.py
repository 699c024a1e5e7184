"""Bindings of large pieces of foliage along the branch that runs through them, by projection on its chord.

A vertex is bound where its projection on the chord of the branch meets the branch, so that neighbouring
vertices have neighbouring bindings and the piece bends smoothly. Without wood inside it stays rigid.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.skinning.axis import Axis
from galewood.solid.skinning.bindings import Bindings
from galewood.util import Floats, Ints

FEWEST_VERTICES = 8
"""A piece of fewer vertices, such as a card, cannot bend smoothly."""
LEAST_CROWN = 0.15
"""A piece that is not slender is bound along a branch if it is larger than this, relative to the height."""
SLENDER_EXTENT_RATIO = 0.35
"""Second over first extent of a piece that is long, such as a frond, and not a closed crown."""
BESIDE_DISTANCE = 0.15
"""A branch runs along a long piece if it is nearer than this, relative to the size of the piece."""
LEAST_CHORD = 0.25
"""Shortest chord of a branch that bends a piece, relative to the size of the piece."""
OWN_CHORD_RATIO = 1.3
"""Chord of a long piece's own branch relative to one that it only touches."""


def chord_bindings(positions_m: Floats, child: int, axis: Axis, height_m: float) -> Bindings | None:
    """Bindings of the vertices (v, 3) of a piece attached to the link to ``child``; None: it is rigid."""
    if len(np.unique(positions_m, axis=0)) < FEWEST_VERTICES:
        return None
    centred = positions_m - positions_m.mean(axis=0)
    _, extent, _ = np.linalg.svd(centred, full_matrices=False)
    size_m = float(np.linalg.norm(np.ptp(positions_m, axis=0)))
    slender = extent[1] < SLENDER_EXTENT_RATIO * extent[0]
    if not slender and size_m < LEAST_CROWN * height_m:
        return None
    if not slender:
        return _along(positions_m, _longest_line(axis, _within(positions_m, axis), None), axis)
    near_m = BESIDE_DISTANCE * size_m
    inside = _beside(positions_m, axis, near_m)
    touched, longest = (_longest_line(axis, inside, through) for through in (child, None))
    own = _is_own(axis, longest, touched, child, near_m)
    return _along(positions_m, longest if own else touched, axis)


def _is_own(axis: Axis, longest: Ints, touched: Ints, child: int, near_m: float) -> bool:
    """Whether a piece that touches ``child`` follows the longest line beside it, not that through ``child``.

    Where fronds grow, each touches the trunk and the ribs of its neighbours: the longer line that begins
    there is its own.
    """
    if not len(longest) or _chord_m(axis, longest) < OWN_CHORD_RATIO * _chord_m(axis, touched):
        return False
    return float(np.linalg.norm(axis.points_m[longest] - axis.points_m[child], axis=1).min()) < near_m


def _chord_m(axis: Axis, line: Ints) -> float:
    return float(np.linalg.norm(axis.points_m[line[-1]] - axis.points_m[line[0]])) if len(line) else 0.0


def _within(positions_m: Floats, axis: Axis) -> Ints:
    """(p,) whether points of the axis lie in the bounding box of a piece."""
    low, high = positions_m.min(axis=0), positions_m.max(axis=0)
    return ((axis.points_m >= low) & (axis.points_m <= high)).all(axis=1)


def _beside(positions_m: Floats, axis: Axis, near_m: float) -> Ints:
    """(p,) whether points of the axis are nearer than this to a vertex of a piece."""
    return KDTree(positions_m).query(axis.points_m)[0] < near_m


def _longest_line(axis: Axis, inside: Ints, through: int | None) -> Ints:
    """Points (p,) of the longest line of links inside a piece, base first; through a point, if given."""
    reach = np.zeros(len(axis.points_m))  # length of the links inside, from the first of them
    for point in axis.links.tolist():
        up = int(axis.parent[point])
        if inside[point] and inside[up]:
            reach[point] = reach[up] + float(np.linalg.norm(axis.points_m[point] - axis.points_m[up]))
    allowed = inside if through is None else inside & _descendants(axis, through)
    if not allowed.any():
        return np.zeros(0, np.int64)
    point = int(np.flatnonzero(allowed)[reach[allowed].argmax()])
    line = [point]
    while axis.parent[point] >= 0 and inside[axis.parent[point]]:
        point = int(axis.parent[point])
        line.append(point)
    return np.array(line[::-1], np.int64)


def _descendants(axis: Axis, ancestor: int) -> Ints:
    """(p,) whether a point is ``ancestor`` or beyond it."""
    own = np.zeros(len(axis.points_m), bool)
    own[ancestor] = True
    for point in axis.links.tolist():
        own[point] |= own[axis.parent[point]]
    return own


def _along(positions_m: Floats, line: Ints, axis: Axis) -> Bindings | None:
    """Bindings to the places of a line (p,) with the same coordinates along its chord.

    None: the chord is short, relative to the size of the piece.
    """
    if len(line) < 3:
        return None
    place = axis.points_m[line]
    chord = place[-1] - place[0]
    length = float(np.linalg.norm(chord))
    if length < LEAST_CHORD * float(np.linalg.norm(np.ptp(positions_m, axis=0))):
        return None
    along = chord / length
    mark = np.maximum.accumulate((place - place[0]) @ along)
    mark += np.linspace(0.0, 1e-9 * max(mark[-1], 1e-9), len(mark))  # strictly ascending
    wanted = np.clip((positions_m - place[0]) @ along, mark[0], mark[-1])
    link = np.clip(np.searchsorted(mark, wanted, side="right") - 1, 0, len(line) - 2)
    share = (wanted - mark[link]) / (mark[link + 1] - mark[link])
    start = place[link]
    at_m = start + share[:, None] * (place[link + 1] - start)
    return Bindings(line[link + 1], share, at_m, np.zeros(len(positions_m)))
