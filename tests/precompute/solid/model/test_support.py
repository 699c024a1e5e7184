"""Limbs that could not carry their own weight are stiffened; all others keep stiffness, all keep weight."""

from __future__ import annotations

from dataclasses import asdict, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from galewood.check.verify.bars import polygon_bar
from galewood.check.verify.beams import pole_frequencies, softening
from galewood.solid.fem import Element, FemModel, FemSettings, Simulator
from galewood.solid.model import build_model
from galewood.wood import wood_of_species

WOOD = wood_of_species("poplar")
ELEMENTS: tuple[Element, ...] = ("fitted", "quadratic")
POLE_M, TWIG_M, LAYERS, TWIG_LAYERS = 8.0, 0.12, 40, 8


def built(tree: Any, element: Element, *, gravity: bool = True) -> FemModel:
    return build_model(tree, tree, WOOD, tree, FemSettings(element=element, gravity=gravity))


def pole_with_twig(twig_radius_m: float, load_kg: float) -> Any:
    """A pole of 3 cm with a thin twig standing on it, which carries a load at its tip: two limbs."""
    bar = polygon_bar(sides=6, radius_m=0.03, length_m=1.0, layers=LAYERS + TWIG_LAYERS)
    low = np.linspace(0, POLE_M, LAYERS + 1)
    height = np.concatenate([low, POLE_M + TWIG_M * np.arange(1, TWIG_LAYERS + 1) / TWIG_LAYERS])
    layer = np.round(bar.vertices_m[:, 1] * (LAYERS + TWIG_LAYERS)).astype(int)
    wide = np.where(layer > LAYERS, twig_radius_m / 0.03, 1.0)
    vertices = bar.vertices_m * np.column_stack([wide, np.ones(len(wide)), wide])
    vertices[:, 1] = height[layer]
    mass = np.zeros(len(vertices))
    mass[bar.tip] = load_kg / len(bar.tip)
    limb = (layer[bar.tets].max(axis=1) > LAYERS).astype(np.int32)
    return SimpleNamespace(
        **asdict(replace(bar, vertices_m=vertices, mass_kg=mass)),
        tet_branch=limb,
        leaf_mass_kg=np.zeros(len(mass)),
        exposed_area_m2=None,
        wind_profile=None,
    )


def pole_with_mass(load_kg: float) -> Any:
    """The same pole with the mass on its top."""
    bar = polygon_bar(sides=6, radius_m=0.03, length_m=POLE_M, layers=LAYERS)
    mass = np.zeros(len(bar.vertices_m))
    mass[bar.tip] = load_kg / len(bar.tip)
    return replace(bar, mass_kg=mass)


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_pole_with_a_limp_twig_sways_as_the_pole_with_its_mass(element: Element) -> None:
    model = built(pole_with_twig(0.0011, 0.15), element)
    pose = model.report["rest_pose"]
    assert (pose["kind"], pose["supported_limbs"]) == ("supported", 1)
    assert pose["supported_share"] < 0.01, "only the twig is stiffened"
    plain = built(pole_with_mass(0.15), element)
    assert plain.report["rest_pose"]["kind"] == "sagged"
    assert np.abs(model.gravity_n).max() > 0
    expected, found = (m.report["frequencies_hz"][0] for m in (plain, model))
    assert found == pytest.approx(expected, rel=0.01)


def test_a_twig_that_stands_is_not_touched() -> None:
    model = built(pole_with_twig(0.003, 0.15), "fitted")
    assert model.report["rest_pose"]["kind"] in ("sagged", "loaded")


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_pole_beyond_its_buckling_load_sways_as_the_stiffer_pole_of_beam_theory(element: Element) -> None:
    radius, length = 0.02, 9.0
    bar = polygon_bar(sides=6, radius_m=radius, length_m=length, layers=60)
    weight = 9.81 * WOOD.density_kg_m3 * bar.area_m2 * length
    stiffness = WOOD.young_longitudinal_pa * bar.second_moment_m4
    load = weight * length**2 / (7.8373 * stiffness)
    assert load > 1
    pose = built(bar, element).report["rest_pose"]
    assert pose["load_factor"] == pytest.approx(load, rel=0.03)
    assert pose["largest_stiffness_factor"] == pytest.approx(1 + load, rel=0.03)
    young = WOOD.young_longitudinal_pa * (1 + load)
    light = pole_frequencies(length, young, WOOD.density_kg_m3, bar.area_m2, bar.second_moment_m4)[0]
    exact = light * softening(weight, length, young, bar.second_moment_m4)
    weightless = pole_frequencies(
        length, WOOD.young_longitudinal_pa, WOOD.density_kg_m3, bar.area_m2, bar.second_moment_m4
    )[0]
    assert exact == pytest.approx(weightless, rel=1e-6), "as stiff under its weight as it is drawn"
    assert built(bar, element).report["frequencies_hz"][0] == pytest.approx(exact, rel=0.04)


def test_a_supported_tree_stands_still_and_its_sway_decays() -> None:
    model = built(pole_with_twig(0.0011, 0.15), "fitted")
    simulator = Simulator(model)
    far: list[float] = []
    for frame in range(900):
        simulator.step(np.array([20.0 if 0 < frame < 15 else 0.0, 0.0]))
        far.append(float(np.abs(simulator.u).max()))
    assert far[0] < 1e-6, "at rest before the push"
    assert max(far[-200:]) < max(far[15:215])


def leaning(degrees: float) -> Any:
    """A slender pole that leans so far, 9 m long."""
    bar = polygon_bar(sides=6, radius_m=0.02, length_m=9.0, layers=60)
    turn = np.radians(degrees)
    rotation = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]])
    return replace(bar, vertices_m=bar.vertices_m @ rotation.T, tet_fibre=bar.tet_fibre @ rotation.T)


def test_a_slightly_leaning_pole_is_pressed_by_the_weight_along_it() -> None:
    pole = leaning(10)
    weight = 9.81 * WOOD.density_kg_m3 * pole.area_m2 * 9.0 * np.cos(np.radians(10))
    exact = weight * 9.0**2 / (7.8373 * WOOD.young_longitudinal_pa * pole.second_moment_m4)
    assert built(pole, "fitted").report["rest_pose"]["load_factor"] == pytest.approx(exact, rel=0.02)


def test_a_lying_pole_gives_way_sideways_at_the_load_of_beam_theory() -> None:
    """Lateral-torsional buckling of a cantilever: W L² = 12.85 √(E I G J) (textbook value, unchecked)."""
    pole = leaning(90)
    bending = WOOD.young_longitudinal_pa * pole.second_moment_m4
    twisting = WOOD.shear_longitudinal_pa * 2 * pole.second_moment_m4
    weight = 9.81 * WOOD.density_kg_m3 * pole.area_m2 * 9.0
    exact = weight * 9.0**2 / (12.85 * np.sqrt(bending * twisting))
    found = built(pole, "quadratic").report["rest_pose"]["load_factor"]
    assert found == pytest.approx(exact, rel=0.12)
