"""Bark is held so that forks and sharp bends stretch no edge far; elsewhere it is held beside itself."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.mesh.types import RenderPrimitive
from galewood.model import Axis, Feet, chosen, welded_wood
from galewood.model.bark import bark_feet
from galewood.model.eased import AxisPaths, axis_paths, eased
from galewood.reduction.calm_bark import AxisPoses, calmed
from galewood.table import turned
from galewood.util import Floats, Ints
from scipy.sparse import csr_matrix

from tests.precompute import tree_meshes as make

SEED = 3


def axis_of(points_m: Floats, parent: Ints, radius_m: float) -> Axis:
    none = csr_matrix((0, 0))
    return Axis(points_m, parent, np.full(len(parent), radius_m), none, none)


def random_paths() -> AxisPaths:
    """A random tree of 60 points and a second, separate root."""
    rng = np.random.default_rng(SEED)
    parent = np.array([-1, *(int(rng.integers(0, k)) for k in range(1, 60)), -1])
    return AxisPaths(rng.random((61, 3)), parent)


def way_to_root(parent: Ints, point: int) -> list[int]:
    way = [point]
    while parent[way[-1]] >= 0:
        way.append(int(parent[way[-1]]))
    return way


def test_ways_meet_where_a_search_finds_it() -> None:
    paths = random_paths()
    one, other = (grid.ravel() for grid in np.meshgrid(np.arange(61), np.arange(61)))
    found = paths.meeting(one, other)
    for a, b, meet in zip(one.tolist(), other.tolist(), found.tolist(), strict=True):
        common = [p for p in way_to_root(paths.parent, a) if p in way_to_root(paths.parent, b)]
        assert meet == (common[0] if common else -1), f"seed {SEED}: {a}, {b}"


def test_places_and_feet_are_the_same() -> None:
    paths, rng = random_paths(), np.random.default_rng(SEED)
    child = np.flatnonzero(paths.parent >= 0)
    share = rng.random(len(child))
    start = paths.points_m[paths.parent[child]]
    feet = Feet(child, share, start + share[:, None] * (paths.points_m[child] - start), np.zeros(len(child)))
    again = paths.feet(*paths.places(feet), feet.distance_m)
    np.testing.assert_allclose(again.at_m, feet.at_m, atol=1e-12)
    np.testing.assert_array_equal(paths.links(*paths.places(feet)), child)


def pole(count: int = 41, length_m: float = 4.0) -> Axis:
    points = np.zeros((count, 3))
    points[:, 1] = np.linspace(0, length_m, count)
    return axis_of(points, np.arange(-1, count - 1), 0.2)


def pole_wood() -> RenderPrimitive:
    tube = make.tube((0, 0, 0), (0, 4, 0), 0.2, 0.2, sides=10, rings=21)
    return RenderPrimitive("wood_0", "wood", tube.vertices, tube.faces)


def test_a_straight_limb_is_held_beside_itself() -> None:
    axis, wood = pole(), pole_wood()
    feet = bark_feet(wood, axis)
    inner = np.abs(wood.positions_m[:, 1] - 2) < 1.7
    np.testing.assert_allclose(feet.at_m[inner, 1], wood.positions_m[inner, 1], atol=0.02)


def fork() -> tuple[Axis, Floats, Ints, Feet]:
    """Two limbs from a fork at 1 m, and an edge of 0.05 m between vertices held 0.2 m up each limb."""
    up = np.linspace(0, 1, 11)
    trunk = np.stack([0 * up, up, 0 * up], axis=1)
    limbs = [np.stack([s * up[1:], 1 + up[1:], 0 * up[1:]], axis=1) for s in (-0.3, 0.3)]
    parent = np.array([*range(-1, 10), 10, *range(11, 20), 10, *range(21, 30)])
    axis = axis_of(np.concatenate([trunk, *limbs]), parent, 0.2)
    place = np.array([(-0.025, 1.2, 0), (0.025, 1.2, 0)])
    child = np.array([12, 22])
    feet = Feet(child, np.ones(2), axis.points_m[child], np.zeros(2))
    return axis, place, np.array([[0, 1]]), feet


def test_neighbours_on_two_limbs_are_held_near_their_fork() -> None:
    axis, place, ends, feet = fork()
    paths = axis_paths(axis)
    before = np.linalg.norm(np.diff(feet.at_m, axis=0))
    found = eased(feet, place, ends, axis)
    _, mark = paths.places(found)
    assert before > 0.1
    assert float((mark - 1.0).sum()) < 1.4 * 0.05 + 1e-6, "the way is hardly longer than the edge"
    assert (mark >= 1.0 - 1e-9).all(), "no place is moved farther than to the fork"


def stretch(wood: RenderPrimitive, feet: Feet, axis: Axis, poses: AxisPoses) -> float:
    """The longest edge over its length at rest, in the first pose."""
    up, share = axis.parent[feet.child], feet.share[:, None]
    moved, turn = (
        (1 - share) * rows[up, :, 0] + share * rows[feet.child, :, 0]
        for rows in (poses.moved_m, poses.turned)
    )
    now = feet.at_m + moved + turned(wood.positions_m - feet.at_m, turn)
    welded = welded_wood(wood)
    ends = welded.first[welded.ends]
    lengths = [np.linalg.norm(x[ends[:, 0]] - x[ends[:, 1]], axis=1) for x in (now, wood.positions_m)]
    return float((lengths[0] / lengths[1]).max())


@pytest.mark.parametrize("angle", [0.3, 0.6])
def test_a_sharp_bend_is_spread_over_more_edges(angle: float) -> None:
    axis, wood = pole(), pole_wood()
    height = axis.points_m[:, 1]
    at = angle * np.clip((height - 1.9) / 0.2, 0, 1)  # all within 0.2 m, a single ring
    step = np.diff(height, prepend=0.0)
    now = np.cumsum(np.stack([np.sin(at) * step, np.cos(at) * step, 0 * step], axis=1), axis=0)
    poses = AxisPoses(
        (now - axis.points_m)[:, :, None], np.stack([0 * at, 0 * at, -np.sin(at)], 1)[:, :, None]
    )
    feet, welded = bark_feet(wood, axis), welded_wood(wood)
    held = chosen(calmed(welded, chosen(feet, welded.first), axis, poses), welded.same)
    before, after = (stretch(wood, one, axis, poses) for one in (feet, held))
    assert before > 1 + 0.4 * angle
    assert after < 1 + 0.7 * (before - 1)


def test_a_calm_limb_keeps_its_places() -> None:
    axis, wood = pole(), welded_wood(pole_wood())
    still = AxisPoses(np.zeros((41, 3, 1)), np.zeros((41, 3, 1)))
    feet = axis.feet(wood.place_m)
    calm = calmed(wood, feet, axis, still)
    np.testing.assert_allclose(calm.at_m, feet.at_m, atol=1e-9)
