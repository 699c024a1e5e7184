"""Arc lengths, common ancestors and links of paths along the axis are those that a walk finds."""

from __future__ import annotations

import numpy as np
from galewood.solid.skinning.bindings import AxisPaths, Bindings

from tests.precompute.solid.skinning.poles import path_to_root

SEED = 3


def random_paths() -> AxisPaths:
    """A random tree of 60 points and a second, separate root."""
    rng = np.random.default_rng(SEED)
    parent = np.array([-1, *(int(rng.integers(0, k)) for k in range(1, 60)), -1])
    return AxisPaths(rng.random((61, 3)), parent)


def test_common_ancestors_are_those_of_a_search() -> None:
    paths = random_paths()
    one, other = (grid.ravel() for grid in np.meshgrid(np.arange(61), np.arange(61)))
    found = paths.common_ancestors(one, other)
    for a, b, meet in zip(one.tolist(), other.tolist(), found.tolist(), strict=True):
        common = [p for p in path_to_root(paths.parent, a) if p in path_to_root(paths.parent, b)]
        assert meet == (common[0] if common else -1), f"seed {SEED}: {a}, {b}"


def test_places_and_bindings_are_the_same() -> None:
    paths, rng = random_paths(), np.random.default_rng(SEED)
    child = np.flatnonzero(paths.parent >= 0)
    share = rng.random(len(child))
    start = paths.points_m[paths.parent[child]]
    at_m = start + share[:, None] * (paths.points_m[child] - start)
    bindings = Bindings(child, share, at_m, np.zeros(len(child)))
    again = paths.bindings(*paths.places(bindings), bindings.distance_m)
    np.testing.assert_allclose(again.at_m, bindings.at_m, atol=1e-12)
    np.testing.assert_array_equal(paths.links(*paths.places(bindings)), child)


def test_links_towards_a_point_are_those_of_a_walk() -> None:
    paths, rng = random_paths(), np.random.default_rng(SEED)
    end = rng.integers(1, 60, 300)
    arc = rng.random(300) * paths.arc_m[end]
    found = paths.links_towards(end, arc)
    for point, at, link in zip(end.tolist(), arc.tolist(), found.tolist(), strict=True):
        while paths.arc_m[paths.parent[point]] > at and paths.parent[paths.parent[point]] >= 0:
            point = int(paths.parent[point])
        assert link == point, f"seed {SEED}"


def test_the_end_of_the_line_through_a_point_is_the_farthest_beyond_it() -> None:
    paths = random_paths()
    for point in range(61):
        beyond = [p for p in range(61) if point in path_to_root(paths.parent, p)]
        assert paths.arc_m[paths.line_ends[point]] == max(paths.arc_m[beyond]), f"seed {SEED}"
