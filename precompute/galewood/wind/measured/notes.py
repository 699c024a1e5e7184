"""What the reader of a measurement assumed, left out or changed, in sentences.

Twin: web/player/src/core/wind/measured/notes.ts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from galewood.wind.measured.columns import Columns

SLOW_HZ = 0.99


def notes_of(report: Mapping[str, Any], columns: Columns) -> tuple[str, ...]:
    """The sentences, the most important first."""
    return (*_about_part(report), *_about_columns(columns), *_about_faults(report))


def _about_part(report: Mapping[str, Any]) -> Iterator[str]:
    if report["used_s"] < report["duration_s"] - 1.5 / report["used_rate_hz"]:
        yield (
            f"Of {duration(report['duration_s'])}, {duration(report['used_s'])} are used, "
            f"from {duration(report['used_start_s'])} after the first sample."
        )
    if report["used_rate_hz"] < 0.98 * report["rate_hz"]:
        yield f"Averaged from {report['rate_hz']:.1f} Hz to {report['used_rate_hz']:.1f} Hz."
    if report["rate_hz"] < SLOW_HZ:
        yield (
            f"One sample every {duration(1.0 / report['rate_hz'])}: faster gusts, which make trees sway, "
            "are not in the measurement."
        )
    yield (
        f"The wind repeats after {duration(report['loop_s'])}; "
        f"its last {duration(report['loop_s'] - report['used_s'])} lead from the end back to the beginning."
    )


def _about_columns(columns: Columns) -> Iterator[str]:
    if not columns.speed_unit:
        yield "No unit of the speed was found: m/s is assumed."
    if columns.speed < 0:
        yield "u is taken as the component to the east, v as that to the north."
    elif columns.direction < 0:
        yield "There is no direction: the wind is assumed to come from the west."
    elif columns.towards:
        yield "The direction is taken as where the wind blows to, as its name says."


def _about_faults(report: Mapping[str, Any]) -> Iterator[str]:
    if report["gaps"]:
        yield (
            f"{counted(report['gaps'], 'gap')} (the longest {duration(report['longest_gap_s'])}); "
            "gaps of up to a minute are bridged by straight lines, longer ones end the part that is used."
        )
    if report["missing"]:
        yield f"{counted(report['missing'], 'row')} without a time or a wind."
    if report["implausible"]:
        yield f"{counted(report['implausible'], 'value')} above 75 m/s, taken as missing."
    if report["duplicates"]:
        yield f"{counted(report['duplicates'], 'row')} with the time of another one, left out."
    if report["disordered"]:
        yield f"{counted(report['disordered'], 'row')} out of order, sorted by time."


def counted(count: int, what: str) -> str:
    """A number of things."""
    return f"{count} {what}{'' if count == 1 else 's'}"


def duration(seconds: float) -> str:
    """A duration in words: 0.4 s, 9 min 55 s, 2 h 5 min."""
    if seconds < 59.95:
        return f"{seconds:.1f} s"
    whole = int(seconds + 0.5)
    hours, minutes = whole // 3600, whole // 60 % 60
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {whole % 60} s"
