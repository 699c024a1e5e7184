"""The beam frame against closed-form solutions."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from galewood.check.verify.beams import pole_frequencies
from galewood.check.verify.specimens import read_frame
from galewood.solid.beams import Frame, frame_frequencies, frame_matrices, joined_frame
from galewood.wood.species import wood_of_species
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

WOOD = wood_of_species("maple")
SPECIES = Path(__file__).parents[3] / "assets" / "species"
RADIUS_M, LENGTH_M = 0.05, 4.0


def pole(direction, tip_ratio=1.0, links=12):
    """A clamped pole: a skeleton with a single branch."""
    share = np.linspace(0, 1, links + 1)
    points = share[:, None] * LENGTH_M * np.array(direction) / np.linalg.norm(direction)
    radius = RADIUS_M * (1 + (tip_ratio - 1) * share)
    return joined_frame(points, radius, np.arange(-1, links), np.zeros(links + 1, int), 4)


@pytest.mark.parametrize("direction", [(0, 1, 0), (1, 2, 3)])
@pytest.mark.parametrize("tip_ratio", [1.0, 0.5])
def test_the_frequencies_of_a_pole_match_beam_theory_in_any_direction(direction, tip_ratio):
    area, moment = np.pi * RADIUS_M**2, np.pi * RADIUS_M**4 / 4
    exact = pole_frequencies(
        LENGTH_M, WOOD.young_longitudinal_pa, WOOD.density_kg_m3, area, moment, tip_ratio
    )
    found = frame_frequencies(pole(direction, tip_ratio), WOOD, 0.0, 4)
    np.testing.assert_allclose(found[[0, 2]], exact, rtol=2e-3)
    np.testing.assert_allclose(found[[1, 3]], exact, rtol=2e-3)


def test_the_tip_deflection_of_an_l_shaped_wire():
    """An L of two equal legs under a force normal to its plane at the tip: both bend, the first twists."""
    leg, links = 2.0, 10
    up = np.column_stack([np.zeros(links + 1), np.linspace(0, leg, links + 1), np.zeros(links + 1)])
    out = up[-1] + np.column_stack([np.linspace(0, leg, links + 1)[1:], np.zeros(links), np.zeros(links)])
    points = np.concatenate([up, out])
    radius, parent = np.full(len(points), RADIUS_M), np.arange(-1, len(points) - 1)
    tree = joined_frame(points, radius, parent, np.zeros(len(points), int))
    stiffness, _ = frame_matrices(tree, WOOD)
    free = np.flatnonzero(np.repeat(tree.points_m[:, 1] > 0, 6))
    tip = int(np.argmax(tree.points_m[:, 0]))
    load = np.zeros(6 * len(tree.points_m))
    load[6 * tip + 2] = 1.0
    u = np.zeros_like(load)
    u[free] = np.linalg.solve(stiffness[free][:, free].toarray(), load[free])
    moment = np.pi * RADIUS_M**4 / 4
    bending = 2 * leg**3 / (3 * WOOD.young_longitudinal_pa * moment)
    torsion = leg * leg**2 / (WOOD.shear_longitudinal_pa * 2 * moment)
    assert u[6 * tip + 2] == pytest.approx(bending + torsion, rel=1e-6)


def test_links_inside_a_limb_have_no_mass():
    points = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 1, 0], [1, 1, 0]], float)
    radius = np.array([0.1, 0.1, 0.1, 0.02, 0.02])
    tree = joined_frame(points, radius, np.array([-1, 0, 1, 1, 3]), np.array([0, 0, 0, 1, 1]), 4)
    exact = np.pi * (0.1**2 * 2 + 0.02**2 * 0.9)
    assert tree.volume_m3() == pytest.approx(exact, rel=5e-3)


def test_thin_beams_are_as_stiff_as_a_least_radius_and_as_heavy_as_drawn():
    points, radius = np.array([[0, 0, 0], [0, 1, 0], [0, 2, 0.3]], float), np.array([0.05, 0.001])
    frame = Frame(points, np.array([[0, 1], [1, 2]]), radius, np.zeros(2, bool), stiff_radius_m=0.01)
    stout = replace(frame, radius_m=np.array([0.05, 0.01]), stiff_radius_m=0.0)
    thin = replace(frame, stiff_radius_m=0.0)
    stiffness, mass = frame_matrices(frame, WOOD)
    np.testing.assert_array_equal(stiffness.toarray(), frame_matrices(stout, WOOD)[0].toarray())
    np.testing.assert_array_equal(mass.toarray(), frame_matrices(thin, WOOD)[1].toarray())


def test_frequencies_converge_with_smaller_pieces():
    path, wood = SPECIES / "apricot.skeleton.json", wood_of_species("apricot")
    first, second = (frame_frequencies(read_frame(path, beams), wood, 0.0, 10) for beams in (4, 8))
    np.testing.assert_allclose(first, second, rtol=0.01)


def test_branches_that_start_where_others_start_are_joined():
    """Three branches from one point of the trunk, the second and third listed as children of the first."""
    trunk = [[0, 0, 0], [0, 1, 0], [0, 2, 0]]
    twigs = [[[0, 1, 0], [np.cos(a), 1.5, np.sin(a)]] for a in (0.0, 2.0, 4.0)]
    points = np.array([*trunk, *twigs[0], *twigs[1], *twigs[2]], float)
    parent = np.array([-1, 0, 1, 1, 3, 3, 5, 5, 7])
    branch = np.array([0, 0, 0, 1, 1, 2, 2, 3, 3])
    frame = joined_frame(points, np.full(9, 0.03), parent, branch)
    graph = coo_array((np.ones(len(frame.links)), frame.links.T), shape=(len(frame.points_m),) * 2)
    assert connected_components(graph, directed=False)[0] == 1
    assert frame_frequencies(frame, wood_of_species("oak"), 0.0, 1)[0] > 1.0
