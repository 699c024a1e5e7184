"""Nodes: points of the axis between which the motion of all others is interpolated within a tolerance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from galewood.reduction.knots import AxisMotion, branch_lines, choose_knots
from galewood.reduction.nodes import Motion, Nodes, make_nodes


@dataclass
class Pole:
    """A pole along y with one branch, whose particles are the points of its axis."""

    points_m: np.ndarray
    parent: np.ndarray
    turned: np.ndarray

    def displacement(self, basis: np.ndarray) -> np.ndarray:
        return basis

    def rotation(self, basis: np.ndarray) -> np.ndarray:
        return self.turned

    @property
    def basis(self) -> np.ndarray:
        """Bends the pole in two directions; the branch is carried by its base without turning."""
        height = self.points_m[:, 1].copy()
        height[self.points_m[:, 0] > 0] = 5.0
        basis = np.zeros((len(height), 3, 2))
        basis[:, 0, 0] = basis[:, 2, 1] = (height / 10) ** 2
        return basis


@dataclass
class Places:
    child: np.ndarray
    share: np.ndarray


def pole(points: int = 101, beside: int = 20) -> Pole:
    """A pole of 10 m; its branch begins at the middle."""
    stem = np.stack([np.zeros(points), np.linspace(0, 10, points), np.zeros(points)], axis=1)
    twig = np.stack([np.arange(1, beside + 1) * 0.1, np.full(beside, 5.0), np.zeros(beside)], axis=1)
    parent = np.concatenate(
        [np.arange(-1, points - 1), [points // 2], np.arange(points, points + beside - 1)]
    )
    places = np.concatenate([stem, twig])
    return Pole(places, parent, np.zeros((len(places), 3, 2)))


def every_place(axis: Pole, seed: int) -> Places:
    rng = np.random.default_rng(seed)
    child = rng.integers(1, len(axis.points_m), 3000)
    return Places(child, rng.uniform(size=3000))


def nodes_of(axis: Pole, places: Places, tolerance_m: float, most: int = 768) -> Nodes:
    strong = np.array([[1.0, 0.3], [-0.5, 1.0]])
    return make_nodes(axis, places, Motion(axis.basis, strong, np.array([0.5, 0.2])), tolerance_m, most)


def joint_basis(nodes: Nodes) -> np.ndarray:
    first, second = nodes.joint_nodes.astype(int).T
    share = nodes.joint_share[:, None, None]
    return (1 - share) * nodes.basis[first] + share * nodes.basis[second]


@pytest.mark.parametrize("tolerance_m", [0.05, 0.005, 0.0005])
def test_no_place_on_the_axis_deviates_beyond_the_tolerance(tolerance_m: float) -> None:
    axis, places = pole(), every_place(pole(), 1)
    nodes = nodes_of(axis, places, tolerance_m)
    found = joint_basis(nodes)[nodes.vertex_joint]
    height = nodes.joint_rest_m[nodes.vertex_joint, 1]
    exact = np.zeros_like(found)
    exact[:, 0, 0] = exact[:, 2, 1] = (height / 10) ** 2
    off = np.linalg.norm((found - exact) @ np.array([1.0, 0.3]), axis=1)
    assert off.max() <= tolerance_m + 3e-5  # joints lie between points, where the exact motion is curved
    assert np.abs(nodes.joint_rest_m[nodes.vertex_joint, 1] - place_of(axis, places)[:, 1]).max() < 0.01


def place_of(axis: Pole, places: Places) -> np.ndarray:
    start = axis.points_m[axis.parent[places.child]]
    return start + places.share[:, None] * (axis.points_m[places.child] - start)


def test_the_number_of_nodes_falls_with_the_tolerance_and_is_limited() -> None:
    axis, places = pole(), every_place(pole(), 2)
    counts = [len(nodes_of(axis, places, tolerance_m).rest_m) for tolerance_m in (0.1, 0.01, 0.001)]
    assert counts == sorted(counts) and counts[0] < 6 < counts[2]
    assert len(nodes_of(axis, places, 1e-9, most=20).rest_m) <= 20


def test_a_branch_that_is_carried_rigidly_has_no_node_but_its_base() -> None:
    axis, places = pole(), every_place(pole(), 3)
    nodes = nodes_of(axis, places, 0.01)
    assert not (nodes.rest_m[:, 0] > 0).any()
    beside = place_of(axis, places)[:, 0] > 0
    held = nodes.joint_nodes[nodes.vertex_joint[beside]]
    assert (held == held[0, 0]).all()
    np.testing.assert_allclose(nodes.rest_m[held[0, 0]], (0, 5, 0), atol=1e-6)


def test_nodes_follow_those_before_them() -> None:
    nodes = nodes_of(pole(), every_place(pole(), 4), 0.002)
    parent = nodes.parent.astype(int)
    own = np.arange(len(parent))
    assert (parent <= own).all() and (parent == own).sum() == 1
    rise = nodes.rest_m[1:, 1] - nodes.rest_m[parent[1:], 1]
    assert (rise > 0).all()


def test_lines_cover_every_point_once_and_go_on_along_the_longest() -> None:
    axis = pole()
    lines = branch_lines(axis.points_m, axis.parent)
    assert sorted(np.concatenate([line.own for line in lines]).tolist()) == list(range(len(axis.parent)))
    assert [line.limb for line in lines] == [-1, 50]
    assert len(lines[0].own) == 101


def test_points_that_turn_are_kept_although_they_hardly_move() -> None:
    axis = pole(beside=1)
    moved = np.zeros((len(axis.points_m), 3, 1))
    turned = np.zeros_like(moved)
    turned[60:101, 2, 0] = np.linspace(0, 1, 41)
    knots = choose_knots(AxisMotion(axis.points_m, axis.parent, moved, turned, 0.2), 0.01, 100)
    assert len(knots.nodes) >= 3 and np.abs(knots.nodes - 60).min() <= 3
