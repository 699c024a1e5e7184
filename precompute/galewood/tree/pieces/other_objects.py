"""Pieces that are not the tree: named objects and flat ground; `around_trunk` finds what is near the trunk.

All lengths are relative to the height of the scene. Each rule speaks with a weight in log odds, from which
the doubts about a piece are subtracted.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from galewood.formats import RawPart
from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.detection.shape import Shapes
from galewood.tree.pieces.detection.touching import groups
from galewood.tree.pieces.evidence import Mask, is_tube
from galewood.tree.pieces.names import named_kind, named_other
from galewood.util import Floats, Ints

TOUCH_HEIGHT_SHARE = 0.02  # of the scene's height: nearer pieces touch
GROUND_FLATNESS = 0.14  # height of ground, of its width
GROUND_HEIGHT_SHARE = 0.15  # ground lies below this share of the scene
MIN_GROUND_WIDTH_RATIO = 0.25  # least width of ground, of the scene's height
COVER_HEIGHT_SHARE, COVER_ODDS = 0.04, 0.8  # more weight for ground below this share of the scene
PLACE_ODDS = 3.0  # weight of a place and shape
NAME_ODDS = 1.5  # weight of a name, and of a height that agrees with it
ALPHA_DOUBT = 3.0  # ground and rocks are not cut out by alpha
UNSURE_ODDS = 0.5  # what makes up most of the leaves is left out with at most these
NAMED_HEIGHT_SHARE = 0.15  # ground, rocks and pots begin below this share of the scene


@dataclass
class Others:
    """Pieces that are not the tree: for each its kind of object and the reason.

    `doubt` (k,) ≥ 0 is what speaks for a part of the tree, whatever its place, and `odds` (k,) the log odds
    that a piece is not the tree, where it is marked.
    """

    doubt: Floats
    what: dict[int, tuple[str, str]] = field(default_factory=dict[int, tuple[str, str]])
    odds: Floats = field(init=False)
    doubt_at_first: Floats = field(init=False)  # before that of any trunk

    def __post_init__(self) -> None:
        self.odds, self.doubt_at_first = np.zeros(len(self.doubt)), self.doubt.copy()

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
    cover = s.high[:, 1] <= low + COVER_HEIGHT_SHARE * scene  # turf may be cut out by alpha
    if (rest & ~ground).any():
        weight = PLACE_ODDS + np.where(cover, COVER_ODDS, 0.0)
        others.mark(ground, "ground", "wide, flat and horizontal, at the bottom", weight)
