"""The axis turns as the wood does; places near to the bark are found on it."""

from __future__ import annotations

import numpy as np
from galewood.solid.skeleton import extract_skeleton
from galewood.solid.skinning import axis_of_tets

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.tet_meshes import Y_SEGMENTS, y_mesh


def test_the_axis_of_tets_moves_and_turns_with_a_rigid_motion() -> None:
    mesh = y_mesh()
    axis = axis_of_tets(mesh, extract_skeleton(mesh))
    spin, shift = np.array([0.01, -0.02, 0.03]), np.array([0.1, 0.2, -0.3])
    moved = np.cross(spin, mesh.vertices_m) + shift
    np.testing.assert_allclose(
        axis.rotation(moved[:, :, None])[:, :, 0], np.tile(spin, (len(axis.parent), 1)), atol=1e-9
    )
    found = axis.displacement(moved[:, :, None])[:, :, 0]
    expected = np.cross(spin, axis.points_m) + shift
    assert np.abs(found - expected).max() < 0.03 * 0.05  # a point outside the wood moves with the nearest tet


def test_the_nearest_places_are_beside_the_bark() -> None:
    mesh = y_mesh()
    axis = axis_of_tets(mesh, extract_skeleton(mesh))
    wood = make.joined(*(make.tube(a, b, r, r) for a, b, r in Y_SEGMENTS))
    nearest = axis.nearest(wood.vertices)
    thickest = max(radius for _, _, radius in Y_SEGMENTS)
    assert np.linalg.norm(wood.vertices - nearest.at_m, axis=1).max() < 2.5 * thickest
    start = axis.points_m[axis.parent[nearest.child]]
    along = start + nearest.share[:, None] * (axis.points_m[nearest.child] - start)
    np.testing.assert_allclose(along, nearest.at_m, atol=1e-9)
