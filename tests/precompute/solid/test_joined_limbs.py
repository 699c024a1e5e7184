"""Beams along limbs that are drawn as closed cylinders which overlap, compared with the finite elements."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from galewood.options import ImportRequest
from galewood.pipeline.tables import expected_motion
from galewood.solid.fem import FemSettings
from galewood.solid.model import tree_model
from galewood.solid.skeleton import is_chained, joined_outline
from galewood.tree import Surface, TreeMesh
from galewood.tree.importer import read_tree
from galewood.wood import wood_of_species

from tests.precompute.fixtures.tree_meshes import joined, obj_bytes, tube, y_tree

WOOD = wood_of_species("default")
Line = tuple[np.ndarray, np.ndarray]


def limbs(random: np.random.Generator) -> list[Line]:
    """Points and radii along the trunk and its limbs, which carry twigs."""
    rise = np.column_stack([np.zeros(9), np.linspace(0, 4.0, 9), np.zeros(9)])
    lines: list[Line] = [(rise, np.linspace(0.09, 0.03, 9))]
    for k in range(int(random.integers(9, 13))):
        share, turn = random.uniform(0.3, 0.95), 2.4 * k + random.uniform(-0.3, 0.3)
        out = np.array([np.cos(turn), random.uniform(0.5, 1.1), np.sin(turn)])
        length_m, radius_m = random.uniform(0.7, 1.3), random.uniform(0.45, 0.6) * (0.09 - 0.06 * share)
        points, radii = grown(np.array([0, 4 * share, 0]), out, length_m, radius_m, 6)
        lines.append((points, radii))
        for _ in range(int(random.integers(3, 6))):
            at = int(random.integers(2, 5))
            side = out + random.normal(0, 0.7, 3)
            lines.append(grown(points[at], side, random.uniform(0.2, 0.45), 0.5 * radii[at], 3))
    return lines


def grown(foot: np.ndarray, along: np.ndarray, length_m: float, radius_m: float, count: int) -> Line:
    steps = np.linspace(0, length_m, count)[:, None] * along / np.linalg.norm(along)
    return foot + steps, np.linspace(radius_m, 0.5 * radius_m, count)


def cylinders(lines: list[Line], random: np.random.Generator) -> Surface:
    """Each link a closed cylinder that reaches into the next one, by up to half of its length."""
    drawn: list[Surface] = []
    for points, radii in lines:
        for a, b, r in zip(points, points[1:], radii, strict=False):
            end = b + random.uniform(0.0, 0.5) * (b - a)
            drawn.append(tube(a, end, r, r, sides=8, rings=2))
    return joined(*drawn)


def drawn_tree(seed: int) -> TreeMesh:
    random = np.random.default_rng(seed)
    surface = cylinders(limbs(random), random)
    request = ImportRequest(height_m=4.0, up_axis="y", complete=False)
    return read_tree(obj_bytes(surface), "scan-like.obj", request)


@pytest.mark.parametrize("seed", [11, 12])
def test_the_expected_frequency_is_that_of_the_finite_elements(seed: int, tmp_path: Path) -> None:
    print("seed", seed)
    tree = drawn_tree(seed)
    assert is_chained(tree.wood_vertices_m, tree.wood_faces)
    expected = expected_motion(tree, WOOD)
    built = tree_model(tree, WOOD, 3000, tmp_path, FemSettings()).fem.report["frequencies_hz"][0]
    print("beams", expected and expected["first_frequency_hz"], "finite elements", built)
    assert expected is None or expected["first_frequency_hz"] == pytest.approx(built, rel=0.2)


def test_joined_cylinders_have_the_radius_of_each(tmp_path: Path) -> None:
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
