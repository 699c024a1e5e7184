"""Lines of wood that a mesh lacks: stems, branches and ribs of fronds, with radii from the pipe model.

Pipe model (Shinozaki and others, Japanese Journal of Ecology 14, 1964): the cross-section of a stem is
proportional to the leaves that it carries. So cross-sections add up at forks, and a stem becomes thinner
where leaves or branches leave it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.spatial import KDTree

from galewood.tree.missing.arms import MIN_FROND_ASPECT_RATIO, triangle_areas
from galewood.tree.missing.sections import Section, sections_at
from galewood.tree.repair import Surface
from galewood.util import Floats

LineKind = Literal["stem", "branch", "frond"]
TIP_SHARE = 0.1
"""Least cross-section at the end of a line, relative to its base: no line ends as a thread."""
TOP_SHARE = 0.92
"""How far a stem reaches from the end of the wood to the top of the foliage."""
BRANCH_STEEPNESS = 0.7
"""A branch leaves its stem lower than its end, by this times its horizontal reach."""
FROND_BINS = 9
FEW_VERTICES = 8
"""A piece of fewer vertices is a card, which cannot bend."""
LEVELS = (0.96, 0.92, 0.86, 0.8, 0.7, 0.6, 0.5)
"""Heights over that of the wood at which the end of a trunk is sought: where it is thick enough."""
SECTION_SETBACK_SHARE = 0.08


@dataclass(frozen=True)
class AddedLine:
    """A line of added wood: points_m (p, 3) from its base, inside other wood, outwards; radius_m (p,)."""

    kind: LineKind
    points_m: Floats
    radius_m: Floats

    @property
    def length_m(self) -> float:
        """Length, m."""
        return float(_marks(self.points_m)[-1])

    @property
    def volume_m3(self) -> float:
        """Volume of the cones between the points, m³."""
        step, r = np.diff(_marks(self.points_m)), self.radius_m
        return float((np.pi / 3 * step * (r[:-1] ** 2 + r[:-1] * r[1:] + r[1:] ** 2)).sum())


@dataclass(frozen=True)
class Load:
    """Leaves that leave a line: length mark_m (n,) along it, leaf area_m2 (n,)."""

    mark_m: Floats
    area_m2: Floats

    def beyond(self, mark_m: Floats) -> Floats:
        """Leaf area (m,) that leaves the line at these marks or farther out, m²."""
        order = np.argsort(self.mark_m, kind="stable")
        total = np.concatenate([np.cumsum(self.area_m2[order][::-1])[::-1], [0.0]])
        return total[np.searchsorted(self.mark_m[order], mark_m, side="left")]


def pipe_radius(load: Load, mark_m: Floats, base_area_m2: float) -> Floats:
    """Radius (m,) at marks of a line whose cross-section at its base is base_area_m2, m²."""
    whole = max(float(load.area_m2.sum()), 1e-300)
    share = np.maximum(load.beyond(mark_m) / whole, TIP_SHARE)
    return np.sqrt(base_area_m2 * share / np.pi)


def trunk_area_m2(wood: Surface) -> float:
    """Cross-section of the trunk above its flare, m²: the median of three low cuts of the thickest stem."""
    low, size = float(wood.vertices[:, 1].min()), float(np.ptp(wood.vertices[:, 1]))
    cuts = [sections_at(wood, low + share * size) for share in (0.15, 0.25, 0.35)]
    return float(np.median([cut[0].area for cut in cuts if cut] or [0.0]))


@dataclass(frozen=True)
class StemEnd:
    """Where the drawn trunk ends: a place (3,) on its axis, its direction (3,), its cross-section, m²."""

    place_m: Floats
    direction: Floats
    area_m2: float


def stem_end(wood: Surface, least_area_m2: float) -> StemEnd:
    """The end of the trunk, or a place below it from which it is at least as thick as asked."""
    low, size = float(wood.vertices[:, 1].min()), float(np.ptp(wood.vertices[:, 1]))
    at = wood.vertices[int(wood.vertices[:, 1].argmax())]
    best = Section(at, 0.0)
    for level in LEVELS:
        found = _nearest(sections_at(wood, low + level * size), at)
        if found is None:
            continue
        at = found.centre
        if found.area > best.area:
            best = found
        if best.area >= least_area_m2:
            break
    below = _nearest(sections_at(wood, best.centre[1] - SECTION_SETBACK_SHARE * size), best.centre)
    along = best.centre - below.centre if below else np.array([0.0, 1.0, 0.0])
    return StemEnd(best.centre, along / max(float(np.linalg.norm(along)), 1e-300), best.area)


def _nearest(sections: list[Section], place: Floats) -> Section | None:
    return min(sections, key=lambda s: float(np.linalg.norm(s.centre - place)), default=None)


def stem_path(start_m: Floats, direction: Floats, top_m: Floats, step_m: float) -> Floats:
    """Points (p, 3) from a place, in a direction at first, to a top; ``step_m`` apart or nearer."""
    length = float(np.linalg.norm(top_m - start_m))
    middle = start_m + 0.4 * length * direction
    t = np.linspace(0, 1, max(4, int(np.ceil(length / step_m)) + 1))[:, None]
    return (1 - t) ** 2 * start_m + 2 * t * (1 - t) * middle + t**2 * top_m


def branch_foot(stem_m: Floats, end_m: Floats) -> tuple[Floats, float]:
    """Where a branch to a place leaves a stem (p, 3): the place (3,) and its length along the stem, m."""
    marks = _marks(stem_m)
    beside = _at_height(stem_m, float(end_m[1]))
    reach = float(np.linalg.norm((end_m - beside)[[0, 2]]))
    height = float(np.clip(end_m[1] - BRANCH_STEEPNESS * reach, stem_m[1, 1], stem_m[-1, 1]))
    place = _at_height(stem_m, height)
    rising = np.maximum.accumulate(stem_m[:, 1])
    return place, float(np.interp(height, rising, marks))


def _at_height(line_m: Floats, height: float) -> Floats:
    rising = np.maximum.accumulate(line_m[:, 1])
    return np.array([np.interp(height, rising, line_m[:, k]) for k in range(3)])


def carried(line_m: Floats, place_m: Floats, area_m2: Floats) -> Load:
    """The load of a line that carries leaves at places (n, 3): each leaves at the nearest point."""
    marks = _marks(line_m)
    fine = np.linspace(0, marks[-1], 60)
    points = np.stack([np.interp(fine, marks, line_m[:, k]) for k in range(3)], axis=1)
    return Load(fine[KDTree(points).query(place_m)[1]], area_m2)


def joined_loads(*loads: Load) -> Load:
    """All that several loads contain."""
    return Load(np.concatenate([one.mark_m for one in loads]), np.concatenate([one.area_m2 for one in loads]))


def line_marks(points_m: Floats) -> Floats:
    """Length (p,) along a line to each of its points, m."""
    return _marks(points_m)


def _marks(points_m: Floats) -> Floats:
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points_m, axis=0), axis=1))])


def frond_path(corners_m: Floats, way_m: Floats) -> Floats | None:
    """The line (p, 3) through the middle of a slender piece (f, 3, 3), from its base; None: not slender.

    ``way_m`` (f, 3) is the distance of each corner from the base along the surface: a frond may bend back. A
    piece of few vertices is a card, which has none.
    """
    vertices, way = corners_m.reshape(-1, 3), way_m.ravel()
    if len(np.unique(vertices, axis=0)) < FEW_VERTICES or not np.isfinite(way).all():
        return None
    longest, area = float(way.max()), triangle_areas(corners_m)
    if not longest > 0 or longest**2 < MIN_FROND_ASPECT_RATIO * float(area.sum()):
        return None
    middle, at = corners_m.mean(axis=1), way_m.mean(axis=1) / longest
    points: list[Floats] = []
    for number in range(FROND_BINS):
        own = np.minimum((at * FROND_BINS).astype(int), FROND_BINS - 1) == number
        if area[own].sum() > 0:
            points.append(np.average(middle[own], axis=0, weights=area[own]))
    near = vertices[way <= way.min() + 0.3 * longest / FROND_BINS].mean(axis=0)
    far = vertices[way >= (1 - 0.3 / FROND_BINS) * longest].mean(axis=0)
    return _apart(np.array([near, *points, far]), 0.04 * longest)


def _apart(points: Floats, least: float) -> Floats:
    """The line without points that are very near to the one before."""
    kept = [points[0]]
    for point in points[1:]:
        if np.linalg.norm(point - kept[-1]) > least:
            kept.append(point)
    return np.array(kept if len(kept) > 1 else [points[0], points[-1]])
