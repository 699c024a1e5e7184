"""The axis is split into lines, and simplified where its motion is nearly linear."""

from __future__ import annotations

import numpy as np
from galewood.solid.skinning.axis_simplification import AxisMotion, longest_lines, simplify_axis

from tests.precompute.solid.skinning.poles import pole_with_branch


def test_lines_cover_every_point_once_and_go_on_along_the_longest() -> None:
    axis = pole_with_branch()
    lines = longest_lines(axis.points_m, axis.parent)
    assert sorted(np.concatenate([line.own for line in lines]).tolist()) == list(range(len(axis.parent)))
    assert [line.limb for line in lines] == [-1, 50]
    assert len(lines[0].own) == 101


def test_points_that_turn_are_kept_although_they_hardly_move() -> None:
    axis = pole_with_branch(beside=1)
    moved = np.zeros((len(axis.points_m), 3, 1))
    turned = np.zeros_like(moved)
    turned[60:101, 2, 0] = np.linspace(0, 1, 41)
    simplified = simplify_axis(AxisMotion(axis.points_m, axis.parent, moved, turned, 0.2), 0.01, 100)
    assert len(simplified.nodes) >= 3 and np.abs(simplified.nodes - 60).min() <= 3
