"""A limb keeps its own stiffness where twigs grow out of its axis."""

import numpy as np

from precompute.radius_ratio import radius_ratio
from precompute.tetrahedra import tetrahedralise
from precompute.thicken import thicken
from tests.precompute import tree_meshes as make


def test_twigs_that_begin_inside_a_trunk_do_not_soften_it(tmp_path):
    trunk = make.tube((0, 0, 0), (0, 4, 0), 0.12, 0.12, sides=12)
    heights = np.linspace(0.8, 3.6, 12)
    turns = np.arange(12) * 2.4
    twigs = [
        make.tube((0, h, 0), (0.9 * np.cos(t), h + 0.5, 0.9 * np.sin(t)), 0.012, 0.012, sides=5)
        for h, t in zip(heights, turns, strict=True)
    ]
    wood = make.joined(trunk, *twigs)
    floor_m = 0.03
    raised = thicken(wood, floor_m)
    mesh = tetrahedralise(make.as_tree(wood), target_tets=1500, cache_dir=tmp_path)
    ratio = radius_ratio(raised, mesh.vertices_m, mesh.tets, floor_m)
    centre = mesh.vertices_m[mesh.tets].mean(axis=1)
    away = np.hypot(centre[:, 0], centre[:, 2])
    assert np.median(ratio[away < 0.09]) > 0.99
    assert np.quantile(ratio[away < 0.09], 0.1) > 0.9
    assert np.median(ratio[away > 0.25]) < 0.5
