"""Pieces that are not the tree, near the trunk: islands and pots under it, rocks, fences and grass beside it.

All lengths are relative to the height of the tree. Each rule speaks with a weight in log odds, from which the
doubts about a piece are subtracted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.detection.touching import groups
from galewood.tree.pieces.evidence import ALIKE_COLOUR_DISTANCE, Mask, is_sheet, is_tube
from galewood.tree.pieces.other_objects import TOUCH_HEIGHT_SHARE, Others, touching
from galewood.util import Floats, Ints

MIN_TREE_HEIGHT_SHARE = 0.5  # of the scene: what is lower is no tree with bark
BARK_DOUBT = 2.5  # of what has the material and the colour of the trunk
STANDING_HEIGHT_SHARE, MIN_POSTS = 0.02, 3  # at least so many posts of a fence stand on the ground
BESIDE_HEIGHT_SHARE = 0.1  # least distance of a fence or rock from the foot of the trunk


@dataclass(frozen=True)
class Trunk:
    """The trunk of a group of pieces."""

    piece: int
    foot: Floats  # (3,) centre of its lowest slab
    width: float  # of its foot
    height: float  # from its foot to the top of the group


def find_around(corners: Floats, piece: Ints, pieces: Pieces, score: Floats, others: Others) -> None:
    """Mark islands, pots, rocks, fences and grass around the trunk of every group of touching pieces."""
    scene = float(np.ptp(corners[:, :, 1]))
    for _ in range(2):  # what stood on an island is a group of its own once the island is found
        before = len(others.what)
        group = touching(corners, piece, others.left(len(pieces)))
        woody = group[(group >= 0) & is_tube(pieces.shapes) & (score > 0)]
        for number in np.unique(woody).tolist():  # others have no trunk, and may be many
            members = group == number
            trunk = find_trunk(corners, piece, pieces, score, members)
            if trunk is None:
                continue
            if trunk.height >= MIN_TREE_HEIGHT_SHARE * scene:
                _doubt_bark(pieces, trunk, others)
            _mark_below(pieces, score, members, trunk, others)
            _mark_pot(pieces, score, members & others.left(len(pieces)), trunk, others)
            _mark_beside(pieces, score, members & others.left(len(pieces)), trunk, others)
            _mark_grass(corners, piece, pieces, score, members & others.left(len(pieces)), trunk, others)
        if len(others.what) == before:
            break


def find_trunk(corners: Floats, piece: Ints, pieces: Pieces, score: Floats, members: Mask) -> Trunk | None:
    """The most likely trunk of some pieces: a tall, low tube; None if there is no tube."""
    s = pieces.shapes
    tall = s.high[:, 1] - s.low[:, 1]
    low, top = float(s.low[members, 1].min()), float(s.high[members, 1].max())
    fit = (
        members & is_tube(s) & (score > 0) & (tall >= 0.12 * (top - low)) & (s.thickness < 0.2 * (top - low))
    )
    if not fit.any():
        return None
    best = int(np.argmax(np.where(fit, 1.2 * tall - s.low[:, 1], -np.inf)))
    own = corners[piece == best].reshape(-1, 3)
    foot_y = float(s.low[best, 1])
    slab = own[own[:, 1] <= foot_y + 0.05 * float(tall[best])]
    foot = (slab.min(axis=0) + slab.max(axis=0)) / 2
    width = max(float(np.ptp(slab[:, [0, 2]], axis=0).max()), float(s.thickness[best]))
    return Trunk(best, np.array([foot[0], foot_y, foot[2]]), width, max(top - foot_y, 1e-300))


def _doubt_bark(pieces: Pieces, trunk: Trunk, others: Others) -> None:
    """What shares the colour of the trunk, and its surface or material, is hardly another object."""
    best = trunk.piece
    distance = np.linalg.norm(pieces.rgb - pieces.rgb[best], axis=1)
    material = pieces.part == pieces.part[best]
    if material.all():  # one for everything
        material[:] = False
    bark = material & (distance < ALIKE_COLOUR_DISTANCE)
    bark |= (pieces.body == pieces.body[best]) & (distance < 2 * ALIKE_COLOUR_DISTANCE)
    bark &= np.arange(len(pieces)) != best
    others.doubt[bark] = np.maximum(others.doubt[bark], others.doubt_at_first[bark] + BARK_DOUBT)


def _mark_below(pieces: Pieces, score: Floats, members: Mask, trunk: Trunk, others: Others) -> None:
    s, y, height = pieces.shapes, float(trunk.foot[1]), trunk.height
    width = (s.high - s.low)[:, [0, 2]].max(axis=1)
    tall = s.high[:, 1] - s.low[:, 1]
    under = members & (s.centre[:, 1] < y + 0.04 * height) & (s.high[:, 1] <= y + 0.2 * height)
    under &= (np.arange(len(pieces)) != trunk.piece) & ~is_tube(s)
    broad = width >= 2.2 * trunk.width
    others.mark(
        under & broad & (tall > 0.2 * width) & (width > 0.45 * height), "island", "a body under the trunk"
    )
    others.mark(under & broad & (tall <= 0.2 * width), "ground", "flat, under the foot of the trunk")


def _mark_pot(pieces: Pieces, score: Floats, members: Mask, trunk: Trunk, others: Others) -> None:
    s, y, height = pieces.shapes, float(trunk.foot[1]), trunk.height
    width = (s.high - s.low)[:, [0, 2]].max(axis=1)
    slack = 0.1 * trunk.width
    around = (s.low[:, [0, 2]] <= trunk.foot[[0, 2]] + slack) & (
        s.high[:, [0, 2]] >= trunk.foot[[0, 2]] - slack
    )
    there = members & around.all(axis=1) & (np.arange(len(pieces)) != trunk.piece)
    low = (s.low[:, 1] <= y + 0.03 * height) & (s.high[:, 1] <= y + 0.3 * height)
    distance = np.linalg.norm(pieces.rgb - pieces.rgb[trunk.piece], axis=1)
    same = (
        pieces.coloured
        & pieces.coloured[trunk.piece]
        & (distance < ALIKE_COLOUR_DISTANCE)
        & (width < 3 * trunk.width)
    )
    pot = (
        there
        & low
        & (width >= 1.6 * trunk.width)
        & ~same
        & ~(is_tube(s) & (s.extents[:, 0] > 3 * s.extents[:, 1]))
    )
    tall = s.high[:, 1] - s.low[:, 1]
    others.mark(pot & (tall > 0.2 * width), "pot", "a low body around the foot of the trunk")
    others.mark(pot & (tall <= 0.2 * width), "ground", "flat, around the foot of the trunk")


def _mark_beside(pieces: Pieces, score: Floats, members: Mask, trunk: Trunk, others: Others) -> None:
    s, y, height = pieces.shapes, float(trunk.foot[1]), trunk.height
    low = members & (s.low[:, 1] <= y + 0.06 * height) & (s.high[:, 1] <= y + 0.3 * height)
    low &= np.arange(len(pieces)) != trunk.piece
    apart = np.maximum(np.maximum(s.low - trunk.foot, trunk.foot - s.high), 0.0)[:, [0, 2]]
    beside = low & (np.hypot(*apart.T) > np.maximum(0.5 * trunk.width, 0.02 * height)) & ~is_sheet(s)
    solid = score > -1.4
    elongated = s.extents[:, 0] > 2.5 * s.extents[:, 1]
    compact = ~elongated & (s.extents[:, 2] > 0.2 * s.extents[:, 0])
    others.mark(beside & compact & (score > -2.6) & _not_leafy(pieces), "rock", "a low body beside the trunk")
    far = low & (np.hypot(*apart.T) > BESIDE_HEIGHT_SHARE * height) & solid & elongated
    stands = s.low[:, 1] <= y + STANDING_HEIGHT_SHARE * height  # branches that hang low do not
    posts = far & stands
    if int(posts.sum()) >= MIN_POSTS:
        others.mark(far, "fence", "one of several low bars away from the trunk")
    else:
        others.mark(posts, "object", "low, away from the trunk")


def _not_leafy(pieces: Pieces) -> Mask:
    """Pieces of unknown colour, or of one that is not green."""
    r, g, b = pieces.rgb.T
    return ~(pieces.coloured & (g > r * 1.03) & (g > b * 1.03))


def _mark_grass(
    corners: Floats, piece: Ints, pieces: Pieces, score: Floats, members: Mask, trunk: Trunk, others: Others
) -> None:
    s, y, height = pieces.shapes, float(trunk.foot[1]), trunk.height
    leafy = members & (score < 0) & (np.arange(len(pieces)) != trunk.piece)
    if not (leafy & (s.low[:, 1] <= y + 0.03 * height)).any():
        return
    rows = leafy[piece]
    group = groups(corners[rows], piece[rows], len(pieces), TOUCH_HEIGHT_SHARE * height)
    count = int(group.max(initial=-1)) + 1
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    np.minimum.at(low, group[leafy], s.low[leafy, 1])
    np.maximum.at(high, group[leafy], s.high[leafy, 1])
    short = (low <= y + 0.03 * height) & (high <= y + 0.16 * height)
    if not short.all():
        others.mark(leafy & short[np.maximum(group, 0)], "grass", "low foliage, apart from the crown")
