"""Samples at equal intervals: in order, without duplicates, gaps bridged."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

from galewood.measurements.anemometer.samples import Samples
from galewood.measurements.clock import GAP_INTERVALS, spread_times, usual_interval_s
from galewood.measurements.errors import MeasurementError

FASTEST_RATE_HZ = 10.0
"""Faster series are averaged: trees do not respond to faster gusts."""
HIGHEST_RATE_HZ = 250.0
"""No anemometer is faster; a file that seems to be has another unit of time."""
FEWEST_SAMPLES = 10
"""Samples that are needed."""
BRIDGED_S, BRIDGED_INTERVALS = 60.0, 3.0
"""Longer gaps, in s and in intervals, end a piece; the longest piece is used."""
ON_TIME = 0.02
"""A sample this close to its place, in intervals, is taken as it is."""


@dataclass(frozen=True)
class Found:
    """What was found in the samples before they were put in order."""

    rows: int
    missing: int
    duplicates: int
    disordered: int
    gaps: int
    longest_gap_s: float
    interval_s: float
    duration_s: float
    piece_start_s: float
    """Start of the longest piece, from the first sample."""


@dataclass(frozen=True)
class Series:
    """Velocities (m/s, east and north) at equal intervals."""

    interval_s: float
    east_m_s: list[float]
    north_m_s: list[float]


def series_of(samples: Samples) -> tuple[Series, Found]:
    """Put the samples in order and at equal intervals. MeasurementError if too few are left."""
    times = spread_times(samples.time_s)
    rows = list(zip(times, samples.east_m_s, samples.north_m_s, strict=True))
    timed = [row for row in rows if not math.isnan(row[0])]
    disordered = sum(b[0] < a[0] for a, b in itertools.pairwise(timed))
    timed.sort(key=lambda row: row[0])
    unique = [row for k, row in enumerate(timed) if k == 0 or row[0] > timed[k - 1][0]]
    valid = [row for row in unique if not (math.isnan(row[1]) or math.isnan(row[2]))]
    if len(valid) < FEWEST_SAMPLES:
        raise MeasurementError(
            f"only {len(valid)} samples have a time and a wind; at least {FEWEST_SAMPLES} are needed"
        )
    interval_s = usual_interval_s([row[0] for row in unique])
    if interval_s * HIGHEST_RATE_HZ < 1.0:
        raise MeasurementError(
            f"the times give {1.0 / interval_s:,.0f} samples a second, more than any anemometer; state their "
            "unit in the column's name, such as time (s)"
        )
    pauses = [b[0] - a[0] for a, b in itertools.pairwise(valid)]
    gaps = [pause for pause in pauses if pause > GAP_INTERVALS * interval_s]
    piece = _longest_piece(valid, interval_s)
    found = Found(
        rows=len(rows),
        missing=len(rows) - (len(timed) - len(unique)) - len(valid),
        duplicates=len(timed) - len(unique),
        disordered=disordered,
        gaps=len(gaps),
        longest_gap_s=max(gaps, default=0.0),
        interval_s=interval_s,
        duration_s=valid[-1][0] - valid[0][0] + interval_s,
        piece_start_s=piece[0][0] - valid[0][0],
    )
    if len(piece) < FEWEST_SAMPLES:
        longest_s = max(BRIDGED_S, BRIDGED_INTERVALS * interval_s)
        raise MeasurementError(
            f"the longest piece without a gap of more than {longest_s:.0f} s "
            f"has only {len(piece)} samples; at least {FEWEST_SAMPLES} are needed"
        )
    return _even(piece, interval_s), found


Timed = tuple[float, float, float]


def _longest_piece(rows: list[Timed], interval_s: float) -> list[Timed]:
    longest_s = max(BRIDGED_S, BRIDGED_INTERVALS * interval_s)
    cuts = [k + 1 for k, (a, b) in enumerate(itertools.pairwise(rows)) if b[0] - a[0] > longest_s]
    best = (0, 0)
    for start, end in zip([0, *cuts], [*cuts, len(rows)], strict=True):
        if end - start > best[1] - best[0]:
            best = (start, end)
    return rows[best[0] : best[1]]


def _even(rows: list[Timed], interval_s: float) -> Series:
    if interval_s < (1.0 - ON_TIME) / FASTEST_RATE_HZ:
        interval_s = 1.0 / FASTEST_RATE_HZ
        rows = _averaged(rows, interval_s)
        if len(rows) < FEWEST_SAMPLES:
            raise MeasurementError(f"the samples cover less than {FEWEST_SAMPLES * interval_s:.0f} s")
    start_s = rows[0][0]
    count = math.floor((rows[-1][0] - start_s) / interval_s + 0.5) + 1
    east, north = [0.0] * count, [0.0] * count
    k = 0
    for i in range(count):
        time_s = start_s + i * interval_s
        while k + 2 < len(rows) and rows[k + 1][0] <= time_s:
            k += 1
        a, b = rows[k], rows[k + 1]
        share = min(max((time_s - a[0]) / (b[0] - a[0]), 0.0), 1.0)
        for row, weight in ((a, 0.0), (b, 1.0)):
            if abs(row[0] - time_s) <= ON_TIME * interval_s:
                share = weight
        east[i] = a[1] + share * (b[1] - a[1])
        north[i] = a[2] + share * (b[2] - a[2])
    return Series(interval_s, east, north)


def _averaged(rows: list[Timed], interval_s: float) -> list[Timed]:
    """Means over intervals, at their middle; intervals without samples are left out."""
    start_s, means = rows[0][0], list[Timed]()
    bin_now, count, east, north = 0, 0, 0.0, 0.0
    for time_s, u, v in rows:
        k = math.floor((time_s - start_s) / interval_s + 1e-6)
        if k != bin_now:
            means.append((start_s + (bin_now + 0.5) * interval_s, east / count, north / count))
            bin_now, count, east, north = k, 0, 0.0, 0.0
        count, east, north = count + 1, east + u, north + v
    means.append((start_s + (bin_now + 0.5) * interval_s, east / count, north / count))
    return means
