"""Drag from the relative velocity: exact motion of a plate, energy, shelter, derivatives, the modal model."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.verify.motion_checks import energy_rise, loaded_pole, plate_on_a_spring
from galewood.motion.wind import dynamic_pressure
from galewood.pipeline.reduction.oscillators import oscillators_of, propagators
from galewood.pipeline.reduction.wind_scale import speeds_for
from galewood.pipeline.sampling import gust_shapes, training_shapes
from galewood.pipeline.sampling.training_winds import STORM_GUST_M_S
from galewood.solid.fem import Drag, Simulator
from galewood.wood import BARE_EXPONENT

SEED = 20_411


def random_nodes(count: int = 40) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Drag areas, exposed areas, wind profile and velocities of some nodes."""
    rng = np.random.default_rng(SEED)
    area = rng.uniform(0.1, 1.0, count)
    return area, area * rng.uniform(1, 8, count), rng.uniform(0.3, 1, count), rng.normal(0, 4, (count, 3))


def test_the_steady_force_is_that_of_the_silhouette_whatever_the_exposed_area() -> None:
    area, exposed, profile, velocity = random_nodes()
    for speed_m_s, exponent in ((0.0, 1.3), (2.0, 1.3), (9.0, 1.3), (40.0, 1.3), (40.0, 1.64), (40.0, 2.0)):
        wind = float(dynamic_pressure(speed_m_s, exponent)) * np.array([0.6, -0.8])
        force = Drag(area, exposed, profile, exponent).at(0 * velocity, wind).force_n
        np.testing.assert_allclose(force[:, [0, 2]], area[:, None] * wind, rtol=1e-12, atol=1e-12)
        assert not force[:, 1].any()


@pytest.mark.parametrize("exponent", [1.3, 1.64, 2.0])
def test_without_shelter_the_force_is_the_pressure_of_the_relative_velocity(exponent: float) -> None:
    area, _, _, velocity = random_nodes()
    wind_m_s = np.array([7.0, 0.0, -3.0])
    speed_m_s = np.linalg.norm(wind_m_s)
    pressure = float(dynamic_pressure(speed_m_s, exponent)) * wind_m_s / speed_m_s
    force = Drag(area, None, None, exponent).at(velocity, pressure[[0, 2]]).force_n
    relative = wind_m_s - velocity
    size = np.linalg.norm(relative, axis=1)
    expected = (area * dynamic_pressure(size, exponent) / size)[:, None] * relative
    np.testing.assert_allclose(force, expected, rtol=1e-12)


@pytest.mark.parametrize(("speed_m_s", "exponent"), [(0.0, 1.3), (3.0, 1.3), (20.0, 1.3), (20.0, 2.0)])
def test_the_damping_is_minus_the_derivative_of_the_force(speed_m_s: float, exponent: float) -> None:
    area, exposed, profile, velocity = random_nodes()
    drag = Drag(area, exposed, profile, exponent)
    wind = float(dynamic_pressure(speed_m_s, exponent)) * np.array([0.8, 0.6])
    damping = drag.at(velocity, wind).damping.reshape(-1, 3, 3).copy()
    step = 1e-6
    for axis in range(3):
        ahead, behind = velocity.copy(), velocity.copy()
        ahead[:, axis] += step
        behind[:, axis] -= step
        change = drag.at(ahead, wind).force_n.copy() - drag.at(behind, wind).force_n
        np.testing.assert_allclose(-change / (2 * step), damping[:, :, axis], rtol=1e-5, atol=1e-6)
    np.testing.assert_array_less(0.0, np.linalg.eigvalsh(damping))


def test_the_drag_of_bare_wood_grows_with_the_square_of_the_wind() -> None:
    pole = replace(loaded_pole(), drag_area_m2=np.full(len(loaded_pole().nodes_m), 0.1))
    assert pole.streamlined_exponent == BARE_EXPONENT == 2.0
    drag, still = pole.drag(), np.zeros_like(pole.nodes_m)
    load_n = [
        drag.at(still, np.array([dynamic_pressure(speed, pole.streamlined_exponent), 0.0])).force_n.sum()
        for speed in (4.0, 8.0, 16.0, 32.0)
    ]
    np.testing.assert_allclose(np.array(load_n) / load_n[0], [1.0, 4.0, 16.0, 64.0], rtol=1e-12)


def test_a_plate_on_a_spring_follows_the_exact_solution() -> None:
    found, exact = plate_on_a_spring(dt_s=1 / 240)
    assert np.abs(found - exact).max() < 1e-3 * np.abs(exact).max()
    coarse, exact = plate_on_a_spring(dt_s=1 / 60)
    assert np.abs(coarse - exact).max() < 1.5e-2 * np.abs(exact).max()


@pytest.mark.parametrize("shelter", [1.0, 6.0])
def test_drag_takes_energy_in_still_air(shelter: float) -> None:
    pole = loaded_pole()
    area = np.where(pole.nodes_m[:, 1] > 4.0, 2.0, 0.0) / len(pole.nodes_m)
    assert energy_rise(replace(pole, drag_area_m2=area, exposed_area_m2=shelter * area), 90) < 1e-9


def test_exact_propagators_do_not_depend_on_the_substeps() -> None:
    settings = loaded_pole().settings
    steps = [
        propagators(np.array([4.0, 9.0]), np.array([0.3, 0.7]), replace(settings, substeps=substeps))
        for substeps in (1, 4)
    ]
    np.testing.assert_array_equal(steps[0], steps[1])


def test_training_winds_cause_the_required_sway() -> None:
    """The linear model with drag predicts the speed at which the finite elements sway so far."""
    pole = loaded_pole()
    area = np.where(pole.nodes_m[:, 1] > 4.0, 6.0, 0.0) / len(pole.nodes_m)
    model = replace(pole, drag_area_m2=area, exposed_area_m2=4 * area)
    height_m = float(np.ptp(model.nodes_m[:, 1]))
    first_hz = float(model.report["frequencies_hz"][0])
    shapes = training_shapes(first_hz, model.settings.dt_s, model.streamlined_exponent, count=5)
    mass_kg = model.mass_kg[: model.vertex_count]
    speeds = speeds_for(shapes, oscillators_of(model, 40), mass_kg, height_m, model.settings)
    for shape, speed in zip(shapes, speeds.tolist(), strict=True):
        simulator, farthest_m = Simulator(model), 0.0
        for pressure in shape.pressure_pa(speed):
            simulator.step(pressure)
            farthest_m = max(farthest_m, float(np.linalg.norm(simulator.u, axis=1).max()))
        assert farthest_m == pytest.approx(shape.sway_share * height_m, rel=0.15)


def test_training_winds_are_as_strong_as_a_storm_where_that_sways_farther() -> None:
    """A slender body reaches the sway of storms, a stiff one the usual sway in any wind."""
    pole = loaded_pole()
    height_m = float(np.ptp(pole.nodes_m[:, 1]))
    mass_kg = pole.mass_kg[: pole.vertex_count]
    shapes = gust_shapes(pole.settings.dt_s, pole.streamlined_exponent, count=1)
    storm = [replace(shape, sway_share=shape.storm_sway_share) for shape in shapes]
    usual = [replace(shape, storm_sway_share=shape.sway_share) for shape in shapes]
    between = 0
    for area_m2 in np.geomspace(0.5, 60.0, 12):
        area = np.where(pole.nodes_m[:, 1] > 4.0, area_m2, 0.0) / len(pole.nodes_m)
        body = oscillators_of(replace(pole, drag_area_m2=area, exposed_area_m2=area), 40)
        speed, least, most = (
            float(speeds_for(some, body, mass_kg, height_m, pole.settings)[0])
            for some in (shapes, usual, storm)
        )
        assert speed == pytest.approx(max(least, min(most, STORM_GUST_M_S)), rel=0.01)
        between += least < STORM_GUST_M_S < most
    assert between
