"""Builds the beam frame of a tree from its branches, each joined to its parent limb."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from galewood.solid.beams.frame import Frame
from galewood.util import Floats, Int64s, Ints

SNAP_LINK_SHARE = 0.02
"""Share of a link: a branch that starts this close to an end of it starts at that end."""

SHORTEST_M = 1e-4
"""Shortest beam."""


def joined_frame(points_m: Floats, radius_m: Floats, parent: Ints, branch: Ints, pieces: int = 1) -> Frame:
    """The frame of branches that each start at the nearest point of the axis of their parent branch.

    points_m (p, 3), radius_m (p,), parent (p,) with −1 at the root and branch (p,), the trunk being 0; each
    link becomes ``pieces`` beams.
    """
    builder = _Builder(points_m, radius_m, pieces)
    order = [np.flatnonzero(branch == number) for number in range(int(branch.max()) + 1)]
    order.sort(key=lambda own: int(own[0]))
    for own in order:
        parent_branch = int(branch[parent[own[0]]]) if parent[own[0]] >= 0 else -1
        builder.add_branch(own, int(branch[own[0]]), parent_branch)
    return builder.frame()


class _Builder:
    """Builds the frame branch by branch, parents first."""

    def __init__(self, points_m: Floats, radius_m: Floats, pieces: int) -> None:
        self._points, self._radius, self._pieces = points_m, radius_m, pieces
        self._nodes: list[Floats] = []
        self._girth: list[float] = []
        self._of_branch: dict[int, list[int]] = {}
        self._hidden: dict[int, list[bool]] = {}
        self._joints: list[tuple[int, int]] = []

    def add_branch(self, own: Int64s, number: int, parent: int) -> None:
        """Add a branch through the points `own`; `parent` is its parent branch (−1: the ground)."""
        places, girth = _resampled(*_distinct(self._points[own], self._radius[own]), self._pieces)
        hidden = np.zeros(len(places) - 1, bool)
        joint = -1
        if parent >= 0:
            joint = self._node_on(parent, places[0])
            limb = self._of_branch[parent]
            axis, thick = np.array([self._nodes[n] for n in limb]), np.array([self._girth[n] for n in limb])
            places, girth, hidden = _cut_at_bark(places, girth, axis, thick)
        self._of_branch[number] = [self._node(p, g) for p, g in zip(places, girth, strict=True)]
        self._hidden[number] = hidden.tolist()
        if joint >= 0:
            self._joints.append((joint, self._of_branch[number][0]))

    def _node(self, place: Floats, girth: float) -> int:
        self._nodes.append(place)
        self._girth.append(girth)
        return len(self._nodes) - 1

    def _node_on(self, branch: int, place: Floats) -> int:
        """Return a node at the point of a branch's axis nearest to a place, inserting one if necessary."""
        nodes = self._of_branch[branch]
        line = np.array([self._nodes[n] for n in nodes])
        along = np.diff(line, axis=0)
        share = np.einsum("ij,ij->i", place - line[:-1], along) / np.einsum("ij,ij->i", along, along)
        share = np.clip(share, 0.0, 1.0)
        foot = line[:-1] + share[:, None] * along
        k = int(np.argmin(np.linalg.norm(foot - place, axis=1)))
        for end, close in ((k, share[k] < SNAP_LINK_SHARE), (k + 1, share[k] > 1 - SNAP_LINK_SHARE)):
            if close:
                return nodes[end]
        girth = (1 - share[k]) * self._girth[nodes[k]] + share[k] * self._girth[nodes[k + 1]]
        nodes.insert(k + 1, self._node(foot[k], float(girth)))
        self._hidden[branch].insert(k, self._hidden[branch][k])
        return nodes[k + 1]

    def frame(self) -> Frame:
        """Return the frame; coincident nodes are merged."""
        points, girth = np.array(self._nodes), np.array(self._girth)
        stands = np.arange(len(points))
        links: list[tuple[int, int, bool]] = []
        for joint, first in self._joints:
            if np.linalg.norm(points[joint] - points[first]) < 1e-3:
                stands[first] = stands[joint]  # which may itself stand for another
            else:
                links.append((joint, first, True))
        for number, nodes in self._of_branch.items():
            links += list(zip(nodes, nodes[1:], self._hidden[number], strict=False))
        kept, index = np.unique(stands, return_inverse=True)
        ends = np.array([(a, b) for a, b, _ in links])
        one, other = girth[ends[:, 0]], girth[ends[:, 1]]
        radius = np.sqrt((one**2 + one * other + other**2) / 3)
        return Frame(points[kept], index[ends], radius, np.array([h for _, _, h in links]))


def _distinct(points_m: Floats, radius_m: Floats) -> tuple[Floats, Floats]:
    """The line without points that coincide with the one before."""
    apart = np.linalg.norm(np.diff(points_m, axis=0), axis=1) > SHORTEST_M
    kept = np.concatenate([[True], apart])
    return points_m[kept], radius_m[kept]


def _resampled(points_m: Floats, radius_m: Floats, pieces: int) -> tuple[Floats, Floats]:
    knots = np.arange(len(points_m))
    fine = np.linspace(0, len(points_m) - 1, pieces * (len(points_m) - 1) + 1)
    places = np.column_stack([np.interp(fine, knots, points_m[:, k]) for k in range(3)])
    return places, np.interp(fine, knots, radius_m)


def _cut_at_bark(
    places: Floats, radii: Floats, axis: Floats, girth: Floats
) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Insert a point where the branch leaves its parent limb (axis (a, 3), girth (a,), m).

    Returns the points (k, 3), the radii (k,), and which links (k − 1,) are inside the limb.
    """
    knots = np.arange(len(places))
    fine = np.linspace(0, len(places) - 1, 20 * (len(places) - 1) + 1)
    way = np.column_stack([np.interp(fine, knots, places[:, k]) for k in range(3)])
    dense = np.linspace(0, len(axis) - 1, 20 * (len(axis) - 1) + 1)
    limb = np.column_stack([np.interp(dense, np.arange(len(axis)), axis[:, k]) for k in range(3)])
    gap, near = KDTree(limb).query(way)
    outside = gap > np.interp(dense, np.arange(len(axis)), girth)[near]
    at = fine[int(np.argmax(outside))] if outside.any() else fine[-1]
    fine = np.unique(np.append(knots, at))
    places = np.column_stack([np.interp(fine, knots, places[:, k]) for k in range(3)])
    return places, np.interp(fine, knots, radii), fine[1:] <= at
