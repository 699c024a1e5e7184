"""Training winds of the modal model in addition to the paper's cosines: noise and gusts from all directions.

Cosine winds alone excite too little of the motion: every operator fitted to them diverged under other winds.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from galewood.sampling.recording import SampleWind
from galewood.util import Floats
from galewood.wind import dynamic_pressure

NOISE_WINDS, GUST_WINDS = 14, 6
FRAMES = 300
LEVELS = (0.35, 0.55, 0.75, 0.95)
"""Peak speeds relative to the design speed."""
INTENSITY = 0.35
SEED = 1
FURTHER_NOISE_WINDS, FURTHER_GUST_WINDS = 42, 6
FURTHER_LEVELS = (0.55, 0.75, 0.95)
"""Levels of the additional winds for trees that deflect strongly: strong winds, in which single limbs bend.
"""


def training_winds(design_speed_m_s: float, dt_s: float, *, seed: int = SEED) -> list[SampleWind]:
    """Noise with varying heading and single gusts, at several speeds."""
    rng = np.random.default_rng(seed)
    noises = _noises(rng, "learn", NOISE_WINDS, LEVELS, design_speed_m_s, dt_s)
    return noises + [_gust(rng, f"learn-gust-{k:02d}", k, design_speed_m_s, dt_s) for k in range(GUST_WINDS)]


def further_winds(design_speed_m_s: float, dt_s: float, *, seed: int = SEED) -> list[SampleWind]:
    """Additional winds for trees for which these are not sufficient."""
    rng = np.random.default_rng((seed, 1))
    noises = _noises(rng, "further", FURTHER_NOISE_WINDS, FURTHER_LEVELS, design_speed_m_s, dt_s)
    gusts = range(FURTHER_GUST_WINDS)
    return noises + [_gust(rng, f"further-gust-{k:02d}", k, design_speed_m_s, dt_s) for k in gusts]


def _noises(
    rng: np.random.Generator,
    name: str,
    count: int,
    levels: Sequence[float],
    design_speed_m_s: float,
    dt_s: float,
) -> list[SampleWind]:
    means_m_s = [0.75 * design_speed_m_s * levels[k % len(levels)] for k in range(count)]
    return [
        noise_wind(rng, f"{name}-noise-{k:02d}", mean_m_s, dt_s, FRAMES, most_m_s=design_speed_m_s)
        for k, mean_m_s in enumerate(means_m_s)
    ]


def noise_wind(
    rng: np.random.Generator, name: str, mean_m_s: float, dt_s: float, frames: int, *, most_m_s: float
) -> SampleWind:
    """Wind whose speed has a −5/3 spectrum about its mean and whose heading varies about a random one."""
    speed = np.clip(mean_m_s * (1.0 + INTENSITY * noise(rng, frames, dt_s, 5 / 3)), 0.0, most_m_s)
    start = rng.uniform(0, 2 * np.pi)
    heading = start + rng.uniform(0.3, 0.7) * noise(rng, frames, dt_s, 2.0)
    return _wind(name, start, speed, heading)


def noise(rng: np.random.Generator, frames: int, dt_s: float, beta: float) -> Floats:
    """(frames,) random series of unit variance with power ∝ f^−beta between 0.03 and 3 Hz."""
    frequency = np.fft.rfftfreq(2 * frames, dt_s)
    inside = (frequency >= 0.03) & (frequency <= 3.0)
    amplitude = np.where(inside, np.maximum(frequency, 0.03) ** (-beta / 2), 0.0)
    turned = amplitude * np.exp(2j * np.pi * rng.random(len(frequency)))
    series = np.fft.irfft(turned, 2 * frames)[:frames]
    return (series - series.mean()) / series.std()


def _gust(rng: np.random.Generator, name: str, k: int, design_speed_m_s: float, dt_s: float) -> SampleWind:
    """One gust, gradual or abrupt, followed by still air."""
    time_s = np.arange(FRAMES) * dt_s
    share = np.clip((time_s - rng.uniform(0, 1)) / rng.uniform(0.8, 4), 0, 1)
    rise = np.sin(np.pi * share) ** 2 if k % 2 == 0 else ((share > 0) & (share < 1)).astype(np.float64)
    heading = rng.uniform(0, 2 * np.pi)
    speed = design_speed_m_s * (0.5 + 0.1 * k) * rise
    return _wind(name, heading, speed, np.full(FRAMES, heading))


def _wind(name: str, start_rad: float, speed_m_s: Floats, heading_rad: Floats) -> SampleWind:
    along = np.stack([np.cos(heading_rad), np.sin(heading_rad)], axis=1)
    pressure = dynamic_pressure(speed_m_s)[:, None] * along
    return SampleWind(name, float(np.degrees(start_rad)), pressure, recorded=False)
