"""Frequency and damping of a free decay whose damping depends on its amplitude.

Internal friction damps a sway in proportion to its velocity, drag in proportion to its square. The envelope
then falls by da/dφ = −(d₀ a + d₁ a²) with the phase φ, where d = ζ / √(1 − ζ²) for the damping ratio ζ
(Nayfeh and Mook 1979, chapter 3: averaging; accurate for small ζ). A force c |v| v per mass gives
d₁ = 4 c / (3 π).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from galewood.util import Floats

FEWEST_PEAKS = 4
MIN_PEAK_SHARE = 0.01
"""Peaks below this share of the first are left out."""
SHOWN_CYCLES = 3
"""Cycles over which the damping ratio is averaged."""


@dataclass(frozen=True)
class Decay:
    """A fitted free decay; amplitudes have the unit of the signal."""

    frequency_hz: float
    amplitudes: Floats
    """(k,) amplitude of each half cycle: half the distance between its two extrema."""
    start: float
    """Fitted amplitude at the first extremum."""
    linear: float
    """d₀: damping at small amplitude."""
    quadratic: float
    """d₁, per unit of the signal."""

    def ratio_at(self, amplitude: float) -> float:
        """Damping ratio at an amplitude."""
        d = self.linear + self.quadratic * amplitude
        return d / float(np.hypot(1.0, d))

    @property
    def ratio(self) -> float:
        """Damping ratio by the logarithmic decrement of the first three cycles (or all, if fewer)."""
        cycles = min(SHOWN_CYCLES, (len(self.amplitudes) - 1) / 2)
        fitted = envelope(np.array([0.0, 2 * np.pi * cycles]), self.start, self.linear, self.quadratic)
        decrement = float(np.log(fitted[0] / fitted[1])) / (2 * np.pi * cycles)
        return decrement / float(np.hypot(1.0, decrement))

    @property
    def by_cycle(self) -> tuple[Floats, Floats]:
        """Amplitudes (k − 2,) and damping ratios (k − 2,) by the logarithmic decrement of single cycles."""
        first, last = self.amplitudes[:-2], self.amplitudes[2:]
        decrement = np.log(first / last) / (2 * np.pi)
        return np.sqrt(first * last), decrement / np.hypot(1.0, decrement)


def fitted_decay(time_s: Floats, signal: Floats) -> Decay:
    """Fit a decaying oscillation (T,) about a constant. Raises ValueError if it has too few cycles."""
    when, value = _extrema(time_s, signal)
    # Half the distance between consecutive extrema, so that a constant offset cancels.
    amplitudes = np.abs(np.diff(value)) / 2
    kept = _first_run(amplitudes > MIN_PEAK_SHARE * amplitudes.max()) if len(amplitudes) else 0
    if kept < FEWEST_PEAKS:
        raise ValueError(
            f"the decay has {kept} half cycles above {MIN_PEAK_SHARE:.0%} of its start; "
            f"{FEWEST_PEAKS} are needed"
        )
    amplitudes = amplitudes[:kept]
    start, linear, quadratic = _fit(amplitudes)
    period_s = 2 * float(np.polyfit(np.arange(kept + 1), when[: kept + 1], 1)[0])
    return Decay(1 / period_s, amplitudes, start, linear, quadratic)


def envelope(phase: Floats, start: float, linear: float, quadratic: float) -> Floats:
    """Amplitude at the phases (k,): the solution of da/dφ = −(d₀ a + d₁ a²), a(0) = start."""
    decayed = np.exp(-linear * phase)
    # (1 − exp(−d₀ φ)) / d₀, which is φ for d₀ = 0
    spent = np.where(np.abs(linear * phase) > 1e-12, -np.expm1(-linear * phase) / (linear or 1.0), phase)
    return start * decayed / (1 + quadratic * start * spent)


def _fit(amplitudes: Floats) -> tuple[float, float, float]:
    """Start, d₀ and d₁ ≥ 0 that fit the logarithms of the amplitudes of half cycles best."""
    phase = np.pi * (np.arange(len(amplitudes), dtype=np.float64) + 0.5)
    scale = float(amplitudes[0])
    logs = np.log(amplitudes / scale)

    def residual(x: Floats) -> Floats:
        return np.log(envelope(phase, float(np.exp(x[0])), float(x[1]), float(x[2]))) - logs

    slope = max(float(-logs[-1] / phase[-1]), 1e-6)
    bounds = ([-1.0, 0.0, 0.0], [1.0, np.inf, np.inf])
    found = least_squares(residual, [0.0, slope, 0.1 * slope], bounds=bounds, xtol=1e-14, ftol=1e-14).x
    return float(np.exp(found[0])) * scale, float(found[1]), float(found[2]) / scale


def _extrema(time_s: Floats, signal: Floats) -> tuple[Floats, Floats]:
    """Times and values of the extrema, by parabolas through three samples.

    The first sample is one of them if the signal starts at rest: it then moves less in its first step than in
    its second one.
    """
    middle, before, after = signal[1:-1], signal[:-2], signal[2:]
    places = np.flatnonzero((middle - before) * (after - middle) <= 0) + 1
    places = places[np.concatenate([[True], np.diff(places) > 1])] if len(places) else places
    step = float(time_s[1] - time_s[0])
    at_rest = abs(signal[1] - signal[0]) < 0.6 * abs(signal[2] - signal[1])
    when, value = ([time_s[0]], [signal[0]]) if at_rest else ([], [])
    for k in places:
        rise, bend = (signal[k + 1] - signal[k - 1]) / 2, signal[k + 1] - 2 * signal[k] + signal[k - 1]
        shift = -rise / bend if bend else 0.0
        when.append(time_s[k] + shift * step)
        value.append(signal[k] + rise * shift / 2)
    return np.array(when), np.array(value)


def _first_run(good: np.ndarray) -> int:
    """Number of leading true values."""
    return len(good) if good.all() else int(np.argmin(good))
