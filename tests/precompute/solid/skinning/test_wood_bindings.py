"""Wood is bound beside itself; bindings at forks are near to each other."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from galewood.solid.skinning import Axis, Bindings
from galewood.solid.skinning.wood_bindings import (
    limited_slope,
    welded_primitive,
    without_islands,
    wood_bindings,
)
from galewood.tree.repair import Surface
from galewood.tree.types import RenderPrimitive
from galewood.util import Floats, Ints

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.solid.skinning.poles import axis_of, path_to_root, pole, pole_wood


def test_a_straight_limb_is_bound_beside_itself() -> None:
    axis, wood = pole(), pole_wood()
    bindings = wood_bindings(wood, axis)
    inner = np.abs(wood.positions_m[:, 1] - 2) < 1.7
    np.testing.assert_allclose(bindings.at_m[inner, 1], wood.positions_m[inner, 1], atol=0.02)


def fork() -> tuple[Axis, Floats, Ints, Bindings]:
    """Two limbs from a fork at 1 m, and an edge of 0.05 m between vertices bound 0.2 m up each limb."""
    up = np.linspace(0, 1, 11)
    trunk = np.stack([0 * up, up, 0 * up], axis=1)
    limbs = [np.stack([s * up[1:], 1 + up[1:], 0 * up[1:]], axis=1) for s in (-0.3, 0.3)]
    parent = np.array([*range(-1, 10), 10, *range(11, 20), 10, *range(21, 30)])
    axis = axis_of(np.concatenate([trunk, *limbs]), parent, 0.2)
    place = np.array([(-0.025, 1.2, 0), (0.025, 1.2, 0)])
    child = np.array([12, 22])
    bindings = Bindings(child, np.ones(2), axis.points_m[child], np.zeros(2))
    return axis, place, np.array([[0, 1]]), bindings


def test_neighbours_on_two_limbs_are_bound_near_their_fork() -> None:
    axis, place, ends, bindings = fork()
    before = np.linalg.norm(np.diff(bindings.at_m, axis=0))
    _, arc = axis.paths.places(limited_slope(bindings, place, ends, axis))
    assert before > 0.1
    assert float((arc - 1.0).sum()) < 1.4 * 0.05 + 1e-6, "the path is hardly longer than the edge"
    assert (arc >= 1.0 - 1e-9).all(), "no binding is moved farther than to the fork"


def crossing() -> tuple[Axis, RenderPrimitive]:
    """A stem of 4 m with two limbs that cross 1.4 m from it, almost touching, each a tube of its own."""
    up, out = np.linspace(0, 4, 41), np.linspace(0.05, 2, 40)[:, None]
    stem = np.stack([0 * up, up, 0 * up], axis=1)
    limbs = [np.array([0, 1.0, 0]) + out * [1, 1, 0], np.array([0, 3.8, 0.03]) + out * [1, -1, 0]]
    parent = np.array([*range(-1, 40), 10, *range(41, 80), 38, *range(81, 120)])
    axis = axis_of(np.concatenate([stem, *limbs]), parent, 0.02)
    tubes = [make.tube(limb[0], limb[-1], 0.02, 0.02, sides=8, rings=61) for limb in limbs]
    wood = make.joined(*tubes)
    return axis, RenderPrimitive("wood_0", "wood", wood.vertices, wood.faces)


def test_where_limbs_cross_every_vertex_is_held_by_its_own() -> None:
    axis, wood = crossing()
    welded = welded_primitive(wood)
    right = axis.nearest(welded.place_m)
    swapped = np.linalg.norm(welded.place_m - [1.4, 2.4, 0], axis=1) < 0.15
    other = np.where(right.child <= 80, right.child + 40, right.child - 40)
    wrong = right.replaced(np.arange(len(other)), Bindings(other, right.share, right.at_m, right.distance_m))
    confused = Bindings.concatenated([right, wrong]).take(np.arange(len(other)) + len(other) * swapped)
    assert swapped.sum() > 20 and swapped.mean() < 0.2
    found = without_islands(confused, welded.place_m, welded, axis)
    np.testing.assert_array_equal(found.child[swapped] > 80, right.child[swapped] > 80)
    np.testing.assert_allclose(found.at_m[~swapped], right.at_m[~swapped])


def test_a_small_piece_without_a_branch_is_rigid() -> None:
    axis, stem = pole(), pole_wood()
    twig = make.tube((0.15, 2, 0), (0.5, 2.3, 0), 0.01, 0.01, sides=6, rings=5)
    body = make.joined(Surface(stem.positions_m, stem.faces), twig)
    found = wood_bindings(RenderPrimitive("wood_0", "wood", body.vertices, body.faces), axis)
    own = found.at_m[len(stem.positions_m) :]
    np.testing.assert_allclose(own, np.broadcast_to(own[:1], own.shape))
    assert abs(own[0, 1] - 2.0) < 0.1, "where it grows"


def limb_with_a_twig_inside() -> tuple[Axis, RenderPrimitive]:
    """A limb of 4 m, a tube of its own, whose axis runs 0.1 m beside its middle from 1 to 2.5 m up.

    There the axis of a twig from 1 m up is nearer to the middle of the tube.
    """
    limb = pole().points_m.copy()
    limb[11:26, 0] = 0.1
    twig = np.stack([0 * limb[11:26, 1], limb[11:26, 1], 0 * limb[11:26, 1]], axis=1)
    parent = np.array([*range(-1, 40), 10, *range(41, 55)])
    tube = make.tube((0, 0, 0), (0, 4, 0), 0.03, 0.03, sides=8, rings=41)
    wood = RenderPrimitive("wood_0", "wood", tube.vertices, tube.faces)
    return axis_of(np.concatenate([limb, twig]), parent, 0.03), wood


def test_a_limb_is_bound_along_one_line_where_a_twig_runs_inside_it() -> None:
    axis, wood = limb_with_a_twig_inside()
    welded = welded_primitive(wood)
    first = axis.nearest(wood.positions_m)
    assert (first.child > 40).mean() > 0.2, "some rings are nearest to the twig"
    bindings = wood_bindings(wood, axis)
    assert set(bindings.child.tolist()) <= set(path_to_root(axis.parent, 40)), "all are held by the limb"
    _, arc = axis.paths.places(bindings.take(welded.first))
    assert np.abs(np.diff(arc[welded.ends], axis=1)).max() < 0.3, (
        "edges of 0.1 m; the axis steps aside by 0.1"
    )


def test_the_nearest_place_on_a_path_is_that_of_all_its_links() -> None:
    axis, _ = crossing()
    points = np.random.default_rng(3).uniform([-1, 0, -1], [2, 4, 1], (50, 3))
    found = axis.nearest_on_path(points, 70)
    path = path_to_root(axis.parent, 70)
    share = np.linspace(0, 1, 101)[:, None]
    places = [axis.points_m[up] * (1 - share) + axis.points_m[own] * share for own, up in pairwise(path)]
    off = np.linalg.norm(points[:, None] - np.concatenate(places), axis=2).min(axis=1)
    np.testing.assert_allclose(np.linalg.norm(points - found.at_m, axis=1), off, atol=1e-3)
