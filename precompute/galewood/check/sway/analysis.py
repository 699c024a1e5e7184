"""What a record of motion says of a tree: frequencies, damping, spectrum, and its answer to the wind."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from galewood.check.sway.random_decrement import Decrement, random_decrement
from galewood.check.sway.spectrum import (
    Resonance,
    main_resonance,
    principal_axes,
    resampled,
    slopes,
    welch,
    without_drift,
)
from galewood.check.sway.wind_response import WindResponse, wind_response
from galewood.measurements import MotionRecord, read_motion
from galewood.util import Floats

ANALYSED_HZ = 25.0
"""Faster records are resampled to this rate: trees sway below it."""
PLOTTED_FROM_HZ = 0.02


@dataclass(frozen=True)
class AxisSway:
    """Sway along one principal axis: samples (n,) and what was found in them; None: see the notes."""

    sway: Floats
    deviation: float
    resonance: Resonance | None
    decrement: Decrement | None
    slopes: dict[str, float]
    notes: tuple[str, ...]

    def figures(self) -> dict[str, Any]:
        """Frequency, damping by both methods, and slopes; JSON-able."""
        found: dict[str, Any] = {"standard_deviation": self.deviation, "spectrum_slope": self.slopes}
        if self.resonance:
            found |= {
                "frequency_hz": self.resonance.frequency_hz,
                "frequency_error_hz": self.resonance.frequency_error_hz,
                "damping_ratio": self.resonance.damping_ratio,
                "damping_error": self.resonance.damping_error,
            }
        if self.decrement:
            found |= {
                "decrement_frequency_hz": self.decrement.frequency_hz,
                "decrement_damping_ratio": self.decrement.damping_ratio,
                "decrement_passages": self.decrement.passage_count,
            }
        return found | ({"notes": list(self.notes)} if self.notes else {})


@dataclass(frozen=True)
class SwayAnalysis:
    """What a record says: along its principal axes, and in the wind if that was measured too."""

    record: MotionRecord
    rate_hz: float
    along: AxisSway
    across: AxisSway | None
    variance_ratio: float | None
    direction_deg: float
    wind: WindResponse | None

    def figures(self) -> dict[str, Any]:
        """All figures; JSON-able. Angles are from the first axis of the record to the second."""
        record, wind = self.record, self.wind
        return {
            "record": {
                "quantity": record.quantity,
                "unit": record.unit,
                "rate_hz": record.rate_hz,
                "duration_s": record.duration_s,
                "rows": record.row_count,
                "missing": record.missing_count,
                "gaps": record.gap_count,
                "columns": dict(record.columns or {}),
            },
            "along": self.along.figures(),
            "across": self.across and self.across.figures(),
            "variance_ratio": self.variance_ratio,
            "principal_direction_deg": self.direction_deg,
            "wind": wind
            and {
                "mean_m_s": wind.wind_m_s.tolist(),
                "turbulence_intensity": wind.turbulence_intensity.tolist(),
                "sway_deviation": wind.deviation.tolist(),
                "gust_factor": wind.gust_factor.tolist(),
                "exponent": wind.exponent,
                "transfer": {
                    "frequency_hz": wind.frequency_hz.tolist(),
                    "gain": wind.gain.tolist(),
                    "coherence": wind.coherence.tolist(),
                },
            },
        }

    def spectra(self) -> tuple[Floats, Floats]:
        """Frequencies (k,) and averaged power spectral density along the first principal axis (k,)."""
        frequency, density = welch(self.along.sway, self.rate_hz)
        shown = frequency >= PLOTTED_FROM_HZ
        return frequency[shown], density[shown]


def analyse_motion(record: MotionRecord | str | Path) -> SwayAnalysis:
    """Frequency, damping and spectrum of a recorded motion, along its principal axes.

    The record is a file, what ``galewood.read_motion`` made of one with options, or from arrays
    (``galewood.motion_record``). One without a clear resonance keeps its other figures, with a note. Raises
    MeasurementError for a file that cannot be read.
    """
    if not isinstance(record, MotionRecord):
        record = read_motion(record)
    axes = principal_axes(without_drift(record.values, record.rate_hz))
    rate, factor = record.rate_hz, max(record.rate_hz / ANALYSED_HZ, 1.0)
    wind = None
    if record.wind_m_s is not None:
        wind = wind_response(axes.along, record.wind_m_s, rate)
    turned = [axis for axis in (axes.along, axes.across) if axis is not None]
    if factor > 1:
        turned = [resampled(axis, rate, ANALYSED_HZ) for axis in turned]
        rate = ANALYSED_HZ
    found = [_axis(axis, rate, record.quantity == "acceleration") for axis in turned]
    ratio = axes.variance_ratio
    return SwayAnalysis(
        record,
        rate,
        found[0],
        found[1] if len(found) > 1 else None,
        ratio if np.isfinite(ratio) else None,
        axes.direction_deg,
        wind,
    )


def _axis(sway: Floats, rate_hz: float, of_acceleration: bool) -> AxisSway:
    notes = list[str]()
    resonance = decrement = None
    try:
        resonance = main_resonance(sway, rate_hz, of_acceleration=of_acceleration)
        decrement = random_decrement(sway, rate_hz, resonance.frequency_hz)
    except ValueError as error:
        notes.append(str(error))
    return AxisSway(sway, float(np.std(sway)), resonance, decrement, slopes(sway, rate_hz), tuple(notes))
