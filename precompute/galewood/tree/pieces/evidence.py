"""Evidence for wood (positive) and leaves (negative) in the shape, colour and position of every piece.

Each indicator adds a weight to a score, like a sum of log odds; the reason in the report lists the indicators
that decided. The weights are assumed, and tuned on generated files (docs/design/0021-pieces.md).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from galewood.tree.pieces.detection.colour import hue_saturation_value
from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.detection.shape import Shapes
from galewood.util import Floats

SURE_SCORE = 1.0
"""Score above which a piece is classified with confidence."""
WOOD_PRIOR_SCORE = 0.25  # an unknown solid is more often wood
GROUNDED_HEIGHT_SHARE = 0.03  # of the tree's height
TALL_HEIGHT_SHARE = 0.25  # of the tree's height
MAX_TRUNK_THICKNESS_SHARE = 0.2  # thickness, of the tree's height, above which nothing is a trunk
DETAILED_FACES = 2_000  # faces whose colours agree say more than those of a few
PATCH_HEIGHT_SHARE = 0.3  # largest patch of bark, of the trunk's height
MANY_PIECES = 24  # similar small pieces
ALIKE_COLOUR_DISTANCE = 0.12  # distance of colours that count as the same
STRIP_FLATNESS = 4.5  # flatness (see `_flatness`) above which a piece is a strip
MIN_STRIP_ANISOTROPY = 0.12  # difference of the two largest eigenvalues of a strip's normals; 0 for a tube
WIDE_CROWN_RATIO = 3.0  # width of a tier, of the trunk's thickness
MAX_FILLED_SHARE = 0.3  # volume of branches, of their box
MAX_GREY_VALUE = 0.62  # brighter grey is snow, or the background of a texture
Mask = np.ndarray


@dataclass
class Evidence:
    """Scores of k pieces, and the indicators behind them."""

    score: Floats
    indicators: list[tuple[Floats, str]] = field(default_factory=list[tuple[Floats, str]])

    def add(self, where: Mask, weight: float | Floats, words: str) -> None:
        """Add `weight` to the score of the pieces `where`."""
        added = np.where(where, weight, 0.0)
        self.score = self.score + added
        self.indicators.append((added, words))

    def reasons(self, wood: Mask) -> list[str]:
        """The strongest indicators of every piece for the kind it was given."""
        weights = np.stack([weight for weight, _ in self.indicators]) * np.where(wood, 1.0, -1.0)
        strongest = np.argsort(-weights, axis=0, kind="stable")[:3].T.tolist()
        none = ("not like wood", "a solid that is neither a card nor a crown")
        return [
            "; ".join(self.indicators[i][1] for i in rows if weights[i, k] > 0.2) or none[int(wood[k])]
            for k, rows in enumerate(strongest)
        ]


def is_sheet(s: Shapes) -> Mask:
    """Cards, crossed cards and modelled leaves: open surfaces, or double ones without a volume."""
    long, wide, thin = s.extents.T
    flat = (thin <= 0.15 * wide) & (_flatness(s) > STRIP_FLATNESS)  # not a bent tube
    coherent = s.coherence > 0.6
    hollow = (s.thickness < 0.03 * wide) & (s.open_border > 6.0) & (s.faces <= 64)
    return flat | coherent | hollow | (long <= 0)


def _flatness(s: Shapes) -> Floats:
    """Area relative to a round tube of the same thickness and length: 1 for a cylinder, 1.5 for a cone.

    It is large for strips, and for tubes with many branches.
    """
    return s.area / np.maximum(np.pi * s.thickness * s.extents[:, 0], 1e-300)


def is_flattened(s: Shapes) -> Mask:
    """Closed strips and lenses, such as thick fronds: no faces look along their width.

    The faces of a tube with many branches look equally in both directions across it, those of a strip do not.
    """
    across = s.normals[:, 0] - s.normals[:, 1]
    strip = (s.normals[:, 2] < 0.08) & (across > MIN_STRIP_ANISOTROPY) & (_flatness(s) > STRIP_FLATNESS)
    return ((s.normals[:, 0] > 0.66) | strip) & ~is_sheet(s) & (s.faces > 8)


def is_tube(s: Shapes) -> Mask:
    """Straight tubes, and bent or branching ones: thin for their length, with faces all around."""
    long, wide = s.extents[:, 0], s.extents[:, 1]
    round_section = s.thickness / np.maximum(wide, 1e-300)
    slender = long / np.maximum(wide, 1e-300)
    straight = (slender >= 1.7) & (round_section >= np.where(slender >= 3.0, 0.45, 0.55))
    branching = (s.thickness < 0.15 * long) & (s.normals[:, 0] < 0.6)
    branching &= (s.thickness > 0.003 * long) | (_flatness(s) < STRIP_FLATNESS)
    branching &= (s.coherence < 0.35) & (s.open_border < 40.0)
    filled = s.thickness * s.area / 4 / np.maximum(s.extents.prod(axis=1), 1e-300)  # share of its box
    branching &= (filled < MAX_FILLED_SHARE) | (wide < 0.4 * long)  # a crown of blocks is no branches
    return (straight & (s.normals[:, 0] < 0.7) | branching) & ~is_sheet(s) & ~is_flattened(s)


def is_round(s: Shapes) -> Mask:
    """Closed rounded volumes: balls, cones, clouds."""
    long, wide, thin = s.extents.T
    return (thin > 0.3 * long) & (s.thickness > 0.2 * wide) & (s.coherence < 0.5) & ~is_sheet(s)


def own_evidence(pieces: Pieces) -> Evidence:
    """Evidence that does not depend on other pieces: shape, alpha and colour."""
    found = Evidence(np.full(len(pieces), WOOD_PRIOR_SCORE))
    s = pieces.shapes
    sheet, tube, rounded = is_sheet(s), is_tube(s), is_round(s)
    found.add(sheet & (s.faces <= 8), -2.5, "flat cards")
    main = (s.area > 0.4 * s.area.sum()) & (s.faces >= 300)  # such as a scan of a tree with its ground
    found.add(sheet & (s.faces > 8) & ~main, -2.0, "a thin sheet")
    found.add(tube & ~rounded, 2.0, "a tube")
    found.add(rounded & ~tube, -1.6, "a rounded volume")
    found.add(is_flattened(s), -1.5, "flattened like a leaf")
    found.add(pieces.cut_out > 0.04, -2.5, "cut out by the alpha of its texture")
    _colour_evidence(found, pieces)
    return found


def _colour_evidence(found: Evidence, pieces: Pieces) -> None:
    hue, saturation, value = hue_saturation_value(pieces.rgb)
    known = pieces.coloured
    green = is_green(pieces)
    detailed = np.where(pieces.shapes.faces >= DETAILED_FACES, 1.4, 1.0)  # a scan: its shape is rough
    found.add(green, -2.5 * detailed * np.clip((saturation - 0.1) / 0.2, 0.3, 1.0), "green")
    warm = known & (hue >= 8) & (hue <= 48)
    vivid = known & (saturation > 0.6) & (value > 0.6) & ((hue < 62) | (hue > 330))
    brown = warm & (saturation > 0.12) & (value < 0.72) & ~vivid
    found.add(brown, np.where(value < 0.55, 1.6, 1.3), "brown")
    found.add(vivid, -1.3, "bright as autumn leaves")
    found.add(known & (hue > 48) & (hue <= 62) & (saturation > 0.35) & ~vivid, -1.0, "yellow-green")
    pink = known & ((hue > 290) | (hue < 8)) & (saturation > 0.2) & ~vivid
    found.add(pink & (value > 0.45), -1.2, "coloured like blossoms")
    found.add(pink & (value <= 0.45), 0.5, "dark reddish brown")
    found.add(known & (saturation <= 0.12) & (value < MAX_GREY_VALUE), 0.5, "grey")
    found.add(known & (hue >= 170) & (hue <= 290) & (saturation > 0.2), -0.6, "coloured unlike bark")


def add_position(found: Evidence, pieces: Pieces, members: Mask) -> None:
    """Add what the place of the pieces `members`, which are one tree (y up), says."""
    s = pieces.shapes
    ground, top = float(s.low[members, 1].min()), float(s.high[members, 1].max())
    height = max(top - ground, 1e-300)
    rounded, sheet = is_round(s), is_sheet(s)
    grounded = members & (s.low[:, 1] <= ground + GROUNDED_HEIGHT_SHARE * height)
    tall = s.high[:, 1] - s.low[:, 1] >= TALL_HEIGHT_SHARE * height
    stout = s.thickness > MAX_TRUNK_THICKNESS_SHARE * height
    width = np.maximum(np.ptp(np.stack([s.low, s.high]), axis=0)[:, [0, 2]].max(axis=1), 1e-300)
    narrow = (s.thickness < 0.3 * width) | (width < 0.3 * height)
    trunk = grounded & tall & ~sheet & ~stout & narrow
    found.add(trunk, 2.5, "tall, standing on the ground")
    found.add(members & stout & is_tube(s), -2.5, "too thick for a trunk")
    above = members & ~grounded & (s.centre[:, 1] > ground + 0.4 * height)
    found.add(above & rounded, -0.8, "in the crown")
    small = members & (s.area < 0.01 * height**2) & ~is_tube(s)
    if int(small.sum()) >= MANY_PIECES:
        found.add(small, -0.8, f"one of {int(small.sum())} similar small pieces")
    foot = (
        members
        & (s.low[:, 1] <= ground + GROUNDED_HEIGHT_SHARE * height)
        & (s.high[:, 1] - s.low[:, 1] >= 0.08 * height)
    )
    below = s.high[:, 1] < ground + 0.5 * height
    spread = (s.high[members].max(axis=0) - s.low[members].min(axis=0))[[0, 2]].max()
    found.add(foot & below & ~tall & ~sheet & (width < 0.4 * spread), 1.5, "standing on the ground")
    _compare_with_trunk(found, pieces, members, trunk)


def _compare_with_trunk(found: Evidence, pieces: Pieces, members: Mask, trunk: Mask) -> None:
    """Other pieces of the trunk's colour are more likely wood, others less, as is what is around the trunk
    and much wider."""
    s = pieces.shapes
    sure = trunk & (found.score > SURE_SCORE)
    if not sure.any():
        return
    best = int(np.argmax(np.where(sure, s.high[:, 1] - s.low[:, 1], -1.0)))
    found.add(members & _around_trunk(s, best), -1.5, "around the trunk, much wider")
    if not pieces.coloured[best]:
        return
    distance = np.linalg.norm(pieces.rgb - pieces.rgb[best], axis=1)
    others = members & pieces.coloured & (np.arange(len(pieces)) != best)
    alike = others & (distance < ALIKE_COLOUR_DISTANCE)
    found.add(alike, 0.8, "coloured like the trunk")
    found.add(others & (distance > 2 * ALIKE_COLOUR_DISTANCE), -0.6, "coloured unlike the trunk")
    _, saturation, _ = hue_saturation_value(pieces.rgb)
    if bool(is_green(pieces)[best]):  # such as a cactus: green says nothing
        limb = ~is_sheet(s) & ~is_flattened(s) & ~is_round(s) & (s.thickness > 0.25 * s.thickness[best])
        found.add(alike & limb, 2.5, "a green limb like the trunk")
    small = s.extents[:, 0] < PATCH_HEIGHT_SHARE * float(s.high[best, 1] - s.low[best, 1])
    dull = ~is_green(pieces) & (saturation < 0.3) & (pieces.cut_out < 0.04)
    found.add(others & small & dull & _on_trunk(s, best), 4.0, "a patch of the bark")


def _around_trunk(s: Shapes, trunk: int) -> Mask:
    """Bodies whose boxes surround the axis of a trunk above its foot and are much wider: tiers, crowns."""
    axis, plan = s.centre[trunk, [0, 2]], [0, 2]
    inside = ((s.low[:, plan] < axis) & (s.high[:, plan] > axis)).all(axis=1)
    narrow = (s.high - s.low)[:, plan].min(axis=1)
    above = s.low[:, 1] > s.low[trunk, 1] + 0.1 * (s.high[trunk, 1] - s.low[trunk, 1])
    return inside & above & (narrow > WIDE_CROWN_RATIO * s.thickness[trunk]) & ~is_tube(s)


def _on_trunk(s: Shapes, trunk: int) -> Mask:
    """Pieces whose boxes lie within that of a trunk, or hardly beyond it."""
    slack = 0.15 * s.thickness[trunk]
    return ((s.low >= s.low[trunk] - slack) & (s.high <= s.high[trunk] + slack)).all(axis=1)


def is_green(pieces: Pieces) -> Mask:
    """Pieces of a green colour."""
    hue, saturation, _ = hue_saturation_value(pieces.rgb)
    return pieces.coloured & (hue > 62) & (hue < 170) & (saturation > 0.12)
