"""Unseen winds to evaluate a table with.

Drift shows as errors that grow while the wind does not. Every continuing wind therefore repeats seamlessly
after half a run, and its first pass, which starts with a tree at rest, is a lead-in. The step stays constant,
and the gust ends in still air.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.motion.wind import dynamic_pressure
from galewood.util import Floats

NOISE_BAND_HZ = (0.03, 3.0)
NOISE_INTENSITY = 0.35
GUST_END_S = 3.0


def unseen_winds(
    design_speed_m_s: float,
    frames: int,
    dt_s: float,
    exponent: float,
    *,
    strength: float,
    seed: int,
    first_hz: float | None = None,
) -> dict[str, Floats]:
    """Winds by name: pressures (frames, 2) Pa that peak at ``strength`` times the design speed.

    ``exponent`` is the streamlined exponent of the tree.
    Continuing winds are longer by their lead-in of half a run. The seed sets phases, periods and headings.
    With the tree's first natural frequency, a square wave of that frequency is one of them.
    """
    rng = np.random.default_rng(seed)
    half = max(frames // 2, 2)
    once, frames = frames, frames + half
    peak, t = strength * design_speed_m_s, np.arange(frames, dtype=np.float64) * dt_s
    cosine = peak * (1 + 0.45 * _cosine(t, half * dt_s, rng.uniform(2, 7))) / 1.45
    between = peak * (1 + 0.8 * _cosine(t, half * dt_s, 3.2)) / 1.8
    smooth = np.clip(0.6 + 0.25 * _repeated(perlin(rng, half, dt_s), frames), 0, 1) * peak
    turning = _repeated(noise(rng, half, dt_s, 2.0), frames)
    smooth_heading = rng.uniform(0, 2 * np.pi) + 0.4 * turning
    gust = peak * np.sin(np.pi * np.clip((t[:once] - 0.5) / (GUST_END_S - 0.5), 0, 1)) ** 2
    winds = {
        "new-period-and-amplitude": directed_pressure(cosine, rng.uniform(0, 2 * np.pi), exponent),
        "between-directions": directed_pressure(between, np.pi / 6, exponent),
        "perlin": directed_pressure(smooth, smooth_heading, exponent),
        "one-over-f": one_over_f(rng, frames, half, dt_s, peak, exponent),
        "step": directed_pressure(0.85 * peak * (t[:once] > 1.0), rng.uniform(0, 2 * np.pi), exponent),
        "gust-then-still": directed_pressure(gust, rng.uniform(0, 2 * np.pi), exponent),
    }
    if first_hz:
        square = peak * (np.sin(2 * np.pi * first_hz * t[:once]) > 0)
        winds["square-at-first-frequency"] = directed_pressure(square, rng.uniform(0, 2 * np.pi), exponent)
    return winds


def one_over_f(
    rng: np.random.Generator, frames: int, period: int, dt_s: float, peak_m_s: float, exponent: float
) -> Floats:
    """(frames, 2) Pa: speed with a −5/3 power spectrum around 0.7 of its peak, and a wandering heading."""
    series = _repeated(noise(rng, period, dt_s, 5 / 3), frames)
    wander = _repeated(noise(rng, period, dt_s, 2.0), frames)
    speed = np.clip(0.7 * peak_m_s * (1.0 + NOISE_INTENSITY * series), 0.0, peak_m_s)
    return directed_pressure(speed, rng.uniform(0, 2 * np.pi) + rng.uniform(0.3, 0.7) * wander, exponent)


def long_gusts(seed: int, frames: int, window: int, dt_s: float, peak_m_s: float, exponent: float) -> Floats:
    """(frames, 2) Pa: the same gusts in every window; the heading turns once around over the run."""
    rng = np.random.default_rng(seed)
    series, wander = (_repeated(noise(rng, window, dt_s, beta), frames) for beta in (5 / 3, 2.0))
    speed = np.clip(0.55 * peak_m_s * (1.0 + 0.45 * series), 0.0, peak_m_s)
    return directed_pressure(speed, 0.5 * wander + 2 * np.pi * np.arange(frames) / frames, exponent)


def directed_pressure(
    speed_m_s: npt.NDArray[np.floating[Any]], heading_rad: Floats | float, exponent: float
) -> Floats:
    """(frames, 2) Pa: pressure vectors of speeds (frames,) and a heading, one or (frames,).

    ``exponent`` is the streamlined exponent of the tree.
    """
    heading = np.broadcast_to(heading_rad, speed_m_s.shape)
    return dynamic_pressure(speed_m_s, exponent)[:, None] * np.stack(
        [np.cos(heading), np.sin(heading)], axis=1
    )


def noise(rng: np.random.Generator, period: int, dt_s: float, beta: float) -> Floats:
    """(period,) periodic random series of unit variance with power ∝ f^−beta inside the band."""
    low, high = NOISE_BAND_HZ
    frequency = np.fft.rfftfreq(period, dt_s)
    inside = (frequency >= low) & (frequency <= high)
    amplitude = np.where(inside, np.maximum(frequency, low) ** (-beta / 2), 0.0)
    series = np.fft.irfft(amplitude * np.exp(2j * np.pi * rng.random(len(frequency))), period)
    return (series - series.mean()) / max(float(series.std()), 1e-12)


def perlin(rng: np.random.Generator, period: int, dt_s: float) -> Floats:
    """(period,) periodic gradient noise of two octaves (Perlin 2002), of about unit amplitude."""
    share, total = np.arange(period) / period, np.zeros(period)
    for cell_s, amplitude in ((4.0, 2.0), (1.5, 1.0)):
        cells = max(2, round(period * dt_s / cell_s))
        slopes = rng.uniform(-1, 1, cells)
        place = share * cells
        cell = np.floor(place).astype(np.int64)
        within = place - cell
        fade = within**3 * (within * (6 * within - 15) + 10)
        left, right = slopes[cell] * within, slopes[(cell + 1) % cells] * (within - 1)
        total += amplitude * ((1 - fade) * left + fade * right) * 2
    return total


def _cosine(time_s: Floats, whole_s: float, period_s: float) -> Floats:
    """Cosine wave from its minimum, with the period adjusted to divide ``whole_s``."""
    times = max(1, round(whole_s / period_s))
    return np.cos(2 * np.pi * (time_s * times / whole_s + 0.5))


def _repeated(series: Floats, frames: int) -> Floats:
    return np.resize(series, frames)
