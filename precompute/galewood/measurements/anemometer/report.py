"""Report of a measurement, as numbers for programs and as text for readers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass

from galewood.measurements.anemometer.columns import Columns

SLOW_HZ = 0.99
"""Below this rate the gusts that make trees sway are not in a measurement."""


@dataclass(frozen=True)
class MeasurementReport:
    """How the file was interpreted."""

    columns: dict[str, str]
    """What each column was taken for: its name, with the unit."""
    rows: int
    missing: int
    implausible: int
    unreadable: tuple[str, ...]
    """What is wrong with rows that count as missing because a cell cannot be read."""
    duplicates: int
    disordered: int
    gaps: int
    longest_gap_s: float
    rate_hz: float
    duration_s: float
    used_rate_hz: float
    used_start_s: float
    """First used sample, from the first one of the file."""
    used_s: float
    loop_s: float
    """Period of the wind: the used part and the passage back to its beginning."""
    mean_speed_m_s: float
    max_speed_m_s: float
    from_deg: float
    """Mean direction that the wind comes from, clockwise from north."""
    intensity: float
    """Turbulence intensity: standard deviation of the speed over its mean."""
    figures: dict[str, str]
    """The main numbers as text, by their names."""
    notes: tuple[str, ...]
    """Assumptions and faults, as sentences."""

    def document(self) -> dict[str, object]:
        """The report as JSON."""
        return asdict(self)


def figures_of(report: MeasurementReport) -> dict[str, str]:
    """The main numbers as text."""
    gaps = f"{report.gaps}, the longest {duration(report.longest_gap_s)}" if report.gaps else "none"
    return {
        **{f"Column for {what}": column for what, column in report.columns.items()},
        "Samples": f"{report.rows} in {duration(report.duration_s)}, {_rate(report.rate_hz)}",
        "Mean wind": f"{report.mean_speed_m_s:.1f} m/s from {report.from_deg:.0f}°",
        "Strongest sample": f"{report.max_speed_m_s:.1f} m/s",
        "Turbulence intensity": f"{100.0 * report.intensity:.0f} %",
        "Gaps": gaps,
    }


def _rate(rate_hz: float) -> str:
    return f"one every {duration(1.0 / rate_hz)}" if rate_hz < SLOW_HZ else f"{rate_hz:.1f} Hz"


def notes_of(report: MeasurementReport, columns: Columns) -> tuple[str, ...]:
    """The sentences, the most important first."""
    return (*_about_part(report), *_about_columns(columns), *_about_faults(report))


def _about_part(report: MeasurementReport) -> Iterator[str]:
    if report.used_s < report.duration_s - 1.5 / report.used_rate_hz:
        yield (
            f"Of {duration(report.duration_s)}, {duration(report.used_s)} are used, "
            f"from {duration(report.used_start_s)} after the first sample."
        )
    if report.used_rate_hz < 0.98 * report.rate_hz:
        yield f"Averaged from {report.rate_hz:.1f} Hz to {report.used_rate_hz:.1f} Hz."
    if report.rate_hz < SLOW_HZ:
        yield (
            f"One sample every {duration(1.0 / report.rate_hz)}: faster gusts, which make trees sway, "
            "are not in the measurement."
        )
    yield (
        f"The wind repeats after {duration(report.loop_s)}; "
        f"its last {duration(report.loop_s - report.used_s)} lead from the end back to the beginning."
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


def _about_faults(report: MeasurementReport) -> Iterator[str]:
    if report.gaps:
        yield (
            f"{counted(report.gaps, 'gap')} (the longest {duration(report.longest_gap_s)}); "
            "gaps of up to a minute are interpolated linearly, longer ones end the part that is used."
        )
    if report.missing:
        yield f"{counted(report.missing, 'row')} without time or wind, ignored."
    if report.unreadable:
        first, *others = report.unreadable
        more = f" ({counted(len(others), 'more row')} like it)" if others else ""
        yield f"Taken as missing: {first}{more}."
    if report.implausible:
        yield f"{counted(report.implausible, 'value')} above 75 m/s, taken as missing."
    if report.duplicates:
        yield f"{counted(report.duplicates, 'row')} with the time of another one, ignored."
    if report.disordered:
        yield f"{counted(report.disordered, 'row')} out of order, sorted by time."


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
