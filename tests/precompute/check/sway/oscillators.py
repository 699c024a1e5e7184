"""Exact samples of an oscillator under noise, as records of a tree."""

from __future__ import annotations

from typing import Any

import numpy as np
from galewood.util import Floats
from scipy.linalg import expm
from scipy.signal import cont2discrete, lfilter


def driven_oscillator(
    frequency_hz: float, damping_ratio: float, rate_hz: float, duration_s: float, seed: int
) -> Floats:
    """(n,) displacement of an oscillator under white noise; its statistics are exact at the samples.

    The covariance of the noise over a step is that of Van Loan (IEEE Transactions on Automatic Control 23,
    1978).
    """
    omega, step_s = 2 * np.pi * frequency_hz, 1 / rate_hz
    drift = np.array([[0.0, 1.0], [-(omega**2), -2 * damping_ratio * omega]])
    block = np.zeros((4, 4))
    block[:2, :2], block[:2, 2:], block[2:, 2:] = -drift, np.diag([0.0, 1.0]), drift.T
    grown = expm(block * step_s)
    transition = grown[2:, 2:].T
    noise = np.linalg.cholesky(transition @ grown[:2, 2:])
    generator = np.random.default_rng(seed)
    count, settled = round(duration_s * rate_hz), round(20 / (damping_ratio * omega) * rate_hz)
    kicks = generator.normal(size=(count + settled, 2)) @ noise.T
    state, found = np.zeros(2), np.empty(count + settled)
    for k, kick in enumerate(kicks):
        state = transition @ state + kick
        found[k] = state[0]
    return found[settled:] / found[settled:].std()


def slow_noise(rate_hz: float, duration_s: float, corner_hz: float, seed: int) -> Floats:
    """(n,) noise of unit variance whose spectrum falls with f⁻² above a frequency, as that of gusts."""
    keep = float(np.exp(-2 * np.pi * corner_hz / rate_hz))
    white = np.random.default_rng(seed).normal(size=round(duration_s * rate_hz))
    found = np.asarray(lfilter([1.0], [1.0, -keep], white), np.float64)
    return found / found.std()


def answer_to(force: Floats, frequency_hz: float, damping_ratio: float, rate_hz: float) -> Floats:
    """(n,) displacement of an oscillator under a force (n,) that is constant between samples; of gain 1."""
    omega = 2 * np.pi * frequency_hz
    drift = np.array([[0.0, 1.0], [-(omega**2), -2 * damping_ratio * omega]])
    system = (drift, np.array([[0.0], [omega**2]]), np.array([[1.0, 0.0]]), np.zeros((1, 1)))
    discrete: Any = cont2discrete(system, 1 / rate_hz)
    transition, gain = discrete[0], discrete[1][:, 0]
    state, found = np.zeros(2), np.empty(len(force))
    for k, one in enumerate(force):
        found[k] = state[0]
        state = transition @ state + gain * one
    return found
