"""Wood that a mesh does not draw: a trunk inside a closed crown, branches, ribs of fronds, stems of a bush.

A tree can only bend where it has wood. Where a trunk ends low in the crown, or foliage is far from all wood,
lines of wood are added that reach it. They are meshed and bend like drawn wood, but are never drawn.
Everything about them is assumed, and reported. Metres, y up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial import KDTree

from galewood.formats import Line, RawPart, tube
from galewood.tree.missing.added_lines import (
    FEW_VERTICES,
    TOP_SHARE,
    AddedLine,
    Load,
    branch_foot,
    carried,
    frond_path,
    joined_loads,
    line_marks,
    pipe_radius,
    stem_end,
    stem_path,
    trunk_area_m2,
)
from galewood.tree.missing.arms import arms_and_ways, triangle_areas
from galewood.tree.missing.clumps import REACH_HEIGHT_SHARE, Clumps, clumps_of, clustered
from galewood.tree.missing.sections import edge_samples, sections_at
from galewood.tree.repair import Surface
from galewood.util import Floats, MeshError

SHORT_WOOD = 0.62
"""Height of the wood, relative to the tree, below which the trunk is continued."""
SHORT_IF_ASKED = 0.85
"""The same if the user asks for completion."""
FAR_SHARE = 0.15
"""Share of the leaf area far from all wood from which branches are added, and of fronds without a rib."""
MOST_BRANCHES, MOST_FRONDS = 16, 48
MOST_EXAMINED = 10 * MOST_FRONDS
"""Pieces, the largest ones, that are examined for being fronds: of more pieces as large, most are not."""
FROND_SIZE = 0.15
"""Shortest frond that gets a rib, relative to the height."""
MAX_WOODED_LENGTH_SHARE = 0.5
"""Share of its length that a frond may have wood beside it and still get a rib."""
FROND_RADIUS = 0.01
"""Largest radius of a rib at its base, relative to its length (assumed)."""
LEAST_END = 0.25
"""Least cross-section of a stem at the end of the drawn trunk, relative to the pipe model."""
HUBER_VALUE = 2e-4
"""Cross-section of wood per leaf area of a plant without any drawn wood (assumed: 1 cm² for 0.5 m²)."""
MIN_FOOT_RADIUS_RATIO, MAX_FOOT_RADIUS_RATIO = 1 / 160, 1 / 25
"""Radius of the foot of such a plant, relative to its height."""
MIN_STEM_RADIUS_RATIO = 1 / 130
"""Least radius of each of several stems, relative to its length (assumed)."""
FOOT_HEIGHT_SHARE = 0.08
"""Height of the common foot of its stems, relative to its height."""
SINGLE_STEM_ASPECT_RATIO = 1.5
"""Height over width of a crown without any wood from which it has one stem, not several."""
STEMS_WIDE, MOST_STEMS = 0.25, 7
SPARSE_FACES, BILLBOARD_HEIGHT_SHARE = 2, 0.5
"""Pieces of so few faces and so large, relative to the height, are pictures of a tree and no leaves."""


@dataclass(frozen=True)
class Completed:
    """The wood with the added lines; the last ``added_faces`` faces of the surface are not drawn."""

    wood: Surface
    added_faces: int = 0
    lines: list[AddedLine] = field(default_factory=list[AddedLine])
    report: dict[str, Any] = field(default_factory=dict[str, Any])
    warnings: list[str] = field(default_factory=list[str])


def complete_wood(wood: Surface, leaves: Sequence[RawPart], asked: bool | None) -> Completed:
    """The wood of a tree with what it lacks to carry its leaves; ``asked``: None: where it is needed."""
    clumps = clumps_of(leaves)
    if asked is False or not clumps.area_m2.sum() > 0:
        return Completed(wood)
    low = float(wood.vertices[:, 1].min())
    top = max(float(clumps.corner_m[..., 1].max()), float(wood.vertices[:, 1].max()))
    height_m, reached = top - low, float(np.ptp(wood.vertices[:, 1]))
    short = reached < (SHORT_IF_ASKED if asked else SHORT_WOOD) * height_m
    grower = _Grower(wood, clumps, height_m, trunk_area_m2(wood) / float(clumps.area_m2.sum()))
    least = 0.0 if asked else FAR_SHARE
    grower.add_fronds(least)
    above = ~grower.served & (clumps.centre_m[:, 1] > low + 0.8 * reached)
    if short and clumps.area_m2[above].sum() > FAR_SHARE * clumps.area_m2.sum():
        grower.add_stem()
    grower.add_branches(least)
    return grower.completed(f"the wood ends at {reached / height_m:.0%} of the height")


def synthesize_stems(leaves: Sequence[RawPart]) -> Completed:
    """Stems for a plant that is drawn as leaves only. Raises MeshError for pictures of trees."""
    clumps = clumps_of(leaves)
    place, height_m = foot_of_leaves(leaves)
    area = float(clumps.area_m2.sum())
    _check_leaves(clumps, height_m, area)
    radius = float(
        np.clip(
            np.sqrt(HUBER_VALUE * area / np.pi),
            MIN_FOOT_RADIUS_RATIO * height_m,
            MAX_FOOT_RADIUS_RATIO * height_m,
        )
    )
    points = place + np.linspace(0, FOOT_HEIGHT_SHARE * height_m, 4)[:, None] * np.array([0.0, 1.0, 0.0])
    foot = AddedLine("stem", points, np.full(4, radius))
    grower = _Grower(_surface([foot]), clumps, height_m, np.pi * radius**2 / area, leafy=True)
    grower.add_fronds(0.0)
    rest = ~grower.served
    if rest.any():
        size = np.ptp(clumps.corner_m[np.isin(clumps.clump, np.flatnonzero(rest))].reshape(-1, 3), axis=0)
        if rest.sum() == 1 or size[1] > SINGLE_STEM_ASPECT_RATIO * max(size[0], size[2]):
            grower.add_stem()
            grower.add_branches(0.0)
        else:
            grower.add_stems(points[-2])
    found = grower.completed("the file draws no wood")
    return Completed(found.wood, len(found.wood.faces), [foot, *found.lines], found.report, found.warnings)


def foot_of_leaves(leaves: Sequence[RawPart]) -> tuple[Floats, float]:
    """Where a plant of leaves alone stands (3,), and its height."""
    clumps = clumps_of(leaves)
    low, high = (float(f(clumps.corner_m[..., 1])) for f in (np.min, np.max))
    middle = np.average(clumps.point_m, axis=0, weights=np.maximum(clumps.point_area_m2, 1e-12))
    return np.array([middle[0], low, middle[2]]), high - low


def _check_leaves(clumps: Clumps, height_m: float, area_m2: float) -> None:
    """Raise MeshError if the leaves are a picture of a tree on a few cards, or nothing."""
    faces = np.bincount(clumps.clump, minlength=len(clumps))
    low, high = np.full((len(clumps), 3), np.inf), np.full((len(clumps), 3), -np.inf)
    np.minimum.at(low, clumps.clump, clumps.corner_m.min(axis=1))
    np.maximum.at(high, clumps.clump, clumps.corner_m.max(axis=1))
    size = np.linalg.norm(high - low, axis=1)
    cards = (faces <= SPARSE_FACES) & (size > BILLBOARD_HEIGHT_SHARE * height_m)
    if not area_m2 > 0 or clumps.area_m2[cards].sum() > 0.5 * area_m2:
        raise MeshError(
            "no-wood",
            "unsuitable",
            "No wood was found in the mesh, and its leaves are cards as large as a tree.",
            "A picture of a tree on cards cannot bend. Upload a tree with a trunk, or with separate leaves.",
        )


@dataclass(frozen=True)
class _BranchLine:
    """A branch before its radii are known."""

    points_m: Floats
    load: Load
    on_stem: bool
    """Whether it grows from the added stem, not from drawn wood."""


class _Grower:
    """Adds lines to the wood of a tree; ``served`` says which clumps have wood of their own by then."""

    def __init__(
        self, wood: Surface, clumps: Clumps, height_m: float, area_per_leaf: float, leafy: bool = False
    ) -> None:
        self._wood, self._clumps, self._height_m = wood, clumps, height_m
        self._area_per_leaf = area_per_leaf
        self._leafy = leafy
        self._points = edge_samples(wood, height_m / 100)
        self._near_wood = KDTree(self._points)
        self._stem: Floats | None = None
        self._stem_area = 0.0
        self._on_stem: list[Load] = []
        self._branches: list[_BranchLine] = []
        self._lines: list[AddedLine] = []
        self.served = np.zeros(len(clumps), dtype=bool)

    def add_fronds(self, least: float) -> None:
        """Ribs along slender clumps without wood beside them, if they are more than a share of the leaves.

        More than MOST_FRONDS are leaves: the search ends there.
        """
        found: dict[int, list[AddedLine]] = {}
        ribs: list[AddedLine] = []
        area = self._clumps.area_m2
        radius_m = self._clumps.radius_m
        large = np.flatnonzero(radius_m > 0.2 * FROND_SIZE * self._height_m)
        large = large[np.argsort(-radius_m[large], kind="stable")][:MOST_EXAMINED]
        if area[large].sum() <= least * area.sum():
            return
        for number in np.sort(large).tolist():
            own = self._ribs(self._clumps.corners_of(number))
            if own:
                found[number] = own
                ribs += own
            if len(ribs) > MOST_FRONDS:
                return
        if area[list(found)].sum() > least * area.sum():
            self._lines += ribs
            self.served[list(found)] = True

    def _ribs(self, corners_m: Floats) -> list[AddedLine]:
        """The ribs of all fronds of a piece (f, 3, 3); empty if it has other parts, or wood along them."""
        vertices, index = np.unique(corners_m.reshape(-1, 3), axis=0, return_inverse=True)
        if len(vertices) < FEW_VERTICES:
            return []
        base = vertices[int(self._near_wood.query(vertices)[0].argmin())]
        arm, way = arms_and_ways(vertices, index.reshape(-1, 3), base)
        ribs: list[AddedLine] = []
        for number in range(int(arm.max()) + 1):
            path = frond_path(corners_m[arm == number], way[arm == number])
            if path is None or line_marks(path)[-1] < FROND_SIZE * self._height_m:
                return []
            near = self._near_wood.query(path)[0] < 0.1 * line_marks(path)[-1]
            if near.mean() < MAX_WOODED_LENGTH_SHARE:
                ribs.append(self._frond(corners_m[arm == number], path))
        return ribs

    def _frond(self, corners_m: Floats, path: Floats) -> AddedLine:
        points = _without_repeats(np.concatenate([[self._inside(path[0])], path]), 0.01 * self._height_m)
        area = triangle_areas(corners_m)
        load, marks = carried(points, corners_m.mean(axis=1), area), line_marks(points)
        base = min(self._area_per_leaf * float(area.sum()), np.pi * (FROND_RADIUS * marks[-1]) ** 2)
        return AddedLine("frond", points, pipe_radius(load, marks, base))

    def add_stem(self) -> None:
        """Continue the trunk to near the top of the foliage."""
        rest = np.flatnonzero(~self.served)
        corners = self._clumps.corner_m[np.isin(self._clumps.clump, rest)]
        whole = self._area_per_leaf * float(self._clumps.area_m2[rest].sum())
        end = stem_end(self._wood, LEAST_END * whole)
        high = float(corners[..., 1].max())
        place, area = corners.mean(axis=1), triangle_areas(corners)
        weight = np.where(place[:, 1] > (end.place_m[1] + high) / 2, area, 0.0)
        middle = np.average(place, axis=0, weights=weight) if weight.any() else end.place_m
        top = np.array([middle[0], end.place_m[1] + TOP_SHARE * (high - end.place_m[1]), middle[2]])
        self._stem = stem_path(end.place_m, end.direction, top, 0.05 * self._height_m)
        self._stem_area = float(np.clip(end.area_m2, LEAST_END * whole, whole))
        place, area = self._clumps.point_m, self._clumps.point_area_m2
        drawn = self._near_wood.query(place)[0]
        nearer = KDTree(_dense(self._stem)).query(place)[0] < drawn
        nearer &= ~self.served[self._clumps.clump]
        far = self._clumps.unreached(np.concatenate([self._points, _dense(self._stem)]), self._height_m)
        own = nearer & ~far[self._clumps.clump]
        self._on_stem.append(carried(self._stem, place[own], area[own]))

    def add_branches(self, least: float) -> None:
        """Branches to the clumps that no wood reaches, if they are more than a share of all leaves."""
        wood = self._points if self._stem is None else np.concatenate([self._points, _dense(self._stem)])
        far = np.flatnonzero(self._clumps.unreached(wood, self._height_m) & ~self.served)
        area = self._clumps.area_m2
        if not len(far) or area[far].sum() <= least * area.sum():
            return
        label = clustered(
            self._clumps.centre_m[far], area[far], REACH_HEIGHT_SHARE * self._height_m, MOST_BRANCHES
        )
        for number in range(int(label.max()) + 1):
            self._add_branch(far[label == number])
        self.served[far] = True

    def _add_branch(self, members: np.ndarray) -> None:
        area = self._clumps.area_m2[members]
        end = np.average(self._clumps.centre_m[members], axis=0, weights=np.maximum(area, 1e-12))
        cost = np.linalg.norm(self._points - end, axis=1) + np.maximum(self._points[:, 1] - end[1], 0)
        drawn = self._inside(self._points[int(cost.argmin())])
        start, on_stem = drawn, False
        if self._stem is not None:
            foot, mark = branch_foot(self._stem, end)
            if np.linalg.norm(end - foot) < 1.5 * np.linalg.norm(end - drawn):
                start, on_stem = foot, True
                self._on_stem.append(Load(np.array([mark]), np.array([area.sum()])))
        points = _straight(start, end, 0.06 * self._height_m)
        own = np.isin(self._clumps.clump, members)
        load = carried(points, self._clumps.point_m[own], self._clumps.point_area_m2[own])
        self._branches.append(_BranchLine(points, load, on_stem))

    def add_stems(self, foot_m: Floats) -> None:
        """Several stems from a common foot to the parts of a bush."""
        rest = np.flatnonzero(~self.served)
        area = self._clumps.area_m2[rest]
        label = clustered(self._clumps.centre_m[rest], area, STEMS_WIDE * self._height_m, MOST_STEMS)
        for number in range(int(label.max()) + 1):
            members = rest[label == number]
            weight = np.maximum(self._clumps.area_m2[members], 1e-12)
            end = np.average(self._clumps.centre_m[members], axis=0, weights=weight)
            points = stem_path(foot_m, np.array([0.0, 1.0, 0.0]), end, 0.06 * self._height_m)
            own = np.isin(self._clumps.clump, members)
            load = carried(points, self._clumps.point_m[own], self._clumps.point_area_m2[own])
            least = np.pi * (MIN_STEM_RADIUS_RATIO * line_marks(points)[-1]) ** 2
            base = max(self._area_per_leaf * float(self._clumps.area_m2[members].sum()), least)
            self._lines.append(AddedLine("stem", points, pipe_radius(load, line_marks(points), base)))
        self.served[rest] = True

    def _inside(self, place_m: Floats) -> Floats:
        """A place on the axis of the drawn wood near a place."""
        near = self._points[int(self._near_wood.query(place_m)[1])]
        low, high = (float(f(self._wood.vertices[:, 1])) for f in (np.min, np.max))
        level = float(np.clip(near[1], low + 0.02 * (high - low), high - 0.02 * (high - low)))
        sections = sections_at(self._wood, level)
        close = [s for s in sections if np.linalg.norm(s.centre - near) < 3 * s.radius + 0.02 * (high - low)]
        if not close:
            return near
        return min(close, key=lambda s: float(np.linalg.norm(s.centre - near))).centre

    def completed(self, why: str) -> Completed:
        """The wood with all lines, and the report."""
        lines = list(self._lines)
        on_stem = self._area_per_leaf
        if self._stem is not None:
            load = joined_loads(*self._on_stem)
            on_stem = self._stem_area / max(float(load.area_m2.sum()), 1e-300)
            radius = pipe_radius(load, line_marks(self._stem), self._stem_area)
            lines.insert(0, AddedLine("stem", self._stem, radius))
        for branch in self._branches:
            base = (on_stem if branch.on_stem else self._area_per_leaf) * float(branch.load.area_m2.sum())
            radius = pipe_radius(branch.load, line_marks(branch.points_m), base)
            lines.append(AddedLine("branch", branch.points_m, radius))
        if not lines:
            return Completed(self._wood)
        added = _surface(lines)
        faces = np.concatenate([self._wood.faces, added.faces + len(self._wood.vertices)]).astype(np.int32)
        whole = Surface(np.concatenate([self._wood.vertices, added.vertices]), faces)
        reason = self._why(lines, why)
        warning = f"{_words(lines)} added, because {reason}: assumed, and not drawn. "
        report = {
            "reason": reason,
            "stems_m": [round(line.length_m, 3) for line in lines if line.kind == "stem"],
            "branches": sum(line.kind == "branch" for line in lines),
            "fronds": sum(line.kind == "frond" for line in lines),
            "length_m": round(sum(line.length_m for line in lines), 3),
            "volume_m3": sum(line.volume_m3 for line in lines),
        }
        return Completed(whole, len(added.faces), lines, report, [warning + DISABLE_HINT])

    def _why(self, lines: list[AddedLine], why: str) -> str:
        if self._leafy or any(line.kind == "stem" for line in lines):
            return why
        return "there is foliage that the wood does not reach"


DISABLE_HINT = "To disable this, choose not to complete the wood (--no-complete)."


def _words(lines: list[AddedLine]) -> str:
    """What was added, as the beginning of a sentence."""
    stems = [line.length_m for line in lines if line.kind == "stem"]
    branches, fronds = (sum(line.kind == kind for line in lines) for kind in ("branch", "frond"))
    words: list[str] = []
    if stems:
        longest = f"{max(stems):.2g} m"
        words.append(f"a stem of {longest}" if len(stems) == 1 else f"{len(stems)} stems of up to {longest}")
    if branches:
        words.append("a branch" if branches == 1 else f"{branches} branches")
    if fronds:
        words.append("the rib of a frond" if fronds == 1 else f"the ribs of {fronds} fronds")
    text = ", ".join(words[:-1]) + (" and " if len(words) > 1 else "") + words[-1]
    return f"{text[0].upper()}{text[1:]} {'was' if len(lines) == 1 else 'were'}"


def _surface(lines: list[AddedLine]) -> Surface:
    """The tubes around lines as one surface."""
    parts = [tube(Line(line.points_m, line.radius_m)) for line in lines]
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in parts)])
    faces = [own + int(start) for (_, own), start in zip(parts, starts, strict=False)]
    return Surface(np.concatenate([v for v, _ in parts]), np.concatenate(faces).astype(np.int32))


def _dense(line_m: Floats) -> Floats:
    """Points (s, 3) close together on a line."""
    marks = line_marks(line_m)
    fine = np.linspace(0, marks[-1], 12 * len(line_m))
    return np.stack([np.interp(fine, marks, line_m[:, k]) for k in range(3)], axis=1)


def _straight(start_m: Floats, end_m: Floats, step_m: float) -> Floats:
    count = max(4, int(np.ceil(float(np.linalg.norm(end_m - start_m)) / step_m)) + 1)
    return start_m + np.linspace(0, 1, count)[:, None] * (end_m - start_m)


def _without_repeats(points: Floats, least: float) -> Floats:
    """The line without a second point that is very near to the first."""
    near = np.linalg.norm(points[1] - points[0]) < least
    return points if not near else np.concatenate([points[:1], points[2:]])
