"""Branches along limbs that are drawn as closed cylinders which overlap."""

from __future__ import annotations

import numpy as np
from galewood.options import ImportRequest
from galewood.pipeline.tables import expected_motion, motion_lines
from galewood.solid.model import beam_model
from galewood.solid.skeleton import is_chained, joined_outline
from galewood.tree import Surface, read_tree
from galewood.wood import wood_of_species

from tests.precompute.fixtures.tree_meshes import joined, obj_bytes, tube, y_tree

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


def test_nothing_is_promised_of_a_tree_of_overlapping_cylinders() -> None:
    """Its first frequency depends on how they hold on to each other, which beams do not know."""
    seed = 20
    print(f"seed {seed}")
    random = np.random.default_rng(seed)
    trunk = np.column_stack([np.zeros(15), np.linspace(0, 7.0, 15), np.zeros(15)])
    lines = [(trunk, np.linspace(0.14, 0.05, 15))]
    for k in range(5, 14):
        out = np.array([random.normal(), 0.6, random.normal()])
        lines.append(
            (trunk[k] + np.linspace(0, 1.6, 5)[:, None] * out / np.linalg.norm(out), np.full(5, 0.03))
        )
    surface = cylinders(lines, random)
    tree = read_tree(obj_bytes(surface), "chains.obj", ImportRequest(species="maple", accept=True))
    assert is_chained(surface.vertices, surface.faces)
    assert beam_model(tree, wood_of_species("maple")).chained
    assert expected_motion(tree) is None
    assert motion_lines(None)[0].startswith("Unsure how far it sways")
