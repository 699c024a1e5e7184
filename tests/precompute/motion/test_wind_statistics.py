"""The statistics of the winds agree with their documents."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from galewood.constants import EDDY_GRID, TURBULENCE_PER_GUSTINESS
from galewood.motion.wind.evaluation import Wind, WindField
from galewood.motion.wind.models.navier_stokes import Eddies
from scipy.signal import welch

LENGTH_M, CONVECTION_M_S, MEAN_M_S = 20.0, 8.0, 10.0
TRAVELLING = ("perlin", "spectral", "navier-stokes")
MODELS = ("cosine", *TRAVELLING)
SEEDS = (1, 4294967295)


def wind_of(model: str, seed: int, **more: Any) -> Wind:
    return Wind(MEAN_M_S, 0.0, 0.5, CONVECTION_M_S, seed, model, LENGTH_M, **more)


def gusts(wind: Wind, x_m: np.ndarray, z_m: np.ndarray, times_s: np.ndarray) -> np.ndarray:
    """(times, places) velocity along the wind, which blows along x, m/s."""
    field, out = WindField(wind), np.zeros((2, len(x_m)))
    rows = np.empty((len(times_s), len(x_m)))
    for row, time_s in zip(rows, times_s, strict=True):
        field.velocity(x_m, z_m, float(time_s), out[0], out[1])
        row[:] = out[0]
    return rows


def scattered(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    x, z = np.random.default_rng(seed).uniform(-300.0, 300.0, (2, count))
    return x, z


def slope(frequency: np.ndarray, power: np.ndarray, low: float, high: float) -> float:
    """Slope of power over frequency, both logarithmic, with equal weight for every octave."""
    edges = np.geomspace(low, high, 13)
    bins = [(frequency >= a) & (frequency < b) for a, b in itertools.pairwise(edges)]
    points = [(np.log(frequency[b]).mean(), np.log(power[b].mean())) for b in bins if b.any()]
    return float(np.polyfit(*np.array(points, np.float64).T, deg=1)[0])


def spectrum(seed: int, beta: float) -> tuple[np.ndarray, np.ndarray]:
    """Reduced frequencies (n = f L / c) and the mean power over a hundred trees."""
    x, z = scattered(100, seed)
    dt_s = 0.125
    series = gusts(wind_of("spectral", seed, beta=beta), x, z, np.arange(2048) * dt_s)
    frequency, power = welch(series, 1.0 / dt_s, nperseg=1024, axis=0)
    return frequency * LENGTH_M / CONVECTION_M_S, power.mean(axis=1)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("beta", [0.0, 1.0, 5.0 / 3.0, 2.0])
def test_spectral_power_falls_with_minus_beta_over_a_decade(beta: float, seed: int) -> None:
    n, power = spectrum(seed, beta)
    fitted = slope(n, power, 0.4, 4.0)
    print(f"seed {seed}: slope {fitted:.3f} for −β = {-beta:.3f}")
    assert abs(fitted + beta) < 0.15


def test_spectral_power_is_flat_at_low_frequency() -> None:
    n, power = spectrum(3, 5.0 / 3.0)
    assert abs(slope(n, power, 0.02, 0.06)) < 0.5
    assert slope(n, power, 0.4, 4.0) < -1.5


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("model", MODELS)
def test_mean_and_variance_agree_with_the_document(model: str, seed: int) -> None:
    x, z = scattered(2000, seed)
    series = gusts(wind_of(model, seed), x, z, np.arange(0.0, 1600.0, 5.0))
    intensity = 0.5 * TURBULENCE_PER_GUSTINESS
    print(f"{model}, seed {seed}: mean {series.mean():.3f}, deviation {series.std():.4f}")
    assert series.mean() == pytest.approx(MEAN_M_S, rel=0.01)
    assert series.std() == pytest.approx(MEAN_M_S * intensity, rel=0.05)


@pytest.mark.parametrize("distance_m", [10.0, 24.0])
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("model", MODELS)
def test_gusts_arrive_downwind_after_distance_over_convection_speed(
    model: str, seed: int, distance_m: float
) -> None:
    """Averaged over 120 pairs, because single eddies move relative to the wind."""
    frame_s = 1.0 / 30.0
    x, z = scattered(120, seed)
    both_x, both_z = np.concatenate([x, x + distance_m]), np.concatenate([z, z])
    series = gusts(wind_of(model, seed), both_x, both_z, np.arange(0.0, 150.0, frame_s)) - MEAN_M_S
    expected = distance_m / CONVECTION_M_S / frame_s
    lags = np.arange(round(expected) - 20, round(expected) + 21)
    length = len(series) - lags[-1]
    match = [agreement(series[:length:3, :120], series[lag : lag + length : 3, 120:]) for lag in lags]
    found = lags[int(np.argmax(match))]
    print(f"{model}, seed {seed}: {found} frames, expected {expected:.1f}")
    assert abs(found - expected) <= 1.0


def agreement(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.sum(a * b) / np.sqrt(np.sum(a * a) * np.sum(b * b)))


def correlation(model: str, seed: int, along_m: float, across_m: float) -> float:
    """Correlation between trees at this distance, over many pairs and times."""
    x, z = scattered(200, seed)
    both_x, both_z = np.concatenate([x, x + along_m]), np.concatenate([z, z + across_m])
    series = gusts(wind_of(model, seed), both_x, both_z, np.arange(0.0, 900.0, 3.0)) - MEAN_M_S
    here, there = series[:, :200], series[:, 200:]
    return float(np.mean(here * there) / np.sqrt(np.mean(here**2) * np.mean(there**2)))


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("model", TRAVELLING)
@pytest.mark.parametrize(("along", "across"), [(1.0, 0.0), (0.0, 1.0)])
def test_neighbours_are_correlated_and_distant_trees_are_not(
    model: str, seed: int, along: float, across: float
) -> None:
    near = correlation(model, seed, 0.1 * LENGTH_M * along, 0.1 * LENGTH_M * across)
    far = correlation(model, seed, 3.0 * LENGTH_M * along, 3.0 * LENGTH_M * across)
    print(f"{model}, seed {seed}: {near:.3f} at 0.1 L, {far:.3f} at 3 L")
    assert near > 0.8
    assert far < 0.3


def test_eddies_stay_bounded_and_divergence_free_for_ten_thousand_steps() -> None:
    eddies = Eddies(11)
    energies: list[float] = []
    for step in range(10_000):
        eddies.step()
        if step % 500 == 0:
            assert divergence_share(eddies) < 1e-3
        energies.append(float(np.mean(np.square(eddies.velocity))))
    print(f"energy {min(energies):.3f} … {max(energies):.3f}, divergence {divergence_share(eddies):.1e}")
    assert min(energies) > 0.9
    assert max(energies) < 1.3


def divergence_share(eddies: Eddies) -> float:
    """Mean |∂u/∂x + ∂v/∂y| relative to the mean magnitude of the gradient, by central differences."""
    u, v = eddies.velocity.reshape(2, EDDY_GRID, EDDY_GRID)

    def d(a: np.ndarray, axis: int) -> np.ndarray:
        return 0.5 * (np.roll(a, -1, axis) - np.roll(a, 1, axis))

    gradient = np.sqrt(d(u, 1) ** 2 + d(u, 0) ** 2 + d(v, 1) ** 2 + d(v, 0) ** 2)
    return float(np.mean(np.abs(d(u, 1) + d(v, 0))) / np.mean(gradient))


@pytest.mark.parametrize("model", MODELS)
def test_another_seed_changes_the_wind_but_not_its_statistics(model: str) -> None:
    x, z = scattered(500, 1)
    one, other = (
        gusts(replace(wind_of(model, 1), seed=seed), x, z, np.arange(0.0, 300.0, 5.0)) for seed in (1, 2)
    )
    assert np.mean(np.abs(one - other)) > 0.5
