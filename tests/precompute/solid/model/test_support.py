"""One rule for every weight: exact up to a third of the buckling load, then smooth; changes are reported."""

from __future__ import annotations

from dataclasses import asdict, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from galewood.check.verify.bars import polygon_bar
from galewood.check.verify.beams import Laden, laden_pole, pole_frequencies, softening
from galewood.solid.fem import Element, FemModel, FemSettings, Simulator, borne_load_factor
from galewood.solid.fem.support import LARGEST_LOSS, SAFE_LOAD_FACTOR, remaining_share
from galewood.solid.model import build_model
from galewood.wood import BARE_EXPONENT, wood_of_species
from scipy.optimize import brentq

WOOD = wood_of_species("poplar")
ELEMENTS: tuple[Element, ...] = ("fitted", "quadratic")
POLE_M, TWIG_M, LAYERS, TWIG_LAYERS = 8.0, 0.12, 40, 8
POLE_RADIUS_M = 0.05


def built(tree: Any, element: Element, *, gravity: bool = True) -> FemModel:
    return build_model(tree, tree, WOOD, tree, FemSettings(element=element, gravity=gravity))


def pole_with_twig(twig_radius_m: float, load_kg: float) -> Any:
    """A pole of 5 cm with a thin twig standing on it, which carries a load at its tip: two limbs."""
    bar = polygon_bar(sides=6, radius_m=POLE_RADIUS_M, length_m=1.0, layers=LAYERS + TWIG_LAYERS)
    low = np.linspace(0, POLE_M, LAYERS + 1)
    height = np.concatenate([low, POLE_M + TWIG_M * np.arange(1, TWIG_LAYERS + 1) / TWIG_LAYERS])
    layer = np.round(bar.vertices_m[:, 1] * (LAYERS + TWIG_LAYERS)).astype(int)
    wide = np.where(layer > LAYERS, twig_radius_m / POLE_RADIUS_M, 1.0)
    vertices = bar.vertices_m * np.column_stack([wide, np.ones(len(wide)), wide])
    vertices[:, 1] = height[layer]
    mass = np.zeros(len(vertices))
    mass[bar.tip] = load_kg / len(bar.tip)
    limb = (layer[bar.tets].max(axis=1) > LAYERS).astype(np.int32)
    return SimpleNamespace(
        **asdict(replace(bar, vertices_m=vertices, mass_kg=mass)),
        tet_branch=limb,
        tet_radius_m=np.where(limb == 1, twig_radius_m, POLE_RADIUS_M),
        leaf_mass_kg=np.zeros(len(mass)),
        exposed_area_m2=None,
        wind_profile=None,
        streamlined_exponent=BARE_EXPONENT,
    )


def pole_with_mass(load_kg: float) -> Any:
    """The same pole with the mass on its top."""
    bar = polygon_bar(sides=6, radius_m=POLE_RADIUS_M, length_m=POLE_M, layers=LAYERS)
    mass = np.zeros(len(bar.vertices_m))
    mass[bar.tip] = load_kg / len(bar.tip)
    return replace(bar, mass_kg=mass)


def test_the_share_that_remains_is_exact_at_first_and_then_bends_smoothly() -> None:
    load = np.linspace(0, 3, 3001)
    share = np.array([remaining_share(one) for one in load])
    safe = load <= SAFE_LOAD_FACTOR
    np.testing.assert_allclose(share[safe], 1 - load[safe], rtol=1e-12)
    assert (np.diff(share) < 0).all() and share[-1] > 1 - LARGEST_LOSS
    curvature = np.diff(share, 2) / 1e-6
    assert np.abs(np.diff(curvature)).max() < 0.5, "the second derivative is continuous"
    borne = np.array([borne_load_factor(one) for one in load])
    np.testing.assert_allclose(borne[safe], load[safe], rtol=1e-12, atol=1e-12)
    assert (np.diff(borne) > 0).all() and borne[-1] < 1


# ---- a pole whose top gets heavier ------------------------------------------------------------------

SLENDER_M, SLENDER_RADIUS_M, LOAD_FACTORS = 5.0, 0.03, (0.2, 0.3, 0.35, 0.5, 0.7, 0.9, 1.0, 1.1, 1.5, 4.0)


def topped(load_factor: float) -> tuple[Any, Laden]:
    """A pole with the mass on its top that gives this load factor, and its exact solution."""
    bar = polygon_bar(sides=6, radius_m=SLENDER_RADIUS_M, length_m=SLENDER_M, layers=40)

    def exact(top_kg: float) -> Laden:
        stiffness = WOOD.young_longitudinal_pa * bar.second_moment_m4
        return laden_pole(SLENDER_M, stiffness, WOOD.density_kg_m3 * bar.area_m2, top_kg)

    top_kg = float(brentq(lambda kg: exact(kg).load_factor - load_factor, 0, 1e4, xtol=1e-9))  # pyright: ignore[reportArgumentType]
    mass = np.zeros(len(bar.vertices_m))
    mass[bar.tip] = top_kg / len(bar.tip)
    return replace(bar, mass_kg=mass), exact(top_kg)


def test_the_exact_pole_has_the_buckling_loads_of_greenhill_and_euler() -> None:
    own, top = laden_pole(3.0, 10.0, 0.2, 0.0), laden_pole(3.0, 10.0, 1e-9, 0.5)
    assert own.load_factor == pytest.approx(0.2 * 9.81 * 3.0**3 / (7.8373 * 10.0), rel=1e-4)
    assert top.load_factor == pytest.approx(0.5 * 9.81 * 3.0**2 / (np.pi**2 / 4 * 10.0), rel=1e-5)
    assert top.weightless_hz == pytest.approx(np.sqrt(3 * 10.0 / 3.0**3 / 0.5) / (2 * np.pi), rel=1e-5)


@pytest.mark.parametrize("element", ELEMENTS)
def test_the_frequency_falls_smoothly_with_the_load_and_is_exact_at_first(element: Element) -> None:
    found: list[float] = []
    for load_factor in LOAD_FACTORS:
        bar, exact = topped(load_factor)
        model = built(bar, element)
        pose, hertz = model.report["rest_pose"], model.report["frequencies_hz"][0]
        assert pose["load_factor"] == pytest.approx(load_factor, rel=0.03)
        assert pose["kind"] == ("loaded" if load_factor <= 0.3 else "supported")
        if load_factor < 0.36:
            assert hertz == pytest.approx(exact.frequency_hz, rel=0.015)
        elif load_factor < 0.6:
            assert exact.frequency_hz < hertz < 1.1 * exact.frequency_hz
        assert hertz < exact.weightless_hz
        found.append(hertz)
    rate = np.diff(np.log(found)) / np.diff(np.log(LOAD_FACTORS))
    assert (rate < -0.2).all(), "it falls"
    assert (rate > -1.2).all(), "without a jump"


def test_the_mass_of_thin_parts_is_lowered_before_the_wood_is_stiffened() -> None:
    light, heavy = (built(topped(load)[0], "fitted").report["rest_pose"] for load in (0.7, 6.0))
    assert 0.25 < light["thin_mass_factor"] < 1 and light["stiffness_factor"] == 1
    assert heavy["thin_mass_factor"] == 0.25 and heavy["stiffness_factor"] > 1
    for pose in (light, heavy):
        assert pose["borne_load_factor"] == pytest.approx(borne_load_factor(pose["load_factor"]), rel=1e-3)
        assert "buckling load" in pose["warning"] and "of their mass" in pose["warning"]
    assert "times as stiff" in heavy["warning"]


def test_a_slight_change_is_reported_without_a_warning() -> None:
    pose = built(topped(0.37)[0], "fitted").report["rest_pose"]
    assert pose["kind"] == "supported" and 0.95 < pose["thin_mass_factor"] < 1
    assert "warning" not in pose


# ---- limbs ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_pole_with_a_limp_twig_sways_as_the_pole_with_its_mass(element: Element) -> None:
    model = built(pole_with_twig(0.0011, 0.15), element)
    pose = model.report["rest_pose"]
    assert (pose["kind"], pose["supported_limbs"]) == ("supported", 1)
    assert pose["thin_mass_factor"] == 1 == pose["stiffness_factor"]
    plain = built(pole_with_mass(0.15), element)
    assert plain.report["rest_pose"]["kind"] == "loaded"
    assert pose["supported_wood_kg"] < 0.01 * plain.mass_kg.sum(), "only the twig is stiffened"
    assert np.abs(model.gravity_n).max() > 0
    expected, found = (m.report["frequencies_hz"][0] for m in (plain, model))
    assert found == pytest.approx(expected, rel=0.01)


def test_a_twig_that_stands_is_not_touched() -> None:
    assert built(pole_with_twig(0.003, 0.15), "fitted").report["rest_pose"]["kind"] == "loaded"


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_pole_beyond_its_buckling_load_sways_as_the_stiffer_pole_of_beam_theory(element: Element) -> None:
    radius, length = 0.02, 9.0
    bar = polygon_bar(sides=6, radius_m=radius, length_m=length, layers=60)
    weight = 9.81 * WOOD.density_kg_m3 * bar.area_m2 * length
    stiffness = WOOD.young_longitudinal_pa * bar.second_moment_m4
    load = weight * length**2 / (7.8373 * stiffness)
    assert load > 1
    model = built(bar, element)
    pose = model.report["rest_pose"]
    assert pose["load_factor"] == pytest.approx(load, rel=0.03)
    factor = load + remaining_share(load)
    assert pose["stiffness_factor"] == pytest.approx(factor, rel=0.03)
    young = WOOD.young_longitudinal_pa * factor
    light = pole_frequencies(length, young, WOOD.density_kg_m3, bar.area_m2, bar.second_moment_m4)[0]
    exact = light * softening(weight, length, young, bar.second_moment_m4)
    assert model.report["frequencies_hz"][0] == pytest.approx(exact, rel=0.04)


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
