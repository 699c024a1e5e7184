"""Branches along limbs that are drawn as closed cylinders which overlap."""

from __future__ import annotations

import numpy as np
from galewood.solid.skeleton import is_chained, joined_outline
from galewood.tree import Surface

from tests.precompute.fixtures.tree_meshes import joined, tube, y_tree

Line = tuple[np.ndarray, np.ndarray]


def cylinders(lines: list[Line], random: np.random.Generator) -> Surface:
    """Each link a closed cylinder that reaches into the next one, by up to half of its length."""
    drawn: list[Surface] = []
    for points, radii in lines:
        for a, b, r in zip(points, points[1:], radii, strict=False):
            end = b + random.uniform(0.0, 0.5) * (b - a)
            drawn.append(tube(a, end, r, r, sides=8, rings=2))
    return joined(*drawn)


def test_joined_cylinders_have_the_radius_of_each() -> None:
    rise = np.column_stack([np.zeros(13), np.linspace(0, 3.0, 13), np.zeros(13)])
    surface = cylinders([(rise, np.full(13, 0.05))], np.random.default_rng(5))
    assert is_chained(surface.vertices, surface.faces)
    outline = joined_outline(surface.vertices, surface.faces)
    inner = (outline.points_m[:, 1] > 0.3) & (outline.points_m[:, 1] < 2.7)
    assert outline.branch.max() == 0
    area_share = np.sin(2 * np.pi / 8) * 8 / 2 / np.pi  # of an octagon in its circle
    np.testing.assert_allclose(outline.radius_m[inner], 0.05 * np.sqrt(area_share), rtol=0.16)


def test_limbs_that_are_tubes_are_no_chains() -> None:
    surface = y_tree()
    assert not is_chained(surface.vertices, surface.faces)
