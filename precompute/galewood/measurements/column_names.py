"""Names of columns as loggers write them, with their units: what all tables of series share."""

from __future__ import annotations

import itertools
import re

Units = dict[str, tuple[float, str]]
"""Unit -> its value in the first one, and a pattern of its spellings."""
SPEED_UNITS: Units = {
    "m/s": (1.0, r"m/s(ec)?|m/?s-1|mps|ms|met(er|re)s?/s(ec(ond)?)?|met(er|re)spersecond"),
    "km/h": (1.0 / 3.6, r"km/?h(r|our)?|km/?h-1|kph|kmph"),
    "mph": (0.44704, r"mph|mi/h|miles/h(our)?|milesperhour"),
    "knots": (1852.0 / 3600.0, r"kno?ts?|kn|kts?|knoten"),
    "ft/s": (0.3048, r"ft/s(ec)?|fps|feet/s(ec(ond)?)?"),
    "cm/s": (0.01, r"cm/s(ec)?|cm/?s-1"),
}
TIME_UNITS: Units = {
    "ms": (1e-3, r"ms|msec|millis(ec(ond)?s?)?"),
    "s": (1.0, r"s|secs?|seconds?|sekunden?|epoch|unix|unixtime"),
    "min": (60.0, r"min(ute)?s?|minuten"),
    "h": (3600.0, r"h|hrs?|hours?|stunden?"),
    "d": (86400.0, r"d|days?|tage?|doy|dayofyear"),
}
TIME_NAME = re.compile(
    r"(?:^| )(time ?stamp|date ?time|time|zeit|zeitpunkt|zeitstempel|messzeit|uhrzeit|t|seconds?|secs?|s|ms"
    r"|millis(?:econds?)?|epoch|unix ?time|utc|local ?time|elapsed|doy|day ?of ?year)(?: |$)"
)
DATE_NAME = re.compile(r"(?:^| )(date|datum|day|tag)(?: |$)")


def unit_of(text: str, units: Units) -> str:
    """The unit that a text names; empty if it names none."""
    compact = re.sub(r"[\s^*·()\[\]]", "", text.lower()).replace("−", "-").replace("per", "/")
    for unit, (_, pattern) in units.items():
        if re.fullmatch(pattern, compact):
            return unit
    return ""


def plain_name(name: str) -> str:
    """A name in lower case, without its unit in brackets, words separated by single blanks."""
    bare = re.sub(r"[\[(].*?[\])]", " ", name.lower()).replace("ö", "oe")
    bare = re.sub(r"(?<=[a-z]{3})/(?=[a-z]{3})", " ", bare)  # Datum/Uhrzeit, but not km/h
    return re.sub(r"[^a-z0-9/]+", " ", bare).strip()


def unit_in(name: str, units: Units) -> str:
    """The unit in the brackets of a name, or among its words."""
    for bracket in re.findall(r"[\[(](.*?)[\])]", name):
        if unit := unit_of(bracket, units):
            return unit
    words = plain_name(name).split(" ")
    pairs = [f"{a}/{b}" for a, b in itertools.pairwise(words)]
    return next((unit for text in [*pairs, *words] if (unit := unit_of(text, units))), "")
