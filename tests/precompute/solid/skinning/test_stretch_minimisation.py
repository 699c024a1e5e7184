"""The gradient of the stretch is that of differences; the hardest poses are those that stretch most."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.solid.skinning.node_poses import turned
from galewood.solid.skinning.stretch_minimisation import (
    AxisPoses,
    EdgeMesh,
    StretchMinimisation,
    hardest_poses,
    posed_positions,
)
from galewood.solid.skinning.wood_bindings import welded_primitive

from tests.precompute.solid.skinning.poles import flared

SEED = 11


def test_the_gradient_of_the_cost_is_that_of_differences() -> None:
    axis, wood, poses = flared()
    welded, paths = welded_primitive(wood), axis.paths
    mesh = EdgeMesh(welded.place_m, welded.ends, np.sqrt(welded.squared_m2))
    child, arc = paths.places(axis.nearest(mesh.place_m))
    arc = np.clip(arc, 0.06, 5.9) + 1e-3 * np.random.default_rng(SEED).random(len(arc))
    problem = StretchMinimisation(mesh, child, arc, np.arange(5, len(arc)), paths, poses)
    at = arc[5:] / problem.unit_m
    _, gradient = problem.cost(at)
    for k in (0, 17, 40):
        step = np.zeros(len(at))
        step[k] = 1e-5
        difference = (problem.cost(at + step)[0] - problem.cost(at - step)[0]) / 2e-5
        assert gradient[k] == pytest.approx(difference, rel=0.02, abs=1e-3 * np.abs(gradient).max())


def test_the_hardest_pose_is_that_of_the_farthest_bend() -> None:
    axis, wood, pose = flared()
    welded = welded_primitive(wood)
    mesh = EdgeMesh(welded.place_m, welded.ends, np.sqrt(welded.squared_m2))
    shares = np.array([0.2, 1.0, 0.5, 0.0])
    poses = AxisPoses(pose.moved_m * shares, pose.turned * shares)
    found = hardest_poses(mesh, axis.nearest(mesh.place_m), axis.paths, poses, 1)
    np.testing.assert_array_equal(found.turned, pose.turned)


def test_vertices_are_posed_as_the_player_draws_them() -> None:
    axis, wood, _ = flared()
    place_m, paths = welded_primitive(wood).place_m, axis.paths
    rng = np.random.default_rng(SEED)
    poses = AxisPoses(*rng.normal(size=(2, len(axis.points_m), 3, 5)))
    child, arc = paths.places(axis.nearest(place_m))
    bound = paths.bindings(child, arc, np.zeros(len(child)))
    up, share = paths.parent[child], bound.share[:, None, None]
    moved, turn = (
        ((1 - share) * of[up] + share * of[child]).transpose(0, 2, 1) for of in (poses.moved_m, poses.turned)
    )
    expected = bound.at_m[:, None] + moved + turned((place_m - bound.at_m)[:, None], turn)
    np.testing.assert_allclose(posed_positions(place_m, child, arc, paths, poses), expected, atol=1e-12)
