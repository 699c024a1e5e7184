"""Damping by the random decrement technique (Cole 1973): the mean of what follows equal deflections.

Passages of a sway that begin with the same deflection differ in the wind that follows. Their mean is a free
decay from that deflection.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import optimize, signal

from galewood.util import Floats

TRIGGER_DEVIATIONS = 1.4142135623730951
"""Deflection at which passages begin, over the standard deviation: √2 has the least scatter (Cole 1973)."""
PASSAGE_CYCLES = 6.0
FEWEST_PASSAGES = 20
BAND_PER_FREQUENCY = (0.5, 1.6)
"""Band that is kept, over the frequency: wide, as a narrow filter rings and lowers the damping."""


@dataclass(frozen=True)
class Decrement:
    """The mean decay: times (k,) s, deflection (k,) over the first, its fit, frequency and damping ratio."""

    time_s: Floats
    deflection: Floats
    fitted: Floats
    frequency_hz: float
    damping_ratio: float
    passage_count: int


def random_decrement(sway: Floats, rate_hz: float, frequency_hz: float) -> Decrement:
    """The decay of a sway (n,) near a frequency. Raises ValueError for fewer than 20 passages."""
    low, high = (
        BAND_PER_FREQUENCY[0] * frequency_hz,
        min(BAND_PER_FREQUENCY[1] * frequency_hz, 0.45 * rate_hz),
    )
    if high <= low:
        raise ValueError("the record has too few samples per second for this frequency")
    band_pass = signal.butter(2, [low, high], "bandpass", fs=rate_hz, output="sos")
    kept = signal.sosfiltfilt(band_pass, sway)
    level = TRIGGER_DEVIATIONS * float(np.std(kept))
    count = round(PASSAGE_CYCLES / frequency_hz * rate_hz)
    both = np.concatenate([_passages(sign * kept, level, count) for sign in (1.0, -1.0)])
    if len(both) < FEWEST_PASSAGES:
        raise ValueError(f"only {len(both)} passages begin at √2 standard deviations; 20 are needed")
    mean = both.mean(axis=0)
    time_s = np.arange(count) / rate_hz
    return _fitted(time_s, mean / mean[0], frequency_hz, len(both))


def _passages(sway: Floats, level: float, count: int) -> Floats:
    """(p, count) passages after upward crossings of a level."""
    crossed = np.flatnonzero((sway[:-1] < level) & (sway[1:] >= level)) + 1
    starts = crossed[crossed + count <= len(sway)]
    return sway[starts[:, None] + np.arange(count)]


def _fitted(time_s: Floats, deflection: Floats, frequency_hz: float, passages: int) -> Decrement:
    def decay(x: Floats) -> Floats:
        omega, ratio = np.exp(x[0]), np.exp(x[1])
        turned = omega * np.sqrt(max(1 - ratio**2, 1e-6)) * time_s
        return np.exp(-ratio * omega * time_s) * (x[2] * np.cos(turned) + x[3] * np.sin(turned))

    def gap(x: Floats) -> Floats:
        return decay(x) - deflection

    start = [np.log(2 * np.pi * frequency_hz), np.log(0.05), float(deflection[0]), 0.0]
    bounds = ([start[0] - 0.3, np.log(1e-3), -10, -10], [start[0] + 0.3, np.log(0.9), 10, 10])
    found = optimize.least_squares(gap, start, bounds=bounds).x
    return Decrement(
        time_s, deflection, decay(found), float(np.exp(found[0]) / (2 * np.pi)), float(np.exp(found[1])),
        passages,
    )  # fmt: skip
