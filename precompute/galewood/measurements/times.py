"""Times as loggers write them, in seconds from an arbitrary origin."""

from __future__ import annotations

import re

_CLOCK = r"(\d{1,2}):(\d{2})(?::(\d{2})(?:[.,](\d{1,9}))?)?(?: ?([AP])M)?"
_ZONE = r"(?: ?(Z|UTC|GMT|[+-]\d{2}(?::?\d{2})?))?"
_YEAR_FIRST = re.compile(
    rf"(\d{{4}})[-/.](\d{{1,2}})[-/.](\d{{1,2}})(?:[T ]+{_CLOCK})?{_ZONE}", re.IGNORECASE
)
_DAY_FIRST = re.compile(rf"(\d{{1,2}})\.(\d{{1,2}})\.(\d{{4}})(?:[T ]+{_CLOCK})?{_ZONE}", re.IGNORECASE)
_SLASHES = re.compile(rf"(\d{{1,2}})[-/](\d{{1,2}})[-/](\d{{4}})(?:[T ]+{_CLOCK})?{_ZONE}", re.IGNORECASE)
_COMPACT = re.compile(r"(\d{4})(\d{2})(\d{2})(?:[T_ :]?(\d{2})(?:(\d{2})(?:(\d{2}))?)?)?Z?", re.IGNORECASE)
"""yyyymmdd, yyyymmddHH, yyyymmddHHMM or yyyymmddHHMMSS, as weather services write times."""
_COMPACT_DATE = re.compile(rf"(\d{{4}})(\d{{2}})(\d{{2}})[T ]+{_CLOCK}{_ZONE}", re.IGNORECASE)
FIRST_YEAR, LAST_YEAR = 1850, 2150
_TIME_OF_DAY = re.compile(_CLOCK, re.IGNORECASE)
DAY_S = 86_400.0


def is_clock(text: str) -> bool:
    """Whether a text is a time of day without a date."""
    return _TIME_OF_DAY.fullmatch(text) is not None


def is_compact(text: str) -> bool:
    """Whether a text is a date and time of digits alone, such as 202401020010."""
    return _compact_s(text) is not None


def _compact_s(text: str) -> float | None:
    found = _COMPACT.fullmatch(text)
    if not found:
        return None
    year, month, day, hour, minute, second = (int(part or 0) for part in found.groups())
    if not (FIRST_YEAR <= year <= LAST_YEAR and 1 <= month <= 12 and 1 <= day <= 31):
        return None
    if hour > 23 or minute > 59 or second > 60:
        return None
    return _days(year, month, day) * DAY_S + 3600.0 * hour + 60.0 * minute + second


def date_time_s(text: str, *, month_first: bool = True) -> float | None:
    """Seconds of a date and time, or of a time of day; None for another text.

    ``month_first`` decides on dates such as 5/1/2024. Times without a zone count as UTC.
    """
    if clock := _TIME_OF_DAY.fullmatch(text):
        return _clock_s(clock.groups())
    if (compact_s := _compact_s(text)) is not None:
        return compact_s
    if found := _YEAR_FIRST.fullmatch(text) or _COMPACT_DATE.fullmatch(text):
        year, month, day = found.group(1, 2, 3)
    elif found := _DAY_FIRST.fullmatch(text):
        day, month, year = found.group(1, 2, 3)
    elif found := _SLASHES.fullmatch(text):
        first, second, year = found.group(1, 2, 3)
        month, day = (first, second) if month_first else (second, first)
    else:
        return None
    if not (1 <= int(month) <= 12 and 1 <= int(day) <= 31):
        return None
    days = _days(int(year), int(month), int(day))
    return days * DAY_S + _clock_s(found.group(4, 5, 6, 7, 8)) - _zone_s(found.group(9))


def is_month_first(texts: list[str]) -> bool:
    """Whether dates with slashes have the month first: unless one of them has a first number above 12."""
    found = [_SLASHES.fullmatch(text) for text in texts]
    return all(int(one.group(1)) <= 12 for one in found if one)


def _clock_s(parts: tuple[str | None, ...]) -> float:
    hours, minutes, seconds, decimals, half = parts
    if hours is None:
        return 0.0
    hour = int(hours) % 12 + (12 if (half or "").upper() == "P" else 0) if half else int(hours)
    whole = 3600 * hour + 60 * int(minutes or 0) + int(seconds or 0)
    return whole + (float(f"0.{decimals}") if decimals else 0.0)


def _zone_s(zone: str | None) -> float:
    if zone is None or zone[0] not in "+-":
        return 0.0
    digits = zone[1:].replace(":", "")
    seconds = 3600.0 * int(digits[:2]) + 60.0 * int(digits[2:] or 0)
    return -seconds if zone[0] == "-" else seconds


def _days(year: int, month: int, day: int) -> int:
    """Days since 1970-01-01 in the Gregorian calendar (Howard Hinnant, "days_from_civil")."""
    y = year - (month <= 2)
    era = y // 400
    year_of_era = y - era * 400
    day_of_year = (153 * (month + (-3 if month > 2 else 9)) + 2) // 5 + day - 1
    day_of_era = year_of_era * 365 + year_of_era // 4 - year_of_era // 100 + day_of_year
    return era * 146_097 + day_of_era - 719_468
