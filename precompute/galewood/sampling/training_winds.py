"""Training winds of the modal model: gusty winds with turning headings, half of which stop abruptly.

Cosine winds alone excite too little of the motion: every operator fitted to them diverged under other winds
(docs/design/0013-training-runs.md).
"""

from __future__ import annotations

import numpy as np

from galewood.sampling.recording import SampleWind
from galewood.sampling.seed import SEED
from galewood.util import Floats
from galewood.wind import dynamic_pressure

WINDS, FRAMES = 20, 200
LEVELS = (0.5, 0.75, 1.0, 1.2)
"""Of the training winds, in turn: the mean speed is ``MEAN_SHARE`` × level × the design speed."""
MEAN_SHARE = 0.75
GUSTINESS = 0.45
"""Standard deviation of the speed over its mean."""
TURNS = 0.5
"""Turns of the heading during a wind, in addition to its variation."""
CALM_FRAMES = 60
"""Still air at the end of every second wind: a free decay after an abrupt stop."""
GOLDEN_RAD = np.pi * (3.0 - np.sqrt(5.0))
"""Between the headings at which successive winds start, so that any few of them differ."""

FURTHER_WINDS = 20
"""Additional winds for trees that bend far, which continue the sequence."""


def training_winds(
    design_speed_m_s: float, dt_s: float, *, seed: int = SEED, count: int = WINDS
) -> list[SampleWind]:
    """Noise with a turning heading at several speeds, at most the design speed; every second one stops.

    A smaller ``count`` gives the first of them.
    """
    rng = np.random.default_rng((seed, 2))
    first_rad = rng.uniform(0, 2 * np.pi)
    turn_rad = TURNS * np.linspace(0, 2 * np.pi, FRAMES)
    winds: list[SampleWind] = []
    for k in range(count):
        mean_m_s = MEAN_SHARE * LEVELS[k % len(LEVELS)] * design_speed_m_s
        speed_m_s = np.clip(noisy_speed(rng, mean_m_s, GUSTINESS, FRAMES, dt_s), 0.0, design_speed_m_s)
        if k % 2:
            speed_m_s[-CALM_FRAMES:] = 0.0
        start_rad, side = first_rad + k * GOLDEN_RAD, 1.0 if k % 3 else -1.0
        heading_rad = start_rad + side * turn_rad + _wander(rng, FRAMES, dt_s)
        winds.append(_wind(f"learn-{k:02d}", start_rad, speed_m_s, heading_rad))
    return winds


def further_winds(design_speed_m_s: float, dt_s: float, *, seed: int = SEED) -> list[SampleWind]:
    """Additional winds for trees for which these are not sufficient."""
    return training_winds(design_speed_m_s, dt_s, seed=seed, count=WINDS + FURTHER_WINDS)[WINDS:]


def noisy_speed(
    rng: np.random.Generator, mean_m_s: float, gustiness: float, frames: int, dt_s: float
) -> Floats:
    """(frames,) speed, m/s, that varies about its mean with a −5/3 spectrum."""
    return mean_m_s * (1.0 + gustiness * noise(rng, frames, dt_s, 5 / 3))


def _wander(rng: np.random.Generator, frames: int, dt_s: float) -> Floats:
    """(frames,) random variation of a heading, radians."""
    return rng.uniform(0.3, 0.7) * noise(rng, frames, dt_s, 2.0)


def noise(rng: np.random.Generator, frames: int, dt_s: float, beta: float) -> Floats:
    """(frames,) random series of unit variance with power ∝ f^−beta between 0.03 and 3 Hz."""
    frequency = np.fft.rfftfreq(2 * frames, dt_s)
    inside = (frequency >= 0.03) & (frequency <= 3.0)
    amplitude = np.where(inside, np.maximum(frequency, 0.03) ** (-beta / 2), 0.0)
    turned = amplitude * np.exp(2j * np.pi * rng.random(len(frequency)))
    series = np.fft.irfft(turned, 2 * frames)[:frames]
    return (series - series.mean()) / series.std()


def _wind(name: str, start_rad: float, speed_m_s: Floats, heading_rad: Floats) -> SampleWind:
    along = np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
    pressure = dynamic_pressure(speed_m_s)[:, None] * along
    return SampleWind(name, float(np.degrees(start_rad)), pressure, recorded=False)
