"""A limb keeps its stiffness where twigs grow out of its axis."""

import numpy as np
from galewood.check.verify.bars import polygon_bar
from galewood.solid.tets.radius_ratio import radius_ratio
from galewood.solid.tets.thicken import thicken

from tests.precompute.fixtures import tree_meshes as make

FLOOR_M = 0.03
TRUNK_M, TWIG_M = 0.12, 0.012


def trunk_with_twigs():
    """A trunk with twelve twigs that begin on its axis, as produced by tree generators."""
    heights, turns = np.linspace(0.8, 3.6, 12), np.arange(12) * 2.4
    twigs = [
        make.tube((0, h, 0), (0.9 * np.cos(t), h + 0.5, 0.9 * np.sin(t)), TWIG_M, TWIG_M, sides=5)
        for h, t in zip(heights, turns, strict=True)
    ]
    return make.joined(make.tube((0, 0, 0), (0, 4, 0), TRUNK_M, TRUNK_M, sides=12), *twigs)


def test_twigs_that_begin_inside_a_trunk_do_not_reduce_its_stiffness():
    solid = polygon_bar(sides=12, radius_m=TRUNK_M, length_m=4.0, layers=30, rings=2)
    ratio = radius_ratio(thicken(trunk_with_twigs(), FLOOR_M), solid.vertices_m, solid.tets, FLOOR_M)
    assert np.median(ratio) > 0.99
    assert np.mean(ratio > 0.9) > 0.9


def test_tets_of_a_twig_have_its_radius_ratio():
    twig = make.tube((0, 0, 0), (0, 1, 0), TWIG_M, TWIG_M, sides=8)
    solid = polygon_bar(sides=8, radius_m=FLOOR_M, length_m=1.0, layers=20, rings=1)
    ratio = radius_ratio(thicken(twig, FLOOR_M), solid.vertices_m, solid.tets, FLOOR_M)
    assert abs(np.median(ratio) - TWIG_M / FLOOR_M) < 0.06
