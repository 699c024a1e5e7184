"""Winds that no sample has, to judge a table by."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from precompute.tangent_winds import noise, noise_wind
from precompute.wind import dynamic_pressure

Floats = npt.NDArray[np.float64]


def unseen_winds(
    design_speed_m_s: float, frames: int, dt_s: float, *, strength: float = 0.65, seed: int = 20_001
) -> dict[str, Floats]:
    """Pressures (frames, 2) Pa that peak at ``strength`` of the design speed; the seed sets their turns."""
    rng = np.random.default_rng(seed)
    peak, t = strength * design_speed_m_s, np.arange(frames, dtype=np.float64) * dt_s
    cosine = peak * (1 + 0.45 * np.cos(2 * np.pi * (t / rng.uniform(2, 7) + 0.5))) / 1.45
    between = peak * (1 + 0.8 * np.cos(2 * np.pi * (t / 3.5 + 0.5))) / 1.8
    smooth = np.clip(0.6 + 0.25 * _smooth_noise(rng, t), 0, 1) * peak
    gust = peak * np.sin(np.pi * np.clip((t - 0.5) / 2.5, 0, 1)) ** 2
    return {
        "new-period-and-amplitude": _along(cosine, rng.uniform(0, 2 * np.pi)),
        "between-directions": _along(between, np.pi / 6),
        "perlin": _along(smooth, rng.uniform(0, 2 * np.pi) + 0.4 * noise(rng, frames, dt_s, 2.0)),
        "one-over-f": noise_wind(rng, "noise", 0.7 * peak, dt_s, frames, most_m_s=peak).pressure_pa,
        "step": _along(0.85 * peak * (t > 1.0), rng.uniform(0, 2 * np.pi)),
        "gust-then-still": _along(gust, rng.uniform(0, 2 * np.pi)),
    }


def _along(speed_m_s: npt.NDArray[np.floating[Any]], heading_rad: Floats | float) -> Floats:
    """Pressure vectors of a speed and a heading."""
    heading = np.broadcast_to(heading_rad, speed_m_s.shape)
    return dynamic_pressure(speed_m_s)[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=1)


def _smooth_noise(rng: np.random.Generator, time_s: Floats) -> Floats:
    """Two octaves of gradient noise over time (Perlin), of about unit amplitude."""
    total = np.zeros_like(time_s)
    for period_s, amplitude in ((4.0, 2.0), (1.5, 1.0)):
        place = time_s / period_s + rng.uniform(0, 100)
        slopes = rng.uniform(-1, 1, int(place.max()) + 2)
        cell = np.floor(place).astype(np.int64)
        within = place - cell
        fade = within**3 * (within * (6 * within - 15) + 10)
        total += amplitude * ((1 - fade) * slopes[cell] * within + fade * slopes[cell + 1] * (within - 1)) * 2
    return total
