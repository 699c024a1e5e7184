"""Reads the times of a table's rows, and finds the interval between them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from galewood.measurements.column_names import TIME_UNITS
from galewood.measurements.times import DAY_S, date_time_s, is_clock, is_compact, is_month_first
from galewood.util import Row, number_of

GAP_INTERVALS = 1.5
"""A pause of more than this many intervals is a gap."""
MOST_COMPACT = 0.5
"""Share of cells such as 202401020010 above which those of a column are times of that form."""
EPOCH_MS = 1e11
"""Numbers above this are milliseconds since 1970."""


class Clock:
    """Reads times, which are numbers, dates with times, or times of day, from a column or two."""

    def __init__(self, time: int, date: int, time_unit: str, rows: Sequence[Row]) -> None:
        self._time, self._date = time, date
        texts = [row.cell(time) for row in rows]
        self._dated = date >= 0 and is_clock(texts[0])
        dates = [row.cell(date) for row in rows] if self._dated else texts
        given = [is_compact(text) for text in texts if text]
        compact = not time_unit and sum(given) > MOST_COMPACT * len(given)
        self._numbers = is_number(texts[0]) and not compact
        self._month_first = True if self._numbers else is_month_first(dates)
        self._daily = not self._dated and is_clock(texts[0])
        self._days_s, self._last_s = 0.0, -math.inf
        huge = self._numbers and number_of(texts[0]) > EPOCH_MS
        self.unit = (time_unit or ("ms" if huge else "s")) if self._numbers else ""

    def time_s(self, row: Row) -> float:
        """Seconds from an arbitrary origin; NaN if the time is missing. ValueError if it cannot be read."""
        text = row.cell(self._time)
        if self._numbers:
            try:
                return number_of(text) * TIME_UNITS[self.unit][0]
            except ValueError as error:
                raise ValueError(f"{error}, as the times above it are") from None
        if self._dated:
            text = f"{row.cell(self._date)} {text}"
        if not text.strip():
            return math.nan
        time_s = date_time_s(text, month_first=self._month_first)
        if time_s is None:
            raise ValueError(f"{text[:40]!r} is not a time such as 2024-05-31T12:00:00.5 or 12.5")
        return self._past_midnight(time_s) if self._daily else time_s

    def _past_midnight(self, time_s: float) -> float:
        if time_s < self._last_s - DAY_S / 2:
            self._days_s += DAY_S
        self._last_s = time_s
        return time_s + self._days_s


def is_number(cell: str) -> bool:
    """Whether a cell has a number, and not a missing value."""
    try:
        return not math.isnan(number_of(cell))
    except ValueError:
        return False


def spread_times(times: list[float]) -> list[float]:
    """The times; if most are repeated, as by loggers that write whole seconds, spread over their interval."""
    same = sum(b == a for a, b in itertools.pairwise(times))
    if 2 * same < len(times):
        return times
    starts = [k for k in range(len(times)) if k == 0 or times[k] != times[k - 1]]
    if len(starts) < 3:
        return times
    ends = [*starts[1:], len(times)]
    spread = list(times)
    most = sorted(end - start for start, end in zip(starts, ends, strict=True))[len(starts) // 2]
    for k, (start, end) in enumerate(zip(starts, ends, strict=True)):
        near = k if k + 1 < len(starts) else k - 1
        step = (times[starts[near + 1]] - times[starts[near]]) / max(end - start, most)
        # the first second may begin in its middle
        missing = max(most - (end - start), 0) if k == 0 else 0
        for i in range(start, end):
            spread[i] = times[start] + (i - start + missing) * step
    return spread


def usual_interval_s(times_s: Sequence[float]) -> float:
    """The interval of times in rising order: the mean of those that are near the median."""
    steps = [b - a for a, b in itertools.pairwise(times_s)]
    median = sorted(steps)[len(steps) // 2]
    near = [step for step in steps if median / GAP_INTERVALS <= step <= GAP_INTERVALS * median]
    return sum(near) / len(near)
