"""Frequencies, damping and axes of synthetic records against those that they were made with."""

from __future__ import annotations

import numpy as np
import pytest
from galewood.check.sway import SwayAnalysis, analyse_motion
from galewood.measurements import motion_record
from galewood.util import Floats

from tests.precompute.check.sway.oscillators import answer_to, driven_oscillator, slow_noise

HOUR_S = 3600.0
RATE_HZ = 10.0
SEED = 20611


def analysis_of(values: Floats, rate_hz: float = RATE_HZ, wind_m_s: Floats | None = None) -> SwayAnalysis:
    return analyse_motion(motion_record(np.arange(len(values)) / rate_hz, values, wind_m_s=wind_m_s))


@pytest.mark.parametrize(
    ("frequency_hz", "damping_ratio"), [(0.18, 0.03), (0.25, 0.08), (0.4, 0.05), (0.9, 0.02), (0.3, 0.15)]
)
def test_frequency_and_damping_of_an_hour(frequency_hz: float, damping_ratio: float) -> None:
    """Within three standard errors of the best possible estimate, whose relative error of ζ is about
    1/√(2 ζ ω T / 2)."""
    record = driven_oscillator(frequency_hz, damping_ratio, RATE_HZ, HOUR_S, SEED)
    found = analysis_of(record).along
    assert found.resonance is not None and found.decrement is not None
    cycles = 2 * np.pi * frequency_hz * HOUR_S * damping_ratio
    assert found.resonance.frequency_hz == pytest.approx(
        frequency_hz, rel=3 * damping_ratio / np.sqrt(cycles)
    )
    assert found.resonance.damping_ratio == pytest.approx(damping_ratio, rel=4 / np.sqrt(cycles))
    assert 0.7 < found.resonance.damping_error / (damping_ratio / np.sqrt(cycles)) < 3
    assert found.decrement.damping_ratio == pytest.approx(damping_ratio, rel=0.35)


def test_errors_are_as_stated() -> None:
    """Over twenty records the true value lies within two standard errors as often as it should."""
    inside = 0
    for seed in range(20):
        found = analysis_of(driven_oscillator(0.3, 0.05, 5.0, 1200.0, SEED + seed), 5.0).along.resonance
        assert found is not None
        inside += abs(found.damping_ratio - 0.05) < 2 * found.damping_error
    assert inside >= 15


def test_gusts_and_noise_of_the_instrument_do_not_hide_the_resonance() -> None:
    """Gusts drive the tree, its other modes answer them without inertia, and the sensor adds noise."""
    gusts = slow_noise(RATE_HZ, 2 * HOUR_S, 0.01, SEED + 1)
    noise = np.random.default_rng(SEED + 2).normal(size=len(gusts))
    sway = answer_to(gusts, 0.25, 0.06, RATE_HZ) + 0.5 * gusts
    found = analysis_of(sway + 0.02 * sway.std() * noise).along.resonance
    assert found is not None
    assert found.frequency_hz == pytest.approx(0.25, rel=0.03)
    assert found.damping_ratio == pytest.approx(0.06, rel=0.2)


def test_a_second_mode_is_not_taken_for_the_first() -> None:
    sway = driven_oscillator(0.22, 0.05, RATE_HZ, HOUR_S, SEED)
    second = driven_oscillator(1.1, 0.04, RATE_HZ, HOUR_S, SEED + 1)
    found = analysis_of(sway + 0.3 * second).along.resonance
    assert found is not None and found.frequency_hz == pytest.approx(0.22, rel=0.03)


def test_accelerations_are_judged_by_their_displacement() -> None:
    """The acceleration of a second mode is larger, its displacement is not."""
    first = driven_oscillator(0.25, 0.05, RATE_HZ, HOUR_S, SEED)
    second = driven_oscillator(0.8, 0.04, RATE_HZ, HOUR_S, SEED + 1)
    time_s = np.arange(len(first)) / RATE_HZ
    record = motion_record(time_s, first + 3 * second, quantity="acceleration")
    found = analyse_motion(record).along.resonance
    assert found is not None and found.frequency_hz == pytest.approx(0.25, rel=0.04)


def test_the_drift_of_a_sensor_does_not_matter() -> None:
    sway = np.column_stack([driven_oscillator(0.2, 0.05, RATE_HZ, HOUR_S, SEED + k) for k in range(2)])
    drift = 20 * np.sin(2 * np.pi * np.arange(len(sway)) / len(sway))
    plain, drifting = analysis_of(sway), analysis_of(sway + drift[:, None] * [1.0, 0.5])
    assert plain.variance_ratio is not None and drifting.variance_ratio is not None
    assert drifting.variance_ratio == pytest.approx(plain.variance_ratio, rel=0.1)
    assert drifting.along.deviation == pytest.approx(plain.along.deviation, rel=0.05)


def test_principal_axes_are_found() -> None:
    along = 3 * driven_oscillator(0.2, 0.05, RATE_HZ, HOUR_S, SEED)
    across = driven_oscillator(0.23, 0.05, RATE_HZ, HOUR_S, SEED + 1)
    angle = np.radians(35.0)
    turned = np.column_stack([
        np.cos(angle) * along - np.sin(angle) * across, np.sin(angle) * along + np.cos(angle) * across
    ])  # fmt: skip
    found = analysis_of(turned)
    assert found.direction_deg == pytest.approx(35.0, abs=2.0)
    assert found.variance_ratio == pytest.approx(9.0, rel=0.15)
    assert found.along.resonance is not None and found.across is not None
    assert found.along.resonance.frequency_hz == pytest.approx(0.2, rel=0.02)
    assert found.across.resonance is not None
    assert found.across.resonance.frequency_hz == pytest.approx(0.23, rel=0.02)


def test_the_slope_is_that_of_the_noise() -> None:
    """Noise with a corner far below the bands falls with f⁻²."""
    found = analysis_of(slow_noise(20.0, HOUR_S, 0.001, SEED), 20.0).along.slopes
    assert found["0.05-0.8"] == pytest.approx(-2.0, abs=0.1)
    white = np.random.default_rng(SEED).normal(size=72_000)
    assert analysis_of(white, 20.0).along.slopes["0.05-0.8"] == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize("rate_hz", [1.0, 4.0, 33.3, 100.0])
def test_rates_of_loggers(rate_hz: float) -> None:
    found = analysis_of(driven_oscillator(0.2, 0.06, rate_hz, 1800.0, SEED), rate_hz).along
    assert found.resonance is not None
    assert found.resonance.frequency_hz == pytest.approx(0.2, rel=0.04)


def test_the_answer_to_the_wind() -> None:
    """A sway in proportion to U^1.5, and a gain of 2 per m²/s² far below the resonance."""
    generator = np.random.default_rng(SEED)
    count = 12 * 6000
    mean = np.repeat(np.linspace(3.0, 12.0, 12), 6000)
    gusts = slow_noise(RATE_HZ, count / RATE_HZ, 0.02, SEED)
    found = analysis_of(mean**1.5 * gusts, RATE_HZ, mean * (1 + 0.05 * generator.normal(size=count))).wind
    assert found is not None and found.exponent == pytest.approx(1.5, abs=0.25)
    wind = 6.0 + gusts
    answer = analysis_of(2 * wind**2, RATE_HZ, wind).wind
    assert answer is not None
    np.testing.assert_allclose(answer.gain[:20], 2.0, rtol=0.05)
    np.testing.assert_allclose(answer.coherence[:20], 1.0, atol=0.05)


def test_a_record_without_a_resonance_keeps_its_other_figures() -> None:
    found = analysis_of(np.random.default_rng(SEED).normal(size=400), 10.0)
    figures = found.figures()
    assert figures["along"]["standard_deviation"] > 0
    assert found.along.resonance is not None or figures["along"]["notes"]
