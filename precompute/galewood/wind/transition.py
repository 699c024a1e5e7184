"""The wind's clock: what a forest's wind is at a moment, smooth however its document is changed.

A change glides from the old document to the new one over GLIDE_S. The gusts are carried by ``travel``, the
length scales that the air has passed since the start, ∫ c/L dt in closed form, never by a product of the
time and a parameter: a change of speed moves the gusts faster, not elsewhere. A state is a small value that
can be sent: all who share it agree on the wind at every moment. web/src/wind/glide.ts is the same
arithmetic.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

from galewood.wind.document import FIELDS, Wind, WindError, parse_wind

TRANSITION_S = 0.6
_GLIDING = [name for name in FIELDS if name not in ("seed", "beta", "direction_deg")]


@dataclass(frozen=True)
class WindState:
    """A wind that has been gliding from one document to another since a time."""

    before: Wind
    wind: Wind
    since_s: float = 0.0
    travel: float = 0.0
    """length scales travelled at ``since_s``"""

    def document(self) -> dict[str, object]:
        """What ``parse_state`` reads back."""
        return {
            "before": self.before.document(),
            "wind": self.wind.document(),
            "since_s": self.since_s,
            "travel": self.travel,
        }


@dataclass(frozen=True)
class Moment:
    """The wind at one time: ``before`` differs from ``wind`` only while one field fades into another."""

    before: Wind
    wind: Wind
    time_s: float
    travel: float
    share: float
    """of ``wind``, the rest is ``before``; 1 unless two fields have to be mixed"""


def steady(wind: Wind) -> WindState:
    """A wind that has always been this one; its air set out at time 0."""
    return WindState(wind, wind)


def parse_state(document: object) -> WindState:
    """Read a state; WindError names the field."""
    if not isinstance(document, Mapping):
        raise WindError("wind_state", "expected an object")
    fields = cast(Mapping[str, Any], document)
    for name in ("since_s", "travel"):
        value = fields.get(name)
        if isinstance(value, bool) or not isinstance(value, int | float) or not -1e9 <= value <= 1e9:
            raise WindError(f"wind_state.{name}", "expected a number in -1e9..1e9")
    before, wind = parse_wind(fields.get("before")), parse_wind(fields.get("wind"))
    return WindState(before, wind, float(fields["since_s"]), float(fields["travel"]))


def parse_wind_or_state(document: object) -> WindState:
    """What a client may send: a wind that has always been so, or the state of one it has been gliding."""
    if isinstance(document, Mapping) and "since_s" in document:
        return parse_state(cast(object, document))
    return steady(parse_wind(document))


def change_wind(state: WindState, wind: Wind, time_s: float) -> WindState:
    """Glide from what the wind is now to another document, from this time on."""
    now = at(state, time_s)
    return WindState(now.before if now.share < 0.5 else now.wind, wind, time_s, now.travel)


def at(state: WindState, time_s: float) -> Moment:
    """The wind at a time."""
    t = min(max((time_s - state.since_s) / TRANSITION_S, 0.0), 1.0)
    share = t * t * (3.0 - 2.0 * t)
    old_rate, new_rate = _rate(state.before), _rate(state.wind)
    # ∫ of the smooth step: t³ − t⁴/2, and ½ when it is over
    transition_s = TRANSITION_S * t * t * t * (1.0 - 0.5 * t) + max(
        0.0, time_s - state.since_s - TRANSITION_S
    )
    travel = state.travel + old_rate * (time_s - state.since_s) + (new_rate - old_rate) * transition_s
    if t >= 1.0 or state.before == state.wind:
        return Moment(state.wind, state.wind, time_s, travel, 1.0)
    wind = _between(state.before, state.wind, share)
    if _same_field(state.before, state.wind):
        return Moment(wind, wind, time_s, travel, 1.0)
    before = replace(
        wind,
        model=state.before.model,
        seed=state.before.seed,
        beta=state.before.beta,
        waves=state.before.waves,
    )
    return Moment(before, wind, time_s, travel, share)


def _rate(wind: Wind) -> float:
    return wind.convection_speed_m_s / wind.length_scale_m


def _same_field(a: Wind, b: Wind) -> bool:
    return (a.model, a.seed, a.beta, a.waves) == (b.model, b.seed, b.beta, b.waves)


def _between(a: Wind, b: Wind, share: float) -> Wind:
    """Numbers on the way from a to b, the direction the short way round; model, seed, β and waves are b's."""
    numbers = {name: _mix(getattr(a, name), getattr(b, name), share) for name in _GLIDING}
    direction = b.direction_deg - (1.0 - share) * _half_turn(b.direction_deg - a.direction_deg)
    return replace(b, **numbers, direction_deg=_half_turn(direction))


def _mix(a: float, b: float, share: float) -> float:
    """Never outside [a, b], not even by rounding: a wind on its way must be a wind that can be sent."""
    return min(max(a + share * (b - a), min(a, b)), max(a, b))


def _half_turn(angle_deg: float) -> float:
    """The same angle in [−180, 180)."""
    return (angle_deg + 180.0) % 360.0 - 180.0
