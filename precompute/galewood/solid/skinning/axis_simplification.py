"""Simplification of the axis: points between which the motion of all others can be interpolated.

Along every branch the motion in strong wind is a curve, which is simplified by the method of Douglas and
Peucker (1973): the point farthest from the chord is kept until none is farther than a tolerance. A branch
that stays rigid relative to its limb, with all that it bears, needs no node: it is carried by the place it
grows from. So the motion is continuous at every fork, however large the tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from galewood.solid.skinning.node_poses import turned
from galewood.util import Floats, Ints

RIGID_TOLERANCE_SHARE = 0.5
"""Tolerance of rigid branches relative to that of interpolation, since they are not seen to bend at all."""


@dataclass(frozen=True)
class Line:
    """Points of a branch from its base outwards; ``limb`` is the point that bears it, −1: the ground."""

    limb: int
    own: Ints

    @property
    def points(self) -> Ints:
        """The points of the branch after the one that bears it."""
        return self.own if self.limb < 0 else np.concatenate([[self.limb], self.own])


@dataclass(frozen=True)
class AxisMotion:
    """Poses in strong wind: points_m (p, 3), parent (p,), displacement (p, 3, k), rotation vectors (p, 3, k).

    ``arm_m`` is the length at whose end the rotation counts as a displacement.
    """

    points_m: Floats
    parent: Ints
    moved_m: Floats
    turned: Floats
    arm_m: float

    @cached_property
    def lines(self) -> list[Line]:
        """All branches, limbs before what they bear."""
        return longest_lines(self.points_m, self.parent)

    @cached_property
    def borne(self) -> list[Ints]:
        """The points of each branch and of all that grow from it."""
        line_of = np.zeros(len(self.parent), np.int64)
        for number, line in enumerate(self.lines):
            line_of[line.own] = number
        parts = [[line.own] for line in self.lines]
        for number in range(len(self.lines) - 1, -1, -1):
            if self.lines[number].limb >= 0:
                parts[int(line_of[self.lines[number].limb])] += parts[number]
        return [np.concatenate(part) for part in parts]

    @cached_property
    def off_rigid_m(self) -> list[float]:
        """How far each branch, with all it bears, is from where it would be if rigid with its limb."""
        return [
            np.inf if line.limb < 0 else self._off_rigid_m(borne, line.limb)
            for line, borne in zip(self.lines, self.borne, strict=True)
        ]

    @cached_property
    def off_chords_m(self) -> list[Floats]:
        """For the points of each branch, the tolerance below which they are kept (Douglas and Peucker)."""
        return [self._off_chords_m(line.points) for line in self.lines]

    def _off_chords_m(self, points: Ints) -> Floats:
        arc_m = arc_lengths(self.points_m[points])
        kept_below = np.full(len(points), np.inf)
        open_ = [(0, len(points) - 1, np.inf)]
        while open_:
            first, last, most = open_.pop()
            if last - first < 2:
                continue
            off = self._off_chord_m(points[first : last + 1], arc_m[first : last + 1])
            worst = int(off.argmax())
            most = min(most, float(off[worst]))
            kept_below[first + worst] = most
            open_ += [(first, first + worst, most), (first + worst, last, most)]
        return kept_below

    def _off_chord_m(self, points: Ints, arc_m: Floats) -> Floats:
        """(len(points),) largest distance of each inner point from the interpolation between both ends."""
        share = ((arc_m - arc_m[0]) / max(arc_m[-1] - arc_m[0], 1e-12))[:, None, None]
        off = np.zeros(len(points))
        for values, unit in ((self.moved_m, 1.0), (self.turned, self.arm_m)):
            own = values[points]
            chord = own[:1] + share * (own[-1:] - own[:1])
            off = np.maximum(off, unit * np.linalg.norm(own - chord, axis=1).max(axis=1, initial=0.0))
        off[[0, -1]] = -1.0
        return off

    def _off_rigid_m(self, points: Ints, base: int) -> float:
        """Largest distance of points from where they would be if they were rigid with ``base``."""
        arm = self.points_m[points] - self.points_m[base]
        wide = np.broadcast_to(arm[:, None], (len(arm), self.turned.shape[2], 3))
        carried = self.moved_m[base].T + turned(wide, self.turned[base].T) - wide
        off = self.moved_m[points].transpose(0, 2, 1) - carried
        return float(np.linalg.norm(off, axis=2).max(initial=0.0))


@dataclass(frozen=True)
class SimplifiedAxis:
    """The kept points (n,) of an axis, the nodes, and how all points (p,) refer to them.

    ``line`` is the branch of each point, ``arc_m`` its distance along it from the limb. ``base`` is −1 for
    points of a branch that bends, otherwise the point of such a branch with which theirs is rigid.
    """

    nodes: Ints
    lines: list[Line]
    line: Ints
    arc_m: Floats
    base: Ints


def longest_lines(points_m: Floats, parent: Ints) -> list[Line]:
    """The branches of an axis, limbs first; at a fork the longest continuation goes on.

    Parents precede their children in the arrays.
    """
    count = len(points_m)
    step = np.linalg.norm(points_m - points_m[np.maximum(parent, 0)], axis=1)
    beyond, goes_on = np.zeros(count), np.full(count, -1, np.int64)
    for point in range(count - 1, -1, -1):
        up = int(parent[point])
        if up >= 0 and (goes_on[up] < 0 or beyond[point] + step[point] > beyond[up]):
            goes_on[up], beyond[up] = point, beyond[point] + step[point]
    lines: list[Line] = []
    for point in range(count):
        up = int(parent[point])
        if up >= 0 and goes_on[up] == point:
            continue
        own = [point]
        while goes_on[own[-1]] >= 0:
            own.append(int(goes_on[own[-1]]))
        lines.append(Line(up, np.array(own, np.int64)))
    return lines


def simplify_axis(motion: AxisMotion, tolerance_m: float, max_nodes: int) -> SimplifiedAxis:
    """Nodes from which all points follow within the tolerance, or within the least that max_nodes allow."""
    while True:
        simplified = _simplified(motion, tolerance_m)
        if len(simplified.nodes) <= max_nodes:
            return simplified
        tolerance_m *= 1.1


def _simplified(motion: AxisMotion, tolerance_m: float) -> SimplifiedAxis:
    count = len(motion.points_m)
    line_of, base = np.zeros(count, np.int64), np.full(count, -1, np.int64)
    arc, is_node = np.zeros(count), np.zeros(count, bool)
    for number, line in enumerate(motion.lines):
        line_of[line.own] = number
        arc[line.own] = arc_lengths(motion.points_m[line.points])[-len(line.own) :]
        if base[line.own[0]] >= 0:
            continue
        if motion.off_rigid_m[number] < RIGID_TOLERANCE_SHARE * tolerance_m:
            base[motion.borne[number]] = line.limb
        else:
            is_node[line.points[motion.off_chords_m[number] > tolerance_m]] = True
    return SimplifiedAxis(np.flatnonzero(is_node), motion.lines, line_of, arc, base)


def arc_lengths(points_m: Floats) -> Floats:
    """(n,) distance of each point of a line (n, 3) from its first, along it."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points_m, axis=0), axis=1))])
