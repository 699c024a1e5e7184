"""Nodes: points of the axis between which the motion of all others is interpolated within a tolerance."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.solid.skinning import Axis, Bindings, MotionSamples, Skin, joint_rows, make_skin
from galewood.solid.skinning.node_poses import vertex_rows
from galewood.util import Floats
from scipy.sparse import csr_matrix

from tests.precompute.solid.skinning.poles import pole_with_branch


def bending(axis: Axis) -> Floats:
    """A basis that bends the pole in two directions; branches are carried by their bases without turning."""
    height = np.where(axis.points_m[:, 0] > 0, axis.points_m[axis.parent, 1], axis.points_m[:, 1])
    basis = np.zeros((len(height), 3, 2))
    basis[:, 0, 0] = basis[:, 2, 1] = (height / 10) ** 2
    return basis


def random_bindings(axis: Axis, seed: int) -> Bindings:
    rng = np.random.default_rng(seed)
    child = rng.integers(1, len(axis.points_m), 3000)
    share = rng.uniform(size=3000)
    start = axis.points_m[axis.parent[child]]
    at_m = start + share[:, None] * (axis.points_m[child] - start)
    return Bindings(child, share, at_m, np.zeros(3000))


def skin_of(axis: Axis, bindings: Bindings, tolerance_m: float, most: int = 768) -> Skin:
    strong = np.array([[1.0, 0.3], [-0.5, 1.0]])
    samples = MotionSamples(bending(axis), strong, np.array([0.5, 0.2]))
    return make_skin(axis, bindings, samples, tolerance_m, most)


@pytest.mark.parametrize("tolerance_m", [0.05, 0.005, 0.0005])
def test_no_place_on_the_axis_deviates_beyond_the_tolerance(tolerance_m: float) -> None:
    axis, bindings = pole_with_branch(), random_bindings(pole_with_branch(), 1)
    skin = skin_of(axis, bindings, tolerance_m)
    found = joint_rows(skin, skin.node_basis)[skin.vertex_joint]
    height = skin.joint_rest_m[skin.vertex_joint, 1]
    exact = np.zeros_like(found)
    exact[:, 0, 0] = exact[:, 2, 1] = (height / 10) ** 2
    off = np.linalg.norm((found - exact) @ np.array([1.0, 0.3]), axis=1)
    assert off.max() <= tolerance_m + 3e-5  # joints lie between points, where the exact motion is curved
    assert np.abs(skin.joint_rest_m[skin.vertex_joint, 1] - bindings.at_m[:, 1]).max() < 0.01


def test_the_number_of_nodes_falls_with_the_tolerance_and_is_limited() -> None:
    axis, bindings = pole_with_branch(), random_bindings(pole_with_branch(), 2)
    counts = [len(skin_of(axis, bindings, tolerance_m).node_rest_m) for tolerance_m in (0.1, 0.01, 0.001)]
    assert counts == sorted(counts) and counts[0] < 6 < counts[2]
    assert len(skin_of(axis, bindings, 1e-9, most=20).node_rest_m) <= 20


def test_a_branch_that_is_carried_rigidly_needs_no_node() -> None:
    axis, bindings = pole_with_branch(), random_bindings(pole_with_branch(), 3)
    skin = skin_of(axis, bindings, 0.01)
    assert not (skin.node_rest_m[:, 0] > 0).any()
    joint = skin.vertex_joint[bindings.at_m[:, 0] > 0]
    assert (joint == joint[0]).all()
    np.testing.assert_allclose(skin.joint_rest_m[joint[0]], (0, 5, 0), atol=1e-6)
    bare = skin_of(axis, bindings.take(np.flatnonzero(bindings.at_m[:, 0] == 0)), 0.01)
    np.testing.assert_array_equal(skin.node_rest_m, bare.node_rest_m)


def test_nodes_follow_those_before_them() -> None:
    skin = skin_of(pole_with_branch(), random_bindings(pole_with_branch(), 4), 0.002)
    parent = skin.node_parent.astype(int)
    own = np.arange(len(parent))
    assert (parent <= own).all() and (parent == own).sum() == 1
    rise = skin.node_rest_m[1:, 1] - skin.node_rest_m[parent[1:], 1]
    assert (rise > 0).all()


def test_hundreds_of_twigs_do_not_use_up_the_nodes() -> None:
    stem = pole_with_branch(points=1001, beside=1)
    tips = stem.points_m[100:1000] + np.array([0.3, 0, 0])
    points = np.concatenate([stem.points_m, tips])
    parent = np.concatenate([stem.parent, np.arange(100, 1000)])
    moved = csr_matrix(np.eye(len(points)))
    axis = Axis(points, parent, np.full(len(points), 0.01), moved, csr_matrix((3 * len(points),) * 2))
    skin = skin_of(axis, random_bindings(axis, 5), 0.01, most=100)
    assert len(skin.node_rest_m) < 20, "as many as without the twigs"
    assert skin.max_error_m < 0.01


def test_a_crooked_limb_between_two_nodes_turns_as_a_whole() -> None:
    """Points of the axis that no node is kept for do not stay behind beside the line between the nodes."""
    points = np.zeros((21, 3))
    points[:, 1] = np.linspace(0, 4, 21)
    points[1:-1, 0] = np.random.default_rng(4).uniform(-0.1, 0.1, 19)
    basis = np.cross(np.eye(3)[None], points[:, None]).transpose(0, 2, 1)  # ω × x for ω along each axis
    turn = np.tile(np.eye(3), (21, 1)) @ np.linalg.pinv(basis.reshape(63, 3))
    axis = Axis(points, np.arange(-1, 20), np.full(21, 0.1), csr_matrix(np.eye(21)), csr_matrix(turn))
    child = np.arange(1, 21)
    bindings = Bindings(child, np.ones(20), points[child], np.zeros(20))
    skin = make_skin(axis, bindings, MotionSamples(basis, np.eye(3), np.ones(3)), tolerance_m=0.2)
    assert len(skin.node_rest_m) == 2
    vertices = points[child] + [0.1, 0.0, 0.05]
    exact = np.cross(np.eye(3)[None], vertices[:, None]).transpose(0, 2, 1)
    np.testing.assert_allclose(vertex_rows(skin, vertices), exact, atol=1e-5)
    assert skin.max_error_m < 1e-6
