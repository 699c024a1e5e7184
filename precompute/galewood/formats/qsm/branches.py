"""Branches from cylinders: which cylinders continue each other, and the smooth line through each branch."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.constants import BREAST_HEIGHT_M
from galewood.formats.qsm.cylinders import NO_CYLINDER, Cylinders, foot_on
from galewood.util import Floats, Int64s

TRUNK_PARENT = -1
SHORTEST_M = 1e-3
WIDEST_BRANCH = 1.5
"""Largest radius of a branch relative to its parent limb; at its base it is no wider than the limb."""
SMOOTHING_SHARE = 0.1
"""Share of the way to the middle of its neighbours by which an inner point of a line is moved."""
LEAST_OF_THICKEST = 0.5
"""Least radius of an extension, relative to the thickest child of the same cylinder."""


@dataclass(frozen=True)
class Branch:
    """A chain of cylinders (k,), from its base outwards, and the number of its parent branch (−1: none)."""

    cylinders: Int64s
    parent: int


@dataclass(frozen=True)
class Line:
    """The line through a branch: points_m (k, 3) from the axis of its parent outwards, radius_m (k,)."""

    points_m: Floats
    radius_m: Floats

    def nearest(self, place: Floats) -> tuple[Floats, float]:
        """The point (3,) of the line nearest to a place (3,), and the radius there, m."""
        start, end = self.points_m[:-1], self.points_m[1:]
        foot = foot_on(start, end, np.broadcast_to(place, start.shape))
        at = int(np.argmin(np.linalg.norm(foot - place, axis=1)))
        share = float(np.linalg.norm(foot[at] - start[at]) / max(np.linalg.norm(end[at] - start[at]), 1e-300))
        return foot[at], float((1 - share) * self.radius_m[at] + share * self.radius_m[at + 1])


def chained(tree: Cylinders) -> list[Branch]:
    """The branches of a tree, the trunk first and every branch after its parent.

    A cylinder is continued by its extension, or else (also if that is thin) by the thickest child that turns
    the least.
    """
    order = np.argsort(tree.parent, kind="stable")
    bounds = np.searchsorted(tree.parent[order], np.arange(len(order) + 1))
    direction = (tree.end_m - tree.start_m) / np.maximum(tree.length_m, 1e-12)[:, None]
    waiting = [(int(np.flatnonzero(tree.parent == NO_CYLINDER)[0]), TRUNK_PARENT)]
    found: list[Branch] = []
    for first, parent in waiting:  # grows while it is read
        chain = [first]
        while True:
            last = chain[-1]
            children = order[bounds[last] : bounds[last + 1]]
            if not len(children):
                break
            following = int(tree.extension[last])
            thickest = float(tree.radius_m[children].max())
            if following == NO_CYLINDER or tree.radius_m[following] < LEAST_OF_THICKEST * thickest:
                turn = direction[children] @ direction[last]
                following = int(children[np.argmax(tree.radius_m[children] ** 2 * (1.001 + turn))])
            waiting += [(int(child), len(found)) for child in children if child != following]
            chain.append(following)
        found.append(Branch(np.array(chain, np.int64), parent))
    return found


def branch_lines(tree: Cylinders, branches: list[Branch], spacing: float) -> list[Line]:
    """The line through every branch; cylinders shorter than ``spacing`` radii are merged."""
    lines: list[Line] = []
    for branch in branches:
        limb = lines[branch.parent] if branch.parent != TRUNK_PARENT else None
        lines.append(_line(tree, branch.cylinders, limb, spacing))
    return lines


def smoothed_radii(tree: Cylinders, own: Int64s) -> Floats:
    """(k,) radii of a chain of cylinders, non-increasing outwards, of the same volume."""
    return np.sqrt(_tapering(tree.radius_m[own] ** 2, tree.length_m[own]))


def diameter_at_breast_height(tree: Cylinders, trunk: Branch) -> float | None:
    """Diameter of the trunk 1.3 m above its base, m; None if it is lower."""
    own = trunk.cylinders
    above = tree.end_m[own, 2] - tree.start_m[own[0], 2]
    reaching = np.flatnonzero(above >= BREAST_HEIGHT_M)
    return float(2 * tree.radius_m[own[reaching[0]]]) if len(reaching) else None


def _tapering(area: Floats, weight: Floats) -> Floats:
    """Non-increasing areas (k,), of the same sum of area times weight, that differ least from those given."""
    from scipy.optimize import isotonic_regression  # slow to load, and few files are scans

    result = isotonic_regression(area, weights=np.maximum(weight, 1e-9), increasing=False)
    return np.asarray(result.x, dtype=np.float64)


def _line(tree: Cylinders, own: Int64s, limb: Line | None, spacing: float) -> Line:
    points = _joints(tree, own)
    area = tree.radius_m[own] ** 2
    limb_radius = np.inf
    if limb is not None:
        foot, limb_radius = limb.nearest(points[0])
        points, area = np.vstack([foot, points]), np.append(area[0], area)
    length = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if length.sum() < SHORTEST_M:
        radius = min(float(np.sqrt(area.max())), limb_radius)
        return Line(points[0] + np.array([[0, 0, 0], [0, 0, radius]]), np.full(2, radius))
    last = _groups(length, np.sqrt(area), spacing)
    first = np.append(0, last[:-1] + 1)
    span = np.add.reduceat(length, first)
    mean = np.add.reduceat(area * length, first) / span
    mean = np.minimum(_tapering(mean, span), (WIDEST_BRANCH * limb_radius) ** 2)
    between = (mean[:-1] * span[1:] + mean[1:] * span[:-1]) / (span[:-1] + span[1:])
    radius = np.sqrt(np.concatenate([mean[:1], between, mean[-1:]]))
    radius[0] = min(radius[0], limb_radius)
    return Line(_smoothed(points[np.append(0, last + 1)]), radius)


def _joints(tree: Cylinders, own: Int64s) -> Floats:
    """(k + 1, 3) ends of a chain of cylinders; where two do not meet, the middle of the gap."""
    middle = (tree.end_m[own[:-1]] + tree.start_m[own[1:]]) / 2
    return np.vstack([tree.start_m[own[0]], middle, tree.end_m[own[-1]]])


def _groups(length: Floats, radius: Floats, spacing: float) -> Int64s:
    """Last link (g,) of each group of consecutive links; every group is at least ``spacing`` radii long."""
    last: list[int] = []
    total = 0.0
    for link, (long, wide) in enumerate(zip(length, radius, strict=True)):
        total += float(long)
        if total >= max(spacing * float(wide), SHORTEST_M):
            last.append(link)
            total = 0.0
    if not last:
        return np.array([len(length) - 1], np.int64)
    last[-1] = len(length) - 1  # the rest belongs to the last group
    return np.array(last, np.int64)


def _smoothed(points: Floats) -> Floats:
    """Each inner point moved some of the way to the middle of its neighbours."""
    result = points.copy()
    result[1:-1] = (1 - SMOOTHING_SHARE) * points[1:-1] + SMOOTHING_SHARE / 2 * (points[:-2] + points[2:])
    return result
