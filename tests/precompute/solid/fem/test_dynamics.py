"""Time integration: rest, damping, energy, determinism, recorded quantities, storage."""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from galewood.check.verify.bars import polygon_bar
from galewood.check.verify.motion_checks import energy_rise, loaded_pole, ring_down
from galewood.solid.fem import support
from galewood.solid.fem.dynamics import Simulator
from galewood.solid.fem.model import FemModel, load_model, save_model
from galewood.solid.fem.modes import frequencies
from galewood.solid.fem.settings import FemSettings, Scheme
from galewood.solid.model.comparison import trajectory_difference
from galewood.solid.model.construction import build_model
from galewood.wood.species import wood_of_species


@cache
def pole() -> FemModel:
    return loaded_pole()


@cache
def small() -> FemModel:
    bar = polygon_bar(sides=5, radius_m=0.05, length_m=3.0, layers=12, tip_radius_m=0.02)
    windy = replace(bar, drag_area_m2=np.where(bar.vertices_m[:, 1] > 1.5, 0.01, 0.0))
    return build_model(windy, windy, wood_of_species("maple"), windy, FemSettings(element="linear"))


def test_tree_at_rest_stays_at_rest() -> None:
    simulator = Simulator(pole())
    for _ in range(30):
        simulator.step(np.zeros(2))
    assert np.abs(simulator.u).max() < 1e-9
    assert np.abs(simulator.internal_force).max() < 1e-4


def test_free_vibration_has_the_eigenfrequency_and_the_damping_of_the_wood() -> None:
    hertz, ratio = ring_down(pole(), 0)
    assert hertz == pytest.approx(float(frequencies(pole(), 1)[0]), rel=0.02)
    assert ratio == pytest.approx(wood_of_species("poplar").damping_ratio, rel=0.1)


@pytest.mark.parametrize("scheme", ["tr-bdf2", "backward-euler"])
def test_energy_never_grows_in_still_air(scheme: Scheme) -> None:
    model = pole()
    assert energy_rise(replace(model, settings=replace(model.settings, scheme=scheme)), 90) < 1e-9


def test_more_newton_iterations_and_smaller_steps_change_little() -> None:
    crown = pole().nodes_m[:, 1] > 4.0
    model = replace(pole(), drag_area_m2=np.where(crown, 2.0 / crown.sum(), 0.0))
    gust = np.column_stack([40 * np.sin(np.linspace(0, 6, 60)) ** 2, np.full(60, 10.0)])
    rounds = replace(model, settings=replace(model.settings, j_max=6, tolerance=1e-9))
    assert trajectory_difference(model, rounds, gust) < 0.02
    fine = replace(model, settings=replace(model.settings, substeps=8))
    assert trajectory_difference(model, fine, gust) < 0.05


def test_solution_stays_finite_far_above_the_design_wind() -> None:
    simulator = Simulator(small())
    for k in range(60):
        simulator.step(np.array([3000.0 * (-1) ** (k // 10), 0.0]))
    assert np.isfinite(simulator.u).all()


def test_simulation_is_deterministic() -> None:
    runs = []
    for _ in range(2):
        simulator = Simulator(small())
        for k in range(20):
            simulator.step(np.array([5.0 + k, -3.0]))
        runs.append(simulator.u.tobytes() + simulator.v.tobytes())
    assert runs[0] == runs[1]


def test_record_refers_to_the_state_before_the_step() -> None:
    model = small()
    simulator = Simulator(model)
    stiffness = simulator.stiffness_diagonal
    simulator.step(np.array([40.0, 0.0]))
    np.testing.assert_allclose(
        simulator.stiffness_diagonal, stiffness, rtol=1e-6, atol=1e-6 * stiffness.max()
    )
    assert np.abs(simulator.internal_force).max() < 1e-4
    simulator.step(np.array([40.0, 0.0]))
    whole = simulator.internal_force
    assert np.abs(whole).max() > 0
    some = np.array([3, 17, 40])
    np.testing.assert_array_equal(simulator.recorded_force(some), whole[some])
    np.testing.assert_array_equal(simulator.recorded_stiffness(some), simulator.stiffness_diagonal[some])


def test_the_load_less_the_rate_of_momentum_is_the_force_of_the_clamped_nodes() -> None:
    model = small()
    model = replace(model, settings=replace(model.settings, dt_s=1 / 480))
    simulator, system = Simulator(model), model.system()
    fixed, foot = np.array(model.fixed), system.rank[model.fixed]
    momentum, load, reaction = [], [], []
    for k in range(240):
        simulator.step(np.array([40.0 * np.sin(0.02 * k) ** 2, 10.0]))
        of_momentum, of_load = simulator.balance()
        inner = np.zeros_like(system.rest)
        system.force(simulator.u[system.order], model.beta * simulator.v[system.order], inner)
        force = model.gravity_n[fixed] - inner[foot]
        momentum.append(of_momentum)
        load.append(of_load)
        reaction.append(
            np.concatenate([force.sum(axis=0), np.cross(model.nodes_m[fixed], force).sum(axis=0)])
        )
    base = np.array(load) - np.gradient(np.array(momentum), model.settings.dt_s, axis=0)
    sway = np.array(reaction)[5:-5] - np.array(reaction)[0]
    worst = np.abs(base - reaction)[5:-5].max(axis=0) / np.abs(sway).max()
    assert np.abs(sway[:, 0]).max() > 0.1  # N: the wind pushes
    assert worst.max() < 0.02


def test_weak_wind_causes_a_linear_response_along_its_direction() -> None:
    model = small()
    ends = []
    for pressure in (1e-3, 2e-3):
        simulator = Simulator(model)
        for _ in range(30):
            simulator.step(np.array([0.0, pressure]))
        ends.append(simulator.u)
    tip = model.nodes_m[:, 1].argmax()
    assert ends[0][tip, 2] > 0
    np.testing.assert_allclose(ends[1], 2 * ends[0], atol=1e-4 * np.abs(ends[1]).max())


def test_model_file_round_trip_is_exact(tmp_path: Path) -> None:
    save_model(small(), tmp_path / "model.npz")
    again = load_model(tmp_path / "model.npz")
    assert again.settings == small().settings
    assert again.report == small().report
    runs = [Simulator(model) for model in (small(), again)]
    for simulator in runs:
        for _ in range(5):
            simulator.step(np.array([30.0, 10.0]))
    assert runs[0].u.tobytes() == runs[1].u.tobytes()


def test_a_tree_that_no_stiffness_lets_stand_is_weightless_with_a_warning(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(support, "MAX_STIFFENING_FACTOR", 1.5)
    bar = polygon_bar(sides=5, radius_m=0.004, length_m=6.0, layers=30)
    model = build_model(bar, bar, wood_of_species("poplar"), bar, FemSettings(element="quadratic"))
    assert model.report["rest_pose"]["kind"] == "weightless"
    assert "buckle" in model.report["rest_pose"]["warning"]
    simulator = Simulator(model)
    simulator.step(np.zeros(2))
    assert np.abs(simulator.u).max() < 1e-12


@pytest.mark.parametrize(
    "bad", [{"dt_s": 0.0}, {"substeps": -1}, {"j_max": 0}, {"scheme": "euler"}, {"element": "hex"}]
)
def test_impossible_settings_are_rejected(bad: dict[str, object]) -> None:
    with pytest.raises(ValueError):
        FemSettings(**bad)  # pyright: ignore[reportArgumentType]


def test_inverted_mesh_is_rejected() -> None:
    bar = polygon_bar(sides=4, radius_m=0.05, length_m=1.0, layers=3)
    with pytest.raises(ValueError, match="inverted"):
        build_model(replace(bar, tets=bar.tets[:, [1, 0, 2, 3]]), bar, wood_of_species("maple"), bar)


def test_concurrent_writes_leave_a_complete_model_file(tmp_path: Path) -> None:
    """Regression: two builds of one tree used the same temporary name, and one of them failed."""
    model, path = small(), tmp_path / "model.npz"
    with ThreadPoolExecutor(8) as pool:
        for written in [pool.submit(save_model, model, path) for _ in range(40)]:
            written.result()
    assert [one.name for one in tmp_path.iterdir()] == ["model.npz"]
    assert np.array_equal(load_model(path).prestress, model.prestress)
