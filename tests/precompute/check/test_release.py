"""Pull and release: fits of synthetic decays, a released pole against theory."""

from dataclasses import replace

import numpy as np
import pytest
from galewood.check.field import fitted_decay, pull_and_release
from galewood.check.field.decay import envelope
from galewood.check.sway import main_sway_mode
from galewood.check.verify.bars import polygon_bar
from galewood.solid.fem import FemModel, FemSettings
from galewood.solid.model import build_model
from galewood.wood import wood_of_species
from scipy.integrate import solve_ivp

WOOD = wood_of_species("poplar")


def decay_of(ratio: float, drag: float, frequency_hz: float = 0.4, sway: float = 0.03):
    """Free decay of x'' + 2 ζ ω x' + c |x'| x' + ω² x = 0 at 30 frames a second."""
    omega, time_s = 2 * np.pi * frequency_hz, np.arange(0, 30, 1 / 30)

    def slopes(_, y):
        return [y[1], -2 * ratio * omega * y[1] - drag * abs(y[1]) * y[1] - omega**2 * y[0]]

    found = solve_ivp(slopes, (0, 30), [sway, 0.0], t_eval=time_s, rtol=1e-10, atol=1e-14)
    return time_s, found.y[0]


@pytest.mark.parametrize("ratio", [0.005, 0.03, 0.1])
def test_linear_damping_is_found_exactly(ratio):
    found = fitted_decay(*decay_of(ratio, 0.0))
    assert found.ratio == pytest.approx(ratio, rel=2e-3)
    assert found.ratio_at(0.0) == pytest.approx(ratio, rel=5e-3)
    assert found.frequency_hz == pytest.approx(0.4 * np.sqrt(1 - ratio**2), rel=1e-3)
    assert found.start == pytest.approx(0.03, rel=0.02)


@pytest.mark.parametrize(("ratio", "drag"), [(0.02, 6.0), (0.05, 10.0), (0.005, 2.0), (0.0, 8.0)])
def test_linear_and_quadratic_damping_are_told_apart(ratio, drag):
    found = fitted_decay(*decay_of(ratio, drag))
    # Averaging is accurate to the order of the damping itself.
    assert found.linear == pytest.approx(ratio, rel=0.01, abs=1e-4)
    assert found.quadratic == pytest.approx(4 * drag / (3 * np.pi), rel=0.05)
    amplitude, by_cycle = found.by_cycle
    expected = [ratio + 4 * drag / (3 * np.pi) * a for a in amplitude]
    np.testing.assert_allclose(by_cycle, expected, rtol=0.04)


def test_an_offset_does_not_matter():
    time_s, signal = decay_of(0.03, 3.0)
    plain, moved = fitted_decay(time_s, signal), fitted_decay(time_s, signal + 0.5)
    assert moved.ratio == pytest.approx(plain.ratio, rel=1e-6)


def test_the_envelope_solves_its_equation():
    phase = np.linspace(0, 30, 301)
    for linear, quadratic in ((0.02, 1.5), (0.0, 1.5), (0.03, 0.0)):
        exact = solve_ivp(
            lambda _, a, d=(linear, quadratic): -(d[0] * a + d[1] * a**2), (0, 30), [0.05], t_eval=phase,
            rtol=1e-10, atol=1e-14,
        ).y[0]  # fmt: skip
        np.testing.assert_allclose(envelope(phase, 0.05, linear, quadratic), exact, rtol=1e-7)


def test_a_signal_that_hardly_swings_is_refused():
    time_s = np.arange(0, 10, 0.1)
    with pytest.raises(ValueError, match="half cycles"):
        fitted_decay(time_s, np.exp(-time_s))


def pole() -> FemModel:
    bar = polygon_bar(sides=6, radius_m=0.09, length_m=8.0, layers=40, tip_radius_m=0.03)
    crown = bar.vertices_m[:, 1] > 4.0
    laden = replace(bar, mass_kg=np.where(crown, 25.0 / crown.sum(), 0.0))
    return build_model(laden, laden, WOOD, laden, FemSettings())


@pytest.fixture(scope="module")
def released():
    return pull_and_release(pole(), sway=0.02, cycles=9)


def test_without_drag_a_released_pole_has_the_damping_of_its_wood(released):
    mode = released.mode
    assert mode.number in (1, 2) and mode.mass_share > 0.45
    assert released.sway[0] == pytest.approx(0.02, rel=2e-3)
    assert released.decay.frequency_hz == pytest.approx(mode.frequency_hz, rel=0.005)
    assert released.decay.ratio == pytest.approx(WOOD.damping_ratio, rel=0.03)


def test_the_figures_of_a_release(released):
    figures = released.figures()
    assert figures["damping_ratio"] == released.decay.ratio
    assert len(figures["by_cycle"]["sway"]) == len(figures["by_cycle"]["damping_ratio"])


def test_drag_damps_a_larger_sway_more():
    model = pole()
    area = np.where(model.nodes_m[:, 1] > 4.0, 1.0, 0.0)
    model = replace(model, drag_area_m2=8.0 * area / area.sum())
    small, large = (pull_and_release(model, sway=sway, cycles=8).decay.ratio for sway in (0.005, 0.05))
    assert WOOD.damping_ratio < small < large


def test_the_main_mode_of_a_pole_is_its_first():
    mode = main_sway_mode(pole())
    assert mode.lowest_hz == pytest.approx(mode.frequency_hz, rel=1e-3)
    assert np.hypot(*mode.direction) == pytest.approx(1.0)


def test_a_sway_out_of_range_is_refused():
    with pytest.raises(ValueError, match="sway"):
        pull_and_release(pole(), sway=0.5)
