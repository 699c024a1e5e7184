"""The parts of an individual's motion: the law of its species, its stiffness, its curved paths."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from galewood.packaged import species_folder
from galewood.pipeline.individuals import ship_motions, shipped_motions
from galewood.pipeline.individuals.curving import second_order
from galewood.pipeline.individuals.law import (
    SwayStates,
    force_of_law,
    isotropic,
    isotropic_law,
    isotropic_part,
    sampled_states,
)
from galewood.pipeline.individuals.stiffness import loaded_hz, of_all_modes, stiffness_factors
from galewood.pipeline.individuals.sway import Sway
from galewood.pipeline.results import motions_path
from galewood.solid.model import beam_model
from galewood.solid.skinning import Axis
from galewood.tree import read_tree
from galewood.wood import wood_of_species
from scipy.sparse import csr_matrix

SEED = 20260727


def turned(states: SwayStates, turn: np.ndarray) -> SwayStates:
    return SwayStates(states.sway @ turn, states.speed @ turn, states.pressure @ turn)


def test_the_isotropic_forces_turn_with_the_tree_and_its_wind() -> None:
    states, angle = sampled_states(0.6, 0.9), 0.7
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    np.testing.assert_allclose(isotropic(turned(states, turn)), isotropic(states) @ turn, atol=1e-12)
    mirror = np.diag([1.0, -1.0])
    np.testing.assert_allclose(isotropic(turned(states, mirror)), isotropic(states) @ mirror, atol=1e-12)


def test_an_isotropic_law_is_its_own_isotropic_part() -> None:
    print("seed", SEED)
    given = np.random.default_rng(SEED).normal(size=7)
    found = isotropic_part(isotropic_law(given), sampled_states(0.5, 0.8))
    np.testing.assert_allclose(found, given, rtol=1e-9)


def test_what_pushes_to_one_side_only_is_no_part_of_the_isotropic_law() -> None:
    def lopsided(states: SwayStates) -> np.ndarray:
        return np.column_stack([states.sway[:, 0] ** 2, states.speed[:, 0] * states.pressure[:, 1]])

    part = isotropic_part(lopsided, sampled_states(0.5, 0.8))
    np.testing.assert_allclose(part, 0, atol=1e-12)


def test_the_terms_of_a_model_reproduce_a_law_in_any_units_and_directions() -> None:
    print("seed", SEED)
    rng = np.random.default_rng(SEED)
    rows = rng.normal(size=(2, 6))
    turn = np.linalg.qr(rng.normal(size=(2, 2)))[0]
    own, limits = Sway(rows, turn, 3.1, 212.0), np.array([1.0, 0.6 * 3.1, 0.9 * 212.0])
    law = isotropic_law(rng.normal(size=7))
    force = force_of_law(law, own, limits, sampled_states(0.6, 0.9, seed=1))
    # a state worked out by hand, from e, v and Pa
    states = sampled_states(0.6, 0.9, seed=2)
    x, y = turn @ states.sway.T
    u, v = (turn @ states.speed.T) * own.omega
    px, pz = states.pressure.T * own.unit_pa
    shape = [x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3]
    motion = [u * u, u * v, v * v, u * u * x, u * u * y, u * v * x, u * v * y, v * v * x, v * v * y]
    motion += [w * one for w in (u, v) for one in (x, y, *shape[:3])]
    motion += [p * one for p in (px, pz) for one in (x, y, *shape)]
    acceleration = rows @ (force.T @ np.array([*shape, *motion]))
    np.testing.assert_allclose(acceleration.T @ turn / own.omega**2, law(states), atol=1e-8)


def test_a_pole_of_constant_curvature_sinks_as_an_arc_does() -> None:
    height_m, count, curvature = 8.0, 21, 0.02
    along = np.linspace(0, height_m, count)
    points = np.column_stack([0 * along, along, 0 * along])
    empty = csr_matrix((count, 4 * count))
    axis = Axis(points, np.arange(-1, count - 1), np.full(count, 0.1), empty, empty)
    turned = np.zeros((count, 3, 2))
    turned[:, 2, 0] = -curvature * along  # towards +x
    turned[:, 0, 1] = curvature * along  # towards +z
    sway_x, both, sway_z = (
        second_order(axis, turned, pair, arm_m=0.1).reshape(count, 4, 3) for pair in ((0, 0), (0, 1), (1, 1))
    )
    exact = np.sin(curvature * along) / curvature - along  # of an arc; its second order is −κ² s³ / 6
    np.testing.assert_allclose(sway_x[:, 0, 1], -(curvature**2) * along**3 / 6, atol=1e-12)
    np.testing.assert_allclose(sway_x[:, 0, 1], exact, rtol=0.003, atol=1e-12)
    np.testing.assert_allclose(sway_z[:, 0], sway_x[:, 0], atol=1e-12)
    np.testing.assert_allclose(both[:, 0, 1], 0, atol=1e-12)
    # a point beside the axis along y is turned by κ s, and so is lower by the cosine
    tip = sway_x[-1, 2, 1] - sway_x[-1, 0, 1]
    assert tip == pytest.approx(0.1 * (np.cos(curvature * height_m) - 1), rel=0.003)


def test_the_stiffness_of_each_mode_is_found_from_its_frequency() -> None:
    mesh = species_folder() / "apricot-forest.glb"
    beams = beam_model(read_tree(mesh.read_bytes(), mesh.name), wood_of_species("apricot"))
    factors = of_all_modes(np.array([0.8, 0.9, 1.3, 1.1]), len(beams.weightless_hz))
    np.testing.assert_allclose(factors[4:], np.sqrt(1.3 * 1.1))
    np.testing.assert_allclose(
        stiffness_factors(beams, loaded_hz(beams, factors)[:12].tolist()), factors[:12], rtol=1e-9
    )


def test_the_shipped_motions_are_those_of_the_shipped_tables(tmp_path: Path) -> None:
    assert not ship_motions(species_folder())
    assert motions_path(species_folder()).stat().st_size < 20_000
    # one tree again, from its mesh and table alone
    names = ("apricot-forest.glb", "shipped/apricot-forest.table", "shipped/apricot-forest.bare.table")
    for name in names:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(species_folder() / name, tmp_path / name)
    listed = (species_folder() / "species.json").read_text()
    start = listed.index('{\n    "id": "apricot-forest"')
    (tmp_path / "species.json").write_text(f"[{listed[start : listed.index('}', start) + 1]}]")
    assert ship_motions(tmp_path)
    again, shipped = (shipped_motions("apricot", "forest", folder) for folder in (tmp_path, species_folder()))
    for ours, theirs in ((again.leaf, shipped.leaf), (again.bare, shipped.bare)):
        assert ours is not None
        assert theirs is not None
        np.testing.assert_allclose(ours.stiffness, theirs.stiffness, rtol=1e-3)
        np.testing.assert_allclose(ours.force, theirs.force, atol=1e-3)
        assert (ours.sway, ours.speed) == pytest.approx((theirs.sway, theirs.speed), rel=1e-3)
    assert again.bare != again.leaf
    assert shipped_motions("spruce", "open").bare is None
