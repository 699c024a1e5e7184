"""From the file of a logger to a wind.

The mean wind is the mean speed (as a cup anemometer has it) towards the mean direction of the velocity; the
rest of each sample is a fluctuation along and across it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from galewood.constants import MOST_RECORDING_SAMPLES, TURBULENCE_PER_GUSTINESS
from galewood.measurements.anemometer.report import MeasurementReport, figures_of, notes_of
from galewood.measurements.anemometer.samples import Samples, samples_of
from galewood.measurements.anemometer.series import Found, Series, series_of
from galewood.measurements.errors import MeasurementError
from galewood.motion.wind import Wind, quantised
from galewood.util import Floats, decoded, rows_of

LARGEST_BYTES = 64 * 1024**2
CLOSING_S = 5.0
"""Length of the passage that leads from the end back to the beginning."""
FASTEST_MEAN_M_S = 60.0
SLOWEST_CONVECTION_M_S = 2.0
"""Gusts travel with the mean wind, but at least at this speed, so that a calm has no standing waves."""
LONGEST_INTERVAL_S = 3600.0


@dataclass(frozen=True)
class Measurement:
    """A measured wind and how its file was interpreted."""

    wind: Wind
    report: MeasurementReport

    def document(self) -> dict[str, object]:
        """The wind document and the report, as JSON."""
        return {"wind": self.wind.document(), "report": self.report.document()}


def read_measurement(file: Path | str | bytes, *, start_s: float = 0.0) -> Measurement:
    """Read the file of an anemometer's logger: text with columns for time and wind.

    At most ten minutes at 10 Hz are used, from ``start_s`` after the first sample. MeasurementError.
    """
    data = file if isinstance(file, bytes) else Path(file).read_bytes()
    if len(data) > LARGEST_BYTES:
        raise MeasurementError(f"the file is larger than {LARGEST_BYTES // 1024**2} MB; split it")
    try:
        samples = samples_of(rows_of(decoded(data)))
    except MeasurementError:
        raise
    except ValueError as error:
        raise MeasurementError(str(error)) from None
    return measurement_of(samples, start_s)


def measured_velocities(data: bytes) -> Floats:
    """(n, 2) velocities to the east and to the north of all samples of a file, m/s, without the missing ones.

    Their times may be far apart, as in hourly means. MeasurementError.
    """
    try:
        samples = samples_of(rows_of(decoded(data)))
    except MeasurementError:
        raise
    except ValueError as error:
        raise MeasurementError(str(error)) from None
    found = np.column_stack([samples.east_m_s, samples.north_m_s])
    return found[np.isfinite(found).all(axis=1)]


def measurement_of(samples: Samples, start_s: float) -> Measurement:
    """The wind of the samples from ``start_s`` after the first. MeasurementError."""
    whole, found = series_of(samples)
    if whole.interval_s > LONGEST_INTERVAL_S:
        raise MeasurementError("the samples are more than an hour apart: too far to contain gusts")
    used, first = _part(whole, start_s)
    return _measurement(samples, found, used, first)


def _part(series: Series, start_s: float) -> tuple[Series, int]:
    """The part that fits into a document, with room for the passage back, and the index of its first."""
    first = math.floor(max(start_s, 0.0) / series.interval_s + 0.5)
    room = MOST_RECORDING_SAMPLES - _closing(MOST_RECORDING_SAMPLES, series.interval_s)
    last = min(first + room, len(series.east_m_s))
    if last - first < 2:
        raise MeasurementError(f"the series ends before {start_s:g} s; choose an earlier start")
    return Series(series.interval_s, series.east_m_s[first:last], series.north_m_s[first:last]), first


def _closing(count: int, interval_s: float) -> int:
    """Number of samples of the passage from the end to the beginning."""
    return max(1, min(math.floor(CLOSING_S / interval_s + 0.5), count // 4))


def _measurement(samples: Samples, found: Found, used: Series, first: int) -> Measurement:
    count = len(used.east_m_s)
    speeds = [math.sqrt(u * u + v * v) for u, v in zip(used.east_m_s, used.north_m_s, strict=True)]
    mean = sum(speeds) / count
    if mean > FASTEST_MEAN_M_S:
        raise MeasurementError(f"the mean speed is {mean:.0f} m/s; check the unit of the speed")
    east, north = sum(used.east_m_s) / count, sum(used.north_m_s) / count
    heading = math.atan2(-north, east)  # towards, from x (east) to z (south)
    spread = math.sqrt(sum((speed - mean) * (speed - mean) for speed in speeds) / count)
    intensity = spread / mean if mean > 0.0 else 0.0
    gustiness = min(max(intensity / TURBULENCE_PER_GUSTINESS, 0.01), 1.0)
    fluctuations = _fluctuations(used, heading, mean, TURBULENCE_PER_GUSTINESS * gustiness * mean)
    closed = _closed(fluctuations, _closing(count, used.interval_s))
    wind = Wind(
        model="recorded",
        mean_speed_m_s=mean,
        direction_deg=math.degrees(heading),
        gustiness=gustiness,
        convection_speed_m_s=max(SLOWEST_CONVECTION_M_S, mean),
        recording=quantised(closed, used.interval_s),
    )
    columns = samples.columns
    report = MeasurementReport(
        columns=columns.meanings,
        rows=found.rows,
        missing=found.missing,
        implausible=samples.implausible,
        unreadable=tuple(str(error) for error in samples.unreadable),
        duplicates=found.duplicates,
        disordered=found.disordered,
        gaps=found.gaps,
        longest_gap_s=found.longest_gap_s,
        rate_hz=1.0 / found.interval_s,
        duration_s=found.duration_s,
        used_rate_hz=1.0 / used.interval_s,
        used_start_s=found.piece_start_s + first * used.interval_s,
        used_s=count * used.interval_s,
        loop_s=len(closed) * used.interval_s,
        mean_speed_m_s=mean,
        max_speed_m_s=max(speeds),
        from_deg=(math.degrees(heading) + 630.0) % 360.0,
        intensity=intensity,
        figures={},
        notes=(),
    )
    figures, notes = figures_of(report), notes_of(report, columns)
    return Measurement(wind, replace(report, figures=figures, notes=notes))


def _fluctuations(
    used: Series, heading: float, mean: float, deviation_m_s: float
) -> list[tuple[float, float]]:
    """Fluctuations along and across the mean wind, in standard deviations."""
    if deviation_m_s == 0.0:
        return [(0.0, 0.0)] * len(used.east_m_s)
    c, s = math.cos(heading), math.sin(heading)
    return [
        ((c * u - s * v - mean) / deviation_m_s, (-c * v - s * u) / deviation_m_s)
        for u, v in zip(used.east_m_s, used.north_m_s, strict=True)
    ]


def _closed(values: list[tuple[float, float]], count: int) -> list[tuple[float, float]]:
    """The samples, and a passage in which their mirrored end fades into their mirrored beginning.

    The weights keep the variance of fluctuations that do not depend on each other.
    """
    passage: list[tuple[float, float]] = []
    for k in range(count):
        share = (k + 1) / (count + 1)
        old, new = values[len(values) - 1 - k], values[count - k]
        w, v = math.sqrt(1.0 - share), math.sqrt(share)
        passage.append((w * old[0] + v * new[0], w * old[1] + v * new[1]))
    return [*values, *passage]
