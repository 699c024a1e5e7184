"""Indicators of whether a tree stands upright: each looks at a mesh that is turned so that y would be up."""

from __future__ import annotations

import numpy as np

from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.evidence import MAX_TRUNK_THICKNESS_SHARE, is_tube
from galewood.util import Floats, Ints

BASE_SLAB = 0.04  # share of the height regarded as the base
FOOT_HEIGHT_SHARE = 0.1  # a trunk begins within this share of the height from the bottom
LOWER_HEIGHT_SHARES = (0.06, 0.12, 0.2)  # heights of the wood at which its thickness is compared
UPPER_HEIGHT_SHARES = (0.65, 0.78, 0.9)
FULL_THICKNESS_RATIO = 3.0  # ratio of the thicknesses that counts in full
GROUND_HEIGHT_SHARE = 0.12  # share of the height in which ground lies
GROUND_WIDTH_SHARE = 0.7  # ground is at least so wide, relative to everything
GROUND_COVERED_SHARE = 0.4  # least share of the plan that ground covers


def base(points: Floats) -> float:
    """Score of the hypothesis that the tree stands on its base; higher is more likely.

    It is high if much of the surface `points` (k, 3) lies in the lowest slab, that part is compact, and the
    tree is tall. The foot of a trunk has a large and compact surface; the tip of a twig is only compact, the
    side of a crown only large.
    """
    height = points[:, 1]
    low, extent = float(height.min()), float(np.ptp(height))
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    in_base = height <= low + BASE_SLAB * extent
    plan = points[:, [0, 2]][in_base]
    spread = float(np.sqrt(((plan - np.median(plan, axis=0)) ** 2).sum(axis=1).mean())) / diagonal
    return float(in_base.mean()) * extent / diagonal / (spread + 0.01) ** 2


def symmetry(points: Floats) -> float:
    """Ratio of the smaller to the larger spread in plan."""
    spread = np.linalg.eigvalsh(np.cov(points[:, [0, 2]].T))
    return float(np.sqrt(max(spread[0], 0.0) / max(spread[1], 1e-300)))


def trunk(corners: Floats, pieces: Pieces, score: Floats) -> float:
    """1 for a trunk that stands on the ground; less if it leans or is thinner there; 0: none."""
    s = pieces.shapes
    low, high = float(s.low[:, 1].min()), float(s.high[:, 1].max())
    tall = (s.high - s.low)[:, 1]
    extent = max(high - low, 1e-300)
    fit = is_tube(s) & (score > 0) & (s.low[:, 1] <= low + FOOT_HEIGHT_SHARE * extent) & (tall > 0.2 * extent)
    fit &= s.thickness < 0.25 * extent
    best = 0.0
    for k in np.argsort(-np.where(fit, tall, 0.0))[:3].tolist():
        if fit[k]:
            own = corners[np.concatenate(pieces.of_face) == k].reshape(-1, 3)
            lower = _width(own, float(s.low[k, 1]), 0.2 * float(tall[k]))
            upper = _width(own, float(s.low[k, 1] + 0.6 * tall[k]), 0.2 * float(tall[k]))
            standing = 1.0 if abs(float(s.axis[k, 1])) > 0.6 else 0.5
            best = max(best, standing * (1.0 if lower >= 0.95 * upper else 0.3))
    return best


def _width(points: Floats, start: float, span: float) -> float:
    """Spread in plan of the points of a slab."""
    inside = (points[:, 1] >= start) & (points[:, 1] <= start + span)
    if not inside.any():
        return 0.0
    return float(np.ptp(points[inside][:, [0, 2]], axis=0).max())


def taper(corners: Floats, pieces: Pieces, score: Floats) -> float:
    """1 for tubes of wood that are much thicker near the foot than near the top, −1 for the opposite.

    The thickness at a height is 4 A / P of the section there, the diameter of a round trunk; many branches
    are as thin as each of them.
    """
    piece = np.concatenate(pieces.of_face)
    s = pieces.shapes
    extent = float((s.high.max(axis=0) - s.low.min(axis=0)).max())
    rows = ((score > 0) & is_tube(s) & (s.thickness < MAX_TRUNK_THICKNESS_SHARE * extent))[piece]
    if not rows.any():
        return 0.0
    own, of = corners[rows], piece[rows]
    low, tall = float(own[:, :, 1].min()), float(np.ptp(own[:, :, 1]))
    lower, upper = (
        np.mean([section_thickness(own, of, low + share * tall) for share in shares])
        for shares in (LOWER_HEIGHT_SHARES, UPPER_HEIGHT_SHARES)
    )
    if not lower > 0 or not upper > 0:
        return 0.0
    return float(np.clip(np.log(lower / upper) / np.log(FULL_THICKNESS_RATIO), -1.0, 1.0))


def section_thickness(corners: Floats, piece: Ints, height: float) -> float:
    """4 A / P of the horizontal section of all faces (m, 3, 3); `piece` (m,) tells which close a surface."""
    above = corners[:, :, 1] > height
    cut = above.any(axis=1) & ~above.all(axis=1)
    if not cut.any():
        return 0.0
    face, over, of = corners[cut], above[cut], piece[cut]
    lone = np.argmax(over == (over.sum(axis=1) == 1)[:, None], axis=1)  # the corner on a side of its own
    row = np.arange(len(face))
    tip, left, right = (face[row, (lone + k) % 3] for k in range(3))
    first, second = (
        tip + ((height - tip[:, 1]) / (end[:, 1] - tip[:, 1]))[:, None] * (end - tip) for end in (left, right)
    )
    turn = np.where(over[row, lone], 1.0, -1.0)
    signed = turn * (first[:, 0] * second[:, 2] - first[:, 2] * second[:, 0]) / 2
    area = float(np.abs(np.bincount(of, signed)).sum())
    length = float(np.linalg.norm(second - first, axis=1).sum())
    return 4 * area / max(length, 1e-300)


def order(pieces: Pieces, score: Floats) -> float:
    """Height of what looks like leaves above what looks like wood, of the whole height; ±0.5."""
    s = pieces.shapes
    sheet = _flat_across(pieces)
    wood, leaf = (score > 0) & ~sheet, (score < 0) & ~sheet
    if not wood.any() or not leaf.any():
        return 0.0
    height = s.centre[:, 1]
    above = np.average(height[leaf], weights=s.area[leaf]) - np.average(height[wood], weights=s.area[wood])
    return float(np.clip(above / max(float(s.high[:, 1].max() - s.low[:, 1].min()), 1e-300), -0.5, 0.5))


def _flat_across(pieces: Pieces) -> np.ndarray:
    """Low pieces (k,) as wide as everything: ground, whatever its colour."""
    s = pieces.shapes
    size = s.high.max(axis=0) - s.low.min(axis=0)
    own = s.high - s.low
    return (own[:, 1] < GROUND_HEIGHT_SHARE * size[1]) & (
        own[:, [0, 2]] > GROUND_WIDTH_SHARE * size[[0, 2]]
    ).all(axis=1)


def ground(corners: Floats) -> float:
    """1 if wide flat ground lies at the bottom, else 0."""
    centre = corners.mean(axis=1)
    low, extent = float(corners[:, :, 1].min()), max(float(np.ptp(corners[:, :, 1])), 1e-300)
    there = corners[centre[:, 1] < low + GROUND_HEIGHT_SHARE * extent]
    normal = np.cross(there[:, 1] - there[:, 0], there[:, 2] - there[:, 0])
    width = np.ptp(corners.reshape(-1, 3), axis=0)[[0, 2]]
    return float(_level_ground(there, normal, width) or _rough_ground(there, normal, width))


def _level_ground(corners: Floats, normal: Floats, width: Floats) -> bool:
    """Most of the surface (m, 3, 3) is level, spreads over the plan, and not all of it faces down."""
    size = np.linalg.norm(normal, axis=1)
    level = np.abs(normal[:, 1]) > 0.6 * size
    flat, area = corners[level].reshape(-1, 3), float(size[level].sum())
    if not len(flat) or area < 0.6 * float(size.sum()):
        return False
    # the side of a crown faces outwards, ground faces the tree
    if float(size[level & (normal[:, 1] > 0)].sum()) < 0.4 * area:
        return False
    return _is_wide(flat, width) and area / 2 > GROUND_COVERED_SHARE * float(np.prod(width))


def _rough_ground(corners: Floats, normal: Floats, width: Floats) -> bool:
    """The surface faces the tree and covers the plan: Σ n a is the area inside its outline, however rough."""
    if not len(corners):
        return False
    return _is_wide(corners.reshape(-1, 3), width) and float(
        normal[:, 1].sum()
    ) / 2 > GROUND_COVERED_SHARE * float(np.prod(width))


def _is_wide(points: Floats, width: Floats) -> bool:
    return bool((np.ptp(points, axis=0)[[0, 2]] > GROUND_WIDTH_SHARE * width).all())
