"""How a recorded sway answers the wind measured beside it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import signal

from galewood.check.sway.spectrum import SEGMENT_S
from galewood.util import Floats

WINDOW_S = 600.0
"""Windows of wind statistics (WMO Guide to Instruments: ten minutes); shorter for records below an hour."""
FEWEST_WINDOWS = 4
SLOWEST_M_S = 1.0
"""Windows with less wind say nothing of the answer to it."""


@dataclass(frozen=True)
class WindResponse:
    """Response by windows, and the transfer function from the square of the wind to the sway.

    wind_m_s, turbulence_intensity, deviation, gust_factor (w,): mean wind, its standard deviation over its
    mean, standard deviation of the sway, and largest deflection from the mean over the standard deviation.
    exponent: of the deviation of the sway as a power of the wind; None for too few windows. frequency_hz,
    gain, coherence (k,): gain is sway per m²/s².
    """

    wind_m_s: Floats
    turbulence_intensity: Floats
    deviation: Floats
    gust_factor: Floats
    exponent: float | None
    frequency_hz: Floats
    gain: Floats
    coherence: Floats


def wind_response(sway: Floats, wind_m_s: Floats, rate_hz: float) -> WindResponse:
    """The response of a sway (n,) to the wind (n,) measured at the same times."""
    window_s = min(WINDOW_S, len(sway) / rate_hz / FEWEST_WINDOWS)
    length = max(2, round(window_s * rate_hz))
    whole = len(sway) // length * length
    parts, winds = sway[:whole].reshape(-1, length), wind_m_s[:whole].reshape(-1, length)
    mean, deviation = winds.mean(axis=1), parts.std(axis=1)
    largest = np.abs(parts - parts.mean(axis=1, keepdims=True)).max(axis=1)
    used = (mean >= SLOWEST_M_S) & (deviation > 0)
    segment = int(min(len(sway), max(16, round(SEGMENT_S * rate_hz))))
    squared = wind_m_s**2
    frequency, cross = signal.csd(squared, sway, rate_hz, nperseg=segment)
    _, power = signal.welch(squared, rate_hz, nperseg=segment)
    _, coherence = signal.coherence(squared, sway, rate_hz, nperseg=segment)
    gain = np.abs(cross) / np.maximum(power, np.finfo(np.float64).tiny)
    return WindResponse(
        mean[used],
        winds.std(axis=1)[used] / mean[used],
        deviation[used],
        largest[used] / deviation[used],
        _exponent(mean[used], deviation[used]),
        frequency[1:],
        gain[1:],
        np.nan_to_num(coherence[1:]),
    )


def _exponent(wind_m_s: Floats, deviation: Floats) -> float | None:
    """Slope of a line through the logarithms; None if the winds hardly differ."""
    if len(wind_m_s) < FEWEST_WINDOWS or wind_m_s.max() < 1.3 * wind_m_s.min():
        return None
    return float(np.polyfit(np.log(wind_m_s), np.log(deviation), 1)[0])
