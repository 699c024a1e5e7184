"""Power spectrum of a recorded sway: principal axes, slope, frequency and damping of the main resonance.

The resonance is fitted to the raw periodogram by Whittle's likelihood (Whittle 1953; Percival and Walden,
Spectral Analysis for Physical Applications, 1993): averaging over segments, as for a plot, would broaden a
narrow resonance and overstate its damping. The model is that of one oscillator under a wind whose spectrum is
a power law, of other modes that answer the same wind without inertia, and of white noise of the instrument:

    S(f) = A (f/f₀)^−α |1 / (1 − (f/f₀)² + 2 i ζ f/f₀) + b|² + C
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy import optimize, signal

from galewood.util import Floats

TREE_BAND_HZ = (0.04, 8.0)
"""Band in which main resonances of trees are sought."""
AROUND_RESONANCE = (0.35, 1.9)
"""Band of the last fit, over the frequency: other modes lie outside, and enough of the background inside."""
NYQUIST_SHARE = 0.8
"""Share of the Nyquist frequency that is used: filters of loggers act above it."""
TAPERED_SHARE = 0.1
"""Share of a record that is tapered, so that its ends do not leak into the resonance."""
ROUNDING_SHARE = 1e-12
"""Of the largest value of a record: what its drift leaves of a constant one, or of a ramp, is no motion."""
DRIFT_S = 600.0
FEWEST_DRIFT_PERIODS = 3
"""A shorter record, in periods of the drift, has no room for the filter."""
SLOPE_RATE_HZ = 4.0
SLOPE_BANDS_HZ = ((0.05, 0.8), (0.05, 2.0), (1.0, 2.0))
SEGMENT_S = 128.0
MOST_CANDIDATES = 6
DAMPING_LIMITS = (0.002, 0.6)
BROADEST_RATIO = 0.45
"""What a fit finds broader than this is no resonance but the shape of the background."""
LEAST_GAIN = 12.0
"""Gain in the logarithm of the likelihood that a resonance's three parameters need."""
START_RANGE = 0.25
"""How far a fit may move from its peak, on logarithmic axes; at this limit it follows another peak."""
FEWEST_LINES = 20
"""Lines of the periodogram about a resonance that a fit needs."""


class PrincipalAxes(NamedTuple):
    """Sway along the principal axes, (n,) each, the ratio of their variances, and the first one's direction.

    direction_deg is measured from the first axis of the record to the second. A record of one axis has no
    second: None, and the ratio is NaN.
    """

    along: Floats
    across: Floats | None
    variance_ratio: float
    direction_deg: float


@dataclass(frozen=True)
class Resonance:
    """Main resonance of a sway: frequency, damping ratio, their standard errors, and the fitted spectrum.

    parameters (6,): ln A, α, ln f₀, ln ζ, ln C, b.
    """

    frequency_hz: float
    damping_ratio: float
    frequency_error_hz: float
    damping_error: float
    parameters: Floats

    @property
    def variance(self) -> float:
        """Variance of the sway by the resonance: that of an oscillator under white noise, A π f₀ / (4 ζ)."""
        return float(np.exp(self.parameters[0])) * np.pi * self.frequency_hz / (4 * self.damping_ratio)

    def spectrum(self, frequency_hz: Floats) -> Floats:
        """(k,) fitted power spectral density."""
        return _model(self.parameters, frequency_hz)


def principal_axes(values: Floats) -> PrincipalAxes:
    """Turn a record (n, a) without drift to its principal axes."""
    centred = values - values.mean(axis=0)
    if centred.shape[1] == 1:
        return PrincipalAxes(centred[:, 0], None, float("nan"), 0.0)
    variance, axes = np.linalg.eigh(np.cov(centred.T))
    along, across = centred @ axes[:, 1], centred @ axes[:, 0]
    ratio = float(variance[1] / variance[0]) if variance[0] > 0 else float("inf")
    direction = float(np.degrees(np.arctan2(axes[1, 1], axes[0, 1]))) % 180.0
    return PrincipalAxes(along, across, ratio, direction)


def without_drift(values: Floats, rate_hz: float) -> Floats:
    """A record (n, a) without linear drift and, if it is long enough, without what takes over ten minutes.

    Sensors drift with temperature (Jackson and others, Biogeosciences 18, 2021: a high-pass filter of ten
    minutes).
    """
    level = np.asarray(signal.detrend(values, axis=0), np.float64)
    level[:, np.ptp(level, axis=0) <= ROUNDING_SHARE * np.abs(values).max(axis=0)] = 0.0
    if len(level) < FEWEST_DRIFT_PERIODS * DRIFT_S * rate_hz:
        return level
    high_pass = signal.butter(2, 1 / DRIFT_S, "highpass", fs=rate_hz, output="sos")
    return np.asarray(signal.sosfiltfilt(high_pass, level, axis=0), np.float64)


def welch(sway: Floats, rate_hz: float) -> tuple[Floats, Floats]:
    """Frequencies (k,) Hz and power spectral density (k,), averaged over Hann segments of 128 s."""
    length = int(min(len(sway), max(16, round(SEGMENT_S * rate_hz))))
    frequency, density = signal.welch(sway, rate_hz, nperseg=length, detrend="linear")
    return frequency[1:], density[1:]


def slopes(sway: Floats, rate_hz: float) -> dict[str, float]:
    """Slopes of the spectrum on logarithmic axes in ``SLOPE_BANDS_HZ``, resampled to 4 Hz.

    By a straight line through the averaged spectrum. Bands beyond the record's own are left out.
    """
    if rate_hz > SLOPE_RATE_HZ:
        sway, rate_hz = resampled(sway, rate_hz, SLOPE_RATE_HZ), SLOPE_RATE_HZ
    frequency, density = welch(sway, rate_hz)
    found: dict[str, float] = {}
    for low, high in SLOPE_BANDS_HZ:
        inside = (frequency >= low) & (frequency <= min(high, rate_hz / 2)) & (density > 0)
        if high <= rate_hz / 2 + 1e-9 and inside.sum() > 3:
            line = np.polyfit(np.log(frequency[inside]), np.log(density[inside]), 1)
            found[f"{low:g}-{high:g}"] = float(line[0])
    return found


def resampled(sway: Floats, rate_hz: float, new_hz: float) -> Floats:
    """The sway at a lower rate, filtered against aliases."""
    count = max(1, round(len(sway) * new_hz / rate_hz))
    ratio = rate_hz / new_hz
    if abs(ratio - round(ratio)) < 1e-6:
        return np.asarray(signal.resample_poly(sway, 1, round(ratio)), np.float64)
    low_pass = signal.butter(8, 0.9 * new_hz / rate_hz, output="sos")
    smooth = signal.sosfiltfilt(low_pass, sway)
    return np.interp(np.arange(count) * ratio, np.arange(len(sway)), smooth)


def main_resonance(sway: Floats, rate_hz: float, *, of_acceleration: bool = False) -> Resonance:
    """Fit the main resonance of a sway (n,): that with the largest variance of the displacement.

    Raises ValueError if the record has none.
    """
    if np.ptp(sway) == 0:
        raise ValueError("the record has no motion")
    frequency, power = _periodogram(sway, rate_hz)
    low, high = TREE_BAND_HZ[0], min(TREE_BAND_HZ[1], NYQUIST_SHARE * rate_hz / 2)
    found: list[tuple[float, Resonance]] = []
    for start in _candidates(sway, rate_hz, low, high):
        near = (frequency >= AROUND_RESONANCE[0] * start) & (
            frequency <= min(AROUND_RESONANCE[1] * start, NYQUIST_SHARE * rate_hz / 2)
        )
        if near.sum() < FEWEST_LINES:
            continue
        one = _resonance(frequency[near], power[near], start)
        if one is not None:
            scale = one.frequency_hz**-4 if of_acceleration else 1.0
            found.append((scale * one.variance, one))
    if not found:
        raise ValueError("the spectrum has no clear resonance")
    return max(found, key=lambda pair: pair[0])[1]


def _resonance(frequency_hz: Floats, power: Floats, start_hz: float) -> Resonance | None:
    """The resonance near a frequency; None if a spectrum without one fits nearly as well."""
    fitted = _fitted(frequency_hz, power, start_hz)
    elsewhere = abs(fitted.x[2] - np.log(start_hz)) > 0.99 * START_RANGE
    if elsewhere or np.exp(fitted.x[3]) > BROADEST_RATIO:
        return None
    if _background(frequency_hz, power) - fitted.fun < LEAST_GAIN:
        return None
    errors = _standard_errors(fitted.x, frequency_hz, power)
    f0, ratio = float(np.exp(fitted.x[2])), float(np.exp(fitted.x[3]))
    return Resonance(f0, ratio, float(f0 * errors[2]), float(ratio * errors[3]), fitted.x)


def _background(frequency_hz: Floats, power: Floats) -> float:
    """Minus the logarithm of the likelihood of a power law and white noise."""
    scale, middle = float(np.mean(power)), float(np.sqrt(frequency_hz[0] * frequency_hz[-1]))

    def minus_likelihood(x: Floats) -> float:
        density = np.exp(x[0]) * (frequency_hz / middle) ** -x[1] + np.exp(x[2])
        return float(np.sum(np.log(density) + power / density))

    start = [np.log(scale) - 0.7, 1.0, np.log(scale) - 3]
    bounds = [(np.log(scale) - 60, np.log(scale) + 20), (-8.0, 8.0), (np.log(scale) - 60, np.log(scale) + 20)]
    return float(optimize.minimize(minus_likelihood, start, method="L-BFGS-B", bounds=bounds).fun)


def _periodogram(sway: Floats, rate_hz: float) -> tuple[Floats, Floats]:
    window: Any = ("tukey", TAPERED_SHARE)
    frequency, power = signal.periodogram(sway, rate_hz, window=window, detrend="linear")
    return frequency[1:], np.maximum(power[1:], np.finfo(np.float64).tiny)


def _candidates(sway: Floats, rate_hz: float, low_hz: float, high_hz: float) -> list[float]:
    """Frequencies of the highest peaks of the averaged spectrum above its trend."""
    frequency, density = welch(sway, rate_hz)
    inside = (frequency >= low_hz) & (frequency <= high_hz) & (density > 0)
    f, logs = np.log(frequency[inside]), np.log(density[inside])
    if len(f) < 8:
        return []
    above = logs - np.polyval(np.polyfit(f, logs, 2), f)
    peaks, _ = signal.find_peaks(above)
    highest = peaks[np.argsort(-above[peaks])][:MOST_CANDIDATES]
    return [float(np.exp(f[peak])) for peak in highest]


def _model(parameters: Floats, frequency_hz: Floats) -> Floats:
    """Spectral density of an oscillator and of other modes under coloured noise, and white noise."""
    ratio = frequency_hz / np.exp(parameters[2])
    answer = np.abs(1 / (1 - ratio**2 + 2j * np.exp(parameters[3]) * ratio) + parameters[5]) ** 2
    return np.exp(parameters[0]) * ratio ** -parameters[1] * answer + np.exp(parameters[4])


def _minus_likelihood(parameters: Floats, frequency_hz: Floats, power: Floats) -> float:
    density = _model(parameters, frequency_hz)
    return float(np.sum(np.log(density) + power / density))


def _fitted(frequency_hz: Floats, power: Floats, start_hz: float) -> optimize.OptimizeResult:
    """The parameters with the largest likelihood near a start."""
    scale = float(np.mean(power))
    noise = np.log(float(np.median(power[-max(len(power) // 10, 5) :])) + 1e-12 * scale)
    start = np.array([np.log(scale) - 4, 0.5, np.log(start_hz), np.log(0.05), noise, 0.0])
    bounds = [
        (np.log(scale) - 60, np.log(scale) + 20), (-4.0, 8.0),
        (np.log(start_hz) - START_RANGE, np.log(start_hz) + START_RANGE), tuple(np.log(DAMPING_LIMITS)),
        (np.log(scale) - 60, np.log(scale) + 20), (-0.9, 20.0),
    ]  # fmt: skip
    return optimize.minimize(
        _minus_likelihood, start, (frequency_hz, power), method="L-BFGS-B", bounds=bounds,
        options={"maxiter": 300},
    )  # fmt: skip


def _standard_errors(parameters: Floats, frequency_hz: Floats, power: Floats) -> Floats:
    """(6,) standard errors: by the expected information, Σ (∂ ln S)(∂ ln S)ᵀ."""
    step = 1e-4
    base = np.log(_model(parameters, frequency_hz))
    columns = [np.log(_model(parameters + step * unit, frequency_hz)) - base for unit in np.eye(6)]
    slope = np.column_stack(columns) / step
    information = slope.T @ slope
    return np.sqrt(np.maximum(np.diag(np.linalg.pinv(information)), 0.0))
