"""A thickened solid has the mass and stiffness of the surface it was made from."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.solid.fem.dynamics import Simulator
from galewood.solid.fem.model import FemSettings
from galewood.solid.model.construction import STIFFNESS_FLOOR, build_model, wood_elements
from galewood.solid.model.foliage import LumpedMasses
from galewood.solid.skeleton.extraction import extract_skeleton
from galewood.solid.skeleton.radius_correction import input_volume, with_corrected_radii
from galewood.solid.skeleton.roots import root_vertices
from galewood.solid.tets.quality import tet_volumes
from galewood.tree.repair import Surface, volume
from galewood.wood.species import wood_of_species

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.tet_meshes import Y_SEGMENTS, grid_mesh, near_segment, y_mesh

LIMB_M = 0.06


def input_y(trunk_m=0.22, limb_m=LIMB_M, sides=12) -> Surface:
    """The limbs of Y_SEGMENTS as closed tubes thinner than the solid; limbs begin on the trunk's axis."""
    radii = (trunk_m, limb_m, limb_m)
    return make.joined(
        *(make.tube(a, b, r, r, sides=sides) for (a, b, _), r in zip(Y_SEGMENTS, radii, strict=True))
    )


@pytest.fixture(scope="module")
def thick_y():
    mesh = y_mesh()
    mesh = replace(
        mesh, radius_ratio=np.full(len(mesh.tets), 0.3)
    )  # a value that the thickening might have recorded
    return mesh, extract_skeleton(mesh)


def test_limbs_and_trunk_have_their_input_radius(thick_y):
    mesh, skeleton = thick_y
    corrected = with_corrected_radii(make.as_tree(input_y()), mesh, skeleton)
    centre = mesh.vertices_m[mesh.tets].mean(axis=1)
    trunk = (centre[:, 1] < 2.2) & (centre[:, 1] > 0.1)
    assert np.median(corrected.radius_ratio[trunk]) == pytest.approx(1.0, abs=0.05)
    assert corrected.radius_ratio[trunk].min() > 0.9
    for start, end, radius in Y_SEGMENTS[1:]:
        own = near_segment(centre, start, end, radius) & (centre[:, 1] > 3.2)
        assert np.median(corrected.radius_ratio[own]) == pytest.approx(LIMB_M / radius, rel=0.15)


def test_mass_corresponds_to_the_input_volume(thick_y):
    mesh, skeleton = thick_y
    wood = input_y()
    corrected = with_corrected_radii(make.as_tree(wood), mesh, skeleton)
    weight = float((tet_volumes(mesh.vertices_m, mesh.tets) * corrected.radius_ratio**2).sum())
    assert weight == pytest.approx(volume(wood), rel=0.06)
    assert input_volume(wood, mesh.vertices_m[mesh.tets].mean(axis=1), skeleton).sum() == pytest.approx(
        volume(wood), rel=0.06
    )


def test_fused_twigs_do_not_weigh_as_solid_wood():
    """Two rods 0.1 m apart in one block: the mass is that of the rods, not of the block."""
    block = grid_mesh(
        lambda p: np.abs(p[:, [0, 2]]).max(axis=1) < 0.15, (-0.15, 0, -0.15), (0.15, 4, 0.15), 0.05
    )
    rods = make.joined(*(make.tube((x, 0, 0), (x, 4, 0), 0.03, 0.03, sides=16) for x in (-0.06, 0.06)))
    thinner = replace(block, radius_ratio=np.full(len(block.tets), 0.3))
    corrected = with_corrected_radii(make.as_tree(rods), thinner, extract_skeleton(block))
    weight = float((tet_volumes(block.vertices_m, block.tets) * corrected.radius_ratio**2).sum())
    assert weight == pytest.approx(volume(rods), rel=0.03)


def test_needle_keeps_its_mass_but_has_a_minimum_stiffness(thick_y):
    mesh, skeleton = thick_y
    lumped = type("LumpedMasses", (), {"mass_kg": 0, "drag_area_m2": 0, "fixed": np.arange(9)})
    made = [
        wood_elements(replace(mesh, radius_ratio=np.full(len(mesh.tets), ratio)), skeleton,
                      wood_of_species("maple"), lumped)  # pyright: ignore[reportArgumentType]
        for ratio in (1.0, STIFFNESS_FLOOR, 0.02)
    ]  # fmt: skip
    assert np.allclose(made[1].axial, STIFFNESS_FLOOR**4 * made[0].axial)
    assert np.allclose(made[2].axial, made[1].axial)
    assert np.allclose(made[2].element_mass_kg, 4e-4 * made[0].element_mass_kg)


def test_tree_of_needles_is_stable_in_a_storm():
    """Limbs a fiftieth as thick as meshed: a rest pose is found, and the simulation stays finite."""
    mesh = y_mesh(0.1)
    high = mesh.vertices_m[mesh.tets].mean(axis=1)[:, 1] > 3.0
    mesh = replace(mesh, radius_ratio=np.where(high, 0.02, 1.0))
    count = len(mesh.vertices_m)
    lumped = LumpedMasses(
        np.full(count, 5.0 / count),
        np.full(count, 4.0 / count),
        root_vertices(mesh.vertices_m, mesh.tets).astype(np.int32),
        {},
    )
    model = build_model(
        mesh, extract_skeleton(mesh), wood_of_species("maple"), lumped, FemSettings(element="linear")
    )
    simulator = Simulator(model)
    for k in range(120):
        simulator.step(np.array([400.0 * (-1) ** (k // 15), 100.0]))
    for _ in range(240):
        simulator.step(np.zeros(2))
    assert np.abs(simulator.u).max() < 0.5
