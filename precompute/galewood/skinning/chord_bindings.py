"""Holds of large pieces of foliage: along the branch that runs through them.

A vertex is held where its projection on the chord of the branch meets the branch, so that neighbouring
vertices are held at neighbouring places and the piece bends smoothly. Without wood inside it stays rigid.
"""

from __future__ import annotations

import numpy as np

from galewood.model.axis import Axis, Feet
from galewood.util import Floats, Ints

FEW_VERTICES = 8
"""A piece of fewer vertices, such as a card, cannot bend smoothly."""
CLOSED = 0.15
"""A piece that is not slender is held along a branch if it is larger than this, relative to the height."""
SLENDER = 0.35
"""Second over first extent of a piece that is long, such as a frond, and not a closed crown."""
BESIDE = 0.15
"""A branch runs along a long piece if it is nearer than this, relative to the size of the piece."""
LEAST_CHORD = 0.25
"""Shortest chord of a branch that bends a piece, relative to the size of the piece."""
OWN_CHORD = 1.3
"""Chord of a long piece's own branch relative to one that it only touches."""


def midrib_of(positions_m: Floats, child: int, axis: Axis, height_m: float) -> Feet | None:
    """The places that hold the vertices (v, 3) of a piece on the link to ``child``; None: a single place."""
    if len(np.unique(positions_m, axis=0)) < FEW_VERTICES:
        return None
    centred = positions_m - positions_m.mean(axis=0)
    _, extent, _ = np.linalg.svd(centred, full_matrices=False)
    size_m = float(np.linalg.norm(np.ptp(positions_m, axis=0)))
    slender = extent[1] < SLENDER * extent[0]
    if not slender and size_m < CLOSED * height_m:
        return None
    if not slender:
        return _held(positions_m, _line_through(axis, _within(positions_m, axis), None), axis, LEAST_CHORD)
    inside = _beside(positions_m, axis, BESIDE * size_m)
    touched, longest = (_line_through(axis, inside, start) for start in (child, None))
    if _is_own(axis, longest, touched, child, BESIDE * size_m):
        return _held(positions_m, longest, axis, LEAST_CHORD)
    return _held(positions_m, touched, axis, LEAST_CHORD)


def _is_own(axis: Axis, longest: Ints, touched: Ints, child: int, near_m: float) -> bool:
    """Whether a piece that touches ``child`` follows the longest line beside it, not that through ``child``.

    Where fronds grow, each touches the trunk and the ribs of its neighbours: the longer line that begins
    there is its own.
    """
    if not len(longest) or _chord(axis, longest) < OWN_CHORD * _chord(axis, touched):
        return False
    return float(np.linalg.norm(axis.points_m[longest] - axis.points_m[child], axis=1).min()) < near_m


def _chord(axis: Axis, line: Ints) -> float:
    return float(np.linalg.norm(axis.points_m[line[-1]] - axis.points_m[line[0]])) if len(line) else 0.0


def _held(positions_m: Floats, line: Ints, axis: Axis, least: float) -> Feet | None:
    """The places along a line (p,) of points; None: its chord is short, relative to the size of the piece."""
    if len(line) < 3:
        return None
    place = axis.points_m[line]
    chord = place[-1] - place[0]
    length = float(np.linalg.norm(chord))
    if length < least * float(np.linalg.norm(np.ptp(positions_m, axis=0))):
        return None
    return _projected(positions_m, line, place, chord / length, axis)


def _within(positions_m: Floats, axis: Axis) -> Ints:
    """(p,) whether points of the axis lie in the bounding box of a piece."""
    low, high = positions_m.min(axis=0), positions_m.max(axis=0)
    return ((axis.points_m >= low) & (axis.points_m <= high)).all(axis=1)


def _beside(positions_m: Floats, axis: Axis, near_m: float) -> Ints:
    from scipy.spatial import KDTree

    return KDTree(positions_m).query(axis.points_m)[0] < near_m


def _line_through(axis: Axis, inside: Ints, child: int | None) -> Ints:
    """Points of the longest line of links inside a piece, base first: through ``child`` if it is given."""
    reach = np.zeros(len(axis.points_m))  # length of the links inside, from the first of them
    for point in axis.links.tolist():
        up = int(axis.parent[point])
        if inside[point] and inside[up]:
            reach[point] = reach[up] + float(np.linalg.norm(axis.points_m[point] - axis.points_m[up]))
    allowed = inside if child is None else inside & _descends(axis, child)
    if not allowed.any():
        return np.zeros(0, np.int64)
    point = int(np.flatnonzero(allowed)[reach[allowed].argmax()])
    line = [point]
    while axis.parent[point] >= 0 and inside[axis.parent[point]]:
        point = int(axis.parent[point])
        line.append(point)
    return np.array(line[::-1], np.int64)


def _descends(axis: Axis, child: int) -> Ints:
    """(p,) whether a point is ``child`` or beyond it."""
    own = np.zeros(len(axis.points_m), bool)
    own[child] = True
    for point in axis.links.tolist():
        own[point] |= own[axis.parent[point]]
    return own


def _projected(positions_m: Floats, line: Ints, place: Floats, along: Floats, axis: Axis) -> Feet:
    """Vertices at the places of a line with the same coordinate along its chord."""
    mark = np.maximum.accumulate((place - place[0]) @ along)
    mark += np.linspace(0.0, 1e-9 * max(mark[-1], 1e-9), len(mark))  # strictly ascending
    wanted = np.clip((positions_m - place[0]) @ along, mark[0], mark[-1])
    link = np.clip(np.searchsorted(mark, wanted, side="right") - 1, 0, len(line) - 2)
    share = (wanted - mark[link]) / (mark[link + 1] - mark[link])
    start = place[link]
    at_m = start + share[:, None] * (place[link + 1] - start)
    return Feet(line[link + 1], share, at_m, np.zeros(len(positions_m)))
