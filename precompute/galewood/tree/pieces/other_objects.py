"""Pieces that are not the tree: ground, islands, pots, rocks, fences, grass.

All lengths are relative to the height of the tree or the scene. The rules look at pieces in this order: named
objects, flat ground, what lies under or around the foot of the trunk, low things beside it. Each rule speaks
with a weight in log odds, from which the doubts about a piece are subtracted.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from galewood.formats import RawPart
from galewood.tree.pieces.evidence import ALIKE_COLOUR_DISTANCE, Mask, is_sheet, is_tube
from galewood.tree.pieces.names import named_kind, named_other
from galewood.tree.pieces.pieces import Pieces
from galewood.tree.pieces.shape import Shapes
from galewood.tree.pieces.touching import groups
from galewood.util import Floats, Ints

TOUCH_HEIGHT_SHARE = 0.02  # of the scene's height: nearer pieces touch
GROUND_FLATNESS = 0.14  # height of ground, of its width
GROUND_HEIGHT_SHARE = 0.15  # ground lies below this share of the scene
MIN_GROUND_WIDTH_RATIO = 0.25  # least width of ground, of the scene's height
PLACE_ODDS = 3.0  # weight of a place and shape
NAME_ODDS = 1.5  # weight of a name, and of a height that agrees with it
ALPHA_DOUBT = 3.0  # ground and rocks are not cut out by alpha
UNSURE_ODDS = 0.5  # what makes up most of the leaves is left out with at most these
NAMED_HEIGHT_SHARE = 0.15  # ground, rocks and pots begin below this share of the scene
STANDING_HEIGHT_SHARE, MIN_POSTS = 0.02, 3  # at least so many posts of a fence stand on the ground
BESIDE_HEIGHT_SHARE = 0.1  # least distance of a fence or rock from the foot of the trunk


@dataclass
class Others:
    """Pieces that are not the tree: for each its kind of object and the reason.

    `doubt` (k,) ≥ 0 is what speaks for a part of the tree, whatever its place, and `odds` (k,) the log odds
    that a piece is not the tree, where it is marked.
    """

    doubt: Floats
    what: dict[int, tuple[str, str]] = field(default_factory=dict[int, tuple[str, str]])
    odds: Floats = field(init=False)

    def __post_init__(self) -> None:
        self.odds = np.zeros(len(self.doubt))

    def mark(self, where: Mask, what: str, reason: str, weight: float | Floats = PLACE_ODDS) -> None:
        """Name the pieces `where` that are more likely no part of the tree, unless they are named already."""
        odds = np.broadcast_to(weight, self.doubt.shape) - self.doubt
        for k in np.flatnonzero(where & (odds > 0)).tolist():
            if k not in self.what:
                self.what[k], self.odds[k] = (what, reason), odds[k]

    def left(self, count: int) -> Mask:
        """The pieces that are not named."""
        rest = np.ones(count, dtype=bool)
        rest[list(self.what)] = False
        return rest

    def doubt_lost_leaves(self, pieces: Pieces, score: Floats) -> None:
        """What is left out is unsure if it makes up most of what looks like leaves, but for flat ground."""
        s = pieces.shapes
        leafy = (score < -1.0) & ~is_level(s)
        lost = leafy & ~self.left(len(pieces))
        if s.area[lost].sum() > 0.5 * s.area[leafy].sum():
            self.odds[lost] = np.minimum(self.odds[lost], UNSURE_ODDS)


def doubts(pieces: Pieces, hints: Floats) -> Floats:
    """What speaks against leaving pieces out (k,): alpha that cuts leaves out, and `hints` (k,) of names."""
    return np.where(pieces.cut_out > 0.04, ALPHA_DOUBT, 0.0) + np.abs(hints)


def is_level(s: Shapes) -> Mask:
    """Wide, flat, horizontal pieces."""
    size = s.high - s.low
    wide, narrow = size[:, [0, 2]].max(axis=1), size[:, [0, 2]].min(axis=1)
    return (size[:, 1] <= GROUND_FLATNESS * wide) & (s.along_axes[:, 1] > 0.5) & (narrow > 0.25 * wide)


@dataclass(frozen=True)
class Trunk:
    """The trunk of a group of pieces."""

    piece: int
    foot: Floats  # (3,) centre of its lowest slab
    width: float  # of its foot
    height: float  # from its foot to the top of the group


def joined_faces(parts: list[RawPart], pieces: Pieces) -> tuple[Floats, Ints]:
    """Corners (m, 3, 3) of all faces, and their pieces (m,)."""
    return np.concatenate([p.positions[p.faces] for p in parts]), np.concatenate(pieces.of_face)


def touching(corners: Floats, piece: Ints, members: Mask) -> Ints:
    """Groups (k,) of touching pieces among `members`; −1 for all others."""
    rows = members[piece]
    if not rows.any():
        return np.full(len(members), -1, dtype=np.int32)
    chosen = corners[rows]
    height = float(np.ptp(chosen[:, :, 1]))
    return groups(chosen, piece[rows], len(members), TOUCH_HEIGHT_SHARE * (height or 1.0))


def find_named(parts: list[RawPart], pieces: Pieces, score: Floats, others: Others) -> None:
    """Mark what a name says is another object, if its height and shape agree and it is no trunk.

    Ground is low and level, other objects begin low; only what may be anywhere, such as a lamp, is believed.
    """
    s = pieces.shapes
    bottom, scene = float(s.low[:, 1].min()), max(float(np.ptp(np.stack([s.low, s.high])[:, :, 1])), 1e-300)
    low = s.low[:, 1] <= bottom + NAMED_HEIGHT_SHARE * scene
    for number, part in enumerate(parts):
        if any(named_kind(label) for label in part.labels):
            continue
        label = next((one for one in part.labels if named_other(one)), None)
        rows = pieces.part == number
        if label is None or rows.all():
            continue
        what = named_other(label) or ""
        agrees = low & is_level(s) if what == "ground" else low | (what == "object")
        weight = NAME_ODDS + np.where(agrees, NAME_ODDS, -NAME_ODDS)
        others.mark(rows & ~(is_tube(s) & (score > 0)), what, f"its name {label!r}", weight)
    if not others.left(len(pieces)).any():
        others.what.clear()


def find_ground(pieces: Pieces, score: Floats, others: Others) -> None:
    """Mark wide, flat, horizontal pieces at the bottom."""
    s, rest = pieces.shapes, others.left(len(pieces))
    low, high = float(s.low[rest, 1].min()), float(s.high[rest, 1].max())
    scene = max(high - low, 1e-300)
    width = (s.high - s.low)[:, [0, 2]].max(axis=1)
    ground = (
        rest
        & is_level(s)
        & (s.high[:, 1] <= low + GROUND_HEIGHT_SHARE * scene)
        & (width >= MIN_GROUND_WIDTH_RATIO * scene)
    )
    if (rest & ~ground).any():
        others.mark(ground, "ground", "wide, flat and horizontal, at the bottom")


def find_around(corners: Floats, piece: Ints, pieces: Pieces, score: Floats, others: Others) -> None:
    """Mark islands, pots, rocks, fences and grass around the trunk of every group of touching pieces."""
    for _ in range(2):  # what stood on an island is a group of its own once the island is found
        before = len(others.what)
        group = touching(corners, piece, others.left(len(pieces)))
        woody = group[(group >= 0) & is_tube(pieces.shapes) & (score > 0)]
        for number in np.unique(woody).tolist():  # others have no trunk, and may be many
            members = group == number
            trunk = find_trunk(corners, piece, pieces, score, members)
            if trunk is None:
                continue
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
