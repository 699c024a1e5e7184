"""Several trees in one file: groups of touching pieces, and trunks that stand apart within one group.

Pieces that float above the ground belong to the tree below them: spaced tiers of a conifer are one tree.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.evidence import Mask, is_tube
from galewood.tree.pieces.other_objects import Others, touching
from galewood.util import Floats, Ints

FLOATING_HEIGHT_SHARE = 0.1  # of the scene's height above the ground
MIN_TREE_HEIGHT_SHARE = 0.3  # height of a tree, of the tallest
MIN_FOLIAGE_SHARE = 0.15  # least share of foliage in the area of a tree; bare trees must be TALL_BARE
TALL_BARE = 0.5
MIN_TRUNK_THICKNESS_RATIO = 0.33  # least thickness of a trunk, of the thickest: limbs that hang low are none
MIN_TRUNK_DISTANCE_RATIO = 0.35  # least distance of the trunks of two trees, of their height


@dataclass(frozen=True)
class FoundTree:
    """One tree of a file, in the file's unit: its box, and its number of faces."""

    low: Floats
    high: Floats
    faces: int


def find_trees(
    corners: Floats, piece: Ints, pieces: Pieces, score: Floats, others: Others
) -> tuple[Ints, list[FoundTree]]:
    """Number (k,) of each piece's tree, from 1, the largest first; 0: none. Marks what is no tree."""
    count = len(pieces)
    group = touching(corners, piece, others.left(count))
    s = pieces.shapes
    number = int(group.max(initial=-1)) + 1
    inside = group >= 0
    low, high = np.full((number, 3), np.inf), np.full((number, 3), -np.inf)
    np.minimum.at(low, group[inside], s.low[inside])
    np.maximum.at(high, group[inside], s.high[inside])
    grounded, tree = _judged(pieces, score, group, low, high)
    for k in np.flatnonzero(grounded & ~tree).tolist():
        others.mark(group == k, _object_name(pieces, score, group == k), "on the ground, apart from the tree")
    home = _homes(low, high, grounded, tree)
    member = np.where(inside, home[np.maximum(group, 0)], -1)
    member[~others.left(count)] = -1
    member = _by_trunk(corners, piece, pieces, score, member)
    return _numbered(pieces, member)


def _judged(pieces: Pieces, score: Floats, group: Ints, low: Floats, high: Floats) -> tuple[Mask, Mask]:
    """Which groups stand on the ground, and which are trees."""
    s, number = pieces.shapes, len(low)
    inside = group >= 0
    tall = high[:, 1] - low[:, 1]
    area = np.bincount(group[inside], s.area[inside], number)
    leaves = np.bincount(group[inside], np.where(score < 0, s.area, 0.0)[inside], number)
    straight = s.extents[:, 1] < 0.35 * s.extents[:, 0]
    branched = np.bincount(group[inside], (is_tube(s) & ~straight)[inside], number) > 0
    sloping = np.abs(s.axis[:, 1]) < 0.9
    branched |= np.bincount(group[inside], (is_tube(s) & sloping)[inside], number) > 1
    floor, reference = float(low[:, 1].min()), float(high[:, 1].max() - low[:, 1].min())
    grounded = low[:, 1] <= floor + FLOATING_HEIGHT_SHARE * reference
    main = int(np.argmax(np.where(grounded, area * tall**2, -1.0)))
    reference = float(tall[main])
    leafy = leaves > MIN_FOLIAGE_SHARE * area
    woody = np.bincount(group[inside], ((score > 0) & is_tube(s))[inside], number) > 0
    tree = (
        grounded
        & (tall >= MIN_TREE_HEIGHT_SHARE * reference)
        & (leafy & woody | branched & (tall >= TALL_BARE * reference))
    )
    tree[main] = True
    grounded[main] = True
    return grounded, tree


def _object_name(pieces: Pieces, score: Floats, members: Mask) -> str:
    s = pieces.shapes
    bars = members & (s.extents[:, 0] > 2.5 * s.extents[:, 1]) & (score > -1.5)
    if int(bars.sum()) >= 3:
        return "fence"
    area = float(s.area[members].sum())
    if float(s.area[members & (score < 0) & (pieces.rgb[:, 1] > pieces.rgb[:, 0])].sum()) > 0.5 * area:
        return "undergrowth"
    compact = members & (s.extents[:, 2] > 0.2 * s.extents[:, 0])
    return "rock" if float(s.area[compact].sum()) > 0.5 * area else "object"


def _homes(low: Floats, high: Floats, grounded: Mask, tree: Mask) -> Ints:
    """The tree (a group) to which each group belongs: floating ones to the nearest tree, by their boxes."""
    home = np.where(tree, np.arange(len(low)), -1).astype(np.int32)
    trees = np.flatnonzero(tree)
    middle = (low + high)[:, [0, 2]] / 2
    for k in np.flatnonzero(~grounded).tolist():
        apart = np.maximum(np.maximum(low[trees] - high[k], low[k] - high[trees]), 0.0)
        sideways = np.linalg.norm(middle[trees] - middle[k], axis=1)
        home[k] = trees[int(np.argmin(np.hypot(apart[:, 0], apart[:, 2]) + 0.05 * sideways))]
    return home


def _by_trunk(corners: Floats, piece: Ints, pieces: Pieces, score: Floats, member: Ints) -> Ints:
    """Divide trees whose trunks stand apart and each carry foliage; pieces go to the nearest trunk."""
    s = pieces.shapes
    result = member.copy()
    fresh = int(member.max(initial=-1)) + 1
    for tree in np.unique(member[member >= 0]).tolist():
        own = member == tree
        low, top = float(s.low[own, 1].min()), float(s.high[own, 1].max())
        tall = s.high[:, 1] - s.low[:, 1]
        fit = own & is_tube(s) & (score > 0) & (s.low[:, 1] <= low + 0.08 * (top - low))
        fit &= (tall >= 0.2 * (top - low)) & (s.thickness < 0.2 * (top - low))
        fit &= s.thickness > MIN_TRUNK_THICKNESS_RATIO * np.where(fit, s.thickness, 0.0).max()
        candidates = np.flatnonzero(fit)
        if len(candidates) < 2:
            continue
        feet = {k: _foot(corners[piece == k].reshape(-1, 3)) for k in candidates.tolist()}
        trunks = _apart(feet, tall, MIN_TRUNK_DISTANCE_RATIO)
        if len(trunks) < 2:
            continue
        place = np.array([feet[k] for k in trunks])
        nearest = np.argmin(np.linalg.norm(s.centre[:, None, [0, 2]] - place[None], axis=2), axis=1)
        leaves = np.bincount(nearest[own], np.where(score < 0, s.area, 0.0)[own], len(trunks))
        if not (leaves > 0.25 * leaves.sum() / len(trunks)).all() or not leaves.sum() > 0:
            continue
        for k in range(1, len(trunks)):
            result[own & (nearest == k)] = fresh
            fresh += 1
    return result


def _foot(points: Floats) -> Floats:
    """Where a trunk stands, (2,): the middle of its lowest tenth."""
    low, high = float(points[:, 1].min()), float(points[:, 1].max())
    slab = points[points[:, 1] <= low + 0.1 * (high - low)][:, [0, 2]]
    return (slab.min(axis=0) + slab.max(axis=0)) / 2


def _apart(feet: dict[int, Floats], tall: Floats, share: float) -> list[int]:
    """The tallest trunks whose feet are farther apart than a share of their height."""
    chosen: list[int] = []
    for k in sorted(feet, key=lambda one: -float(tall[one])):
        if all(np.linalg.norm(feet[k] - feet[c]) > share * max(tall[k], tall[c]) for c in chosen):
            chosen.append(k)
    return chosen


def _numbered(pieces: Pieces, member: Ints) -> tuple[Ints, list[FoundTree]]:
    s = pieces.shapes
    found: list[tuple[float, int, FoundTree]] = []
    for tree in np.unique(member[member >= 0]).tolist():
        own = member == tree
        low, high = s.low[own].min(axis=0), s.high[own].max(axis=0)
        found.append((float(high[1] - low[1]), tree, FoundTree(low, high, int(s.faces[own].sum()))))
    found.sort(key=lambda one: (-one[0], one[1]))
    number = np.zeros(len(pieces), dtype=np.int32)
    for position, (_, tree, _) in enumerate(found):
        number[member == tree] = position + 1
    return number, [tree for _, _, tree in found]
