"""Root plates that yield: exact frequencies, isotropic springs, weight on the ground, the rigid limit."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.verify.bars import Bar, polygon_bar
from galewood.check.verify.beam_checks import POLE_WOOD, SPRUNG_LIMITS, sprung
from galewood.check.verify.beams import CLAMPED_NUMBER, sprung_pole_frequency
from galewood.options import BuildRequest
from galewood.pipeline.sampling.runner import content_hash
from galewood.pipeline.tables import BuildOptions
from galewood.solid.fem import (
    Element,
    FemModel,
    FemSettings,
    Simulator,
    load_model,
    save_model,
    solve_static,
)
from galewood.solid.fem.foundation import base_springs
from galewood.solid.model import build_model

ELEMENTS: tuple[Element, ...] = ("fitted", "quadratic")


def built(bar: Bar, element: Element, root: float | None, *, gravity: bool = True) -> FemModel:
    settings = FemSettings(element=element, gravity=gravity, root_stiffness_nm_rad=root)
    return build_model(bar, bar, POLE_WOOD, bar, settings)


def pole(sides: int = 6) -> Bar:
    return polygon_bar(sides=sides, radius_m=0.1, length_m=6.0, layers=30)


def test_the_wave_number_has_the_exact_limits():
    assert sprung_pole_frequency(1.0, 1e9) == pytest.approx(1.0, rel=1e-8)
    # Rayleigh: a rigid pole that turns about its foot, ω² = 3 k / (m L²), λ⁴ = 3 k L / (E I).
    soft = sprung_pole_frequency(1.0, 1e-6)
    assert soft == pytest.approx(np.sqrt(3e-6) / CLAMPED_NUMBER**2, rel=1e-5)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("ratio", [*SPRUNG_LIMITS, 50.0])
def test_the_frequency_of_a_pole_on_a_spring(ratio, element):
    check = sprung(ratio, 0.005, element)
    assert check.passed, check.line()


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_very_stiff_root_plate_is_rigid_ground(element):
    rigid, stiff = built(pole(), element, None), built(pole(), element, 1e12)
    np.testing.assert_allclose(stiff.report["frequencies_hz"], rigid.report["frequencies_hz"], rtol=2e-5)


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("sides", [4, 6, 12])
def test_the_springs_resist_every_tilt_equally(element, sides):
    bar = pole(sides)
    uneven = bar.vertices_m * [1.0, 1.0, 0.6]
    model = built(replace(bar, vertices_m=uneven), element, None, gravity=False)
    springs = base_springs(model, 5e5)
    assert (springs >= 0).all()
    place = model.nodes_m[model.fixed]
    place = place - springs @ place / springs.sum()
    for angle in np.random.default_rng(1).uniform(0, np.pi, 5):
        turn = np.cross([np.cos(angle), 0.0, np.sin(angle)], place)
        energy = springs @ (turn**2).sum(axis=1)
        assert energy == pytest.approx(5e5, rel=1e-3)


@pytest.mark.parametrize("element", ELEMENTS)
def test_the_ground_bears_the_weight(element):
    model = built(pole(), element, 2e6)
    assert model.report["rest_pose"]["kind"] == "loaded"
    assert model.foundation_n_m is not None and not len(model.fixed)
    weight = 9.81 * model.mass_kg.sum()
    reaction = model.gravity_n + 9.81 * model.mass_kg[:, None] * [0.0, 1.0, 0.0]
    np.testing.assert_allclose(reaction.sum(axis=0), [0.0, weight, 0.0], atol=1e-6 * weight)
    assert not reaction[model.foundation_n_m == 0].any()


def test_a_horizontal_pull_tilts_the_root_plate_by_its_moment():
    model = built(pole(), "quadratic", 1e5, gravity=False)
    load = np.zeros_like(model.nodes_m)
    top = model.nodes_m[: model.vertex_count, 1] > 5.999
    load[: model.vertex_count][top, 0] = 1.0 / top.sum()
    system = model.system()
    u, _, converged = solve_static(system, load)
    assert converged
    rigid = built(pole(), "quadratic", None, gravity=False)
    clamped, _, _ = solve_static(rigid.system(), load)
    more = float((u - clamped)[: model.vertex_count][top, 0].mean())
    # The base may warp on its springs, as if the pole were longer by half its radius.
    stiffness = POLE_WOOD.young_longitudinal_pa * pole().second_moment_m4
    assert 0 < more - 6.0**2 / 1e5 < 6.0**2 * 0.06 / stiffness


@pytest.mark.parametrize("element", ELEMENTS)
def test_the_given_shape_stays_at_rest_on_its_root_plate(element):
    model = built(pole(), element, 2e6)
    assert model.report["rest_pose"]["kind"] == "loaded"
    simulator = Simulator(model)
    for _ in range(10):
        simulator.step(np.zeros(2))
    assert np.abs(simulator.u).max() < 1e-9


def test_the_weight_on_a_yielding_plate_lowers_the_frequency():
    models = [built(pole(), "fitted", 2e5, gravity=gravity) for gravity in (True, False)]
    heavy, light = (model.report["frequencies_hz"][0] for model in models)
    rigid = built(pole(), "fitted", None).report["frequencies_hz"][0]
    assert heavy < light < rigid


def test_a_model_on_springs_is_stored_and_its_key_covers_them(tmp_path):
    model = built(pole(), "fitted", 2e6)
    save_model(model, tmp_path / "model.npz")
    again = load_model(tmp_path / "model.npz")
    np.testing.assert_array_equal(again.foundation_n_m, model.foundation_n_m)
    assert again.settings == model.settings
    assert content_hash(again) == content_hash(model)
    assert model.foundation_n_m is not None
    assert content_hash(replace(model, foundation_n_m=2 * model.foundation_n_m)) != content_hash(model)


def test_the_option_of_a_build():
    assert BuildOptions().fem == FemSettings()
    assert BuildOptions(root_stiffness_knm=250).fem.root_stiffness_nm_rad == 250e3
    with pytest.raises(ValueError, match="greater than or equal"):
        BuildRequest(root_stiffness_knm=0)
    with pytest.raises(ValueError, match="root_stiffness_nm_rad"):
        FemSettings(root_stiffness_nm_rad=-1.0)
