"""Time evolution of a forest's wind, continuous under any change of its document.

A change is interpolated from the old document to the new one over TRANSITION_S. Gusts are advected by
``travel``, the distance in length scales that the air has covered since the start: ∫ c/L dt in closed form,
never the product of the time and a parameter, so that a change of speed does not displace the gusts. A state
is a small value that can be transmitted: everyone who shares it computes the same wind at every time.
While one gust field fades into another, or their length changes, a further change waits until that is over:
so a state never holds a mixture, which no document could describe.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, cast

from galewood.constants import FRONT_LIFE_S, MOST_FRONTS, TRANSITION_S
from galewood.motion.wind.document import FIELDS, Wind, WindError, parse_wind
from galewood.motion.wind.fronts import Front, parse_fronts

_INTERPOLATED = [name for name in FIELDS if name not in ("seed", "beta", "direction_deg")]


@dataclass(frozen=True)
class WindState:
    """A wind that has been in transition from one document to another since a given time."""

    before: Wind
    wind: Wind
    since_s: float = 0.0
    travel: float = 0.0
    """Distance travelled at ``since_s``, in length scales."""
    fronts: tuple[Front, ...] = ()
    """Gust fronts on their way, the oldest first."""
    next: Wind | None = None
    """The wind whose transition begins when the present one is over."""

    def document(self) -> dict[str, object]:
        """The JSON object that ``parse_state`` accepts."""
        return {
            "before": self.before.document(),
            "wind": self.wind.document(),
            "since_s": self.since_s,
            "travel": self.travel,
            **({"fronts": [front.document() for front in self.fronts]} if self.fronts else {}),
            **({"next": self.next.document()} if self.next else {}),
        }


@dataclass(frozen=True)
class CrownFade:
    """Which gusts within the crowns blow, and how strongly.

    Two fields of them are not mixed: in a transition the old one fades out, then the new one in.
    """

    seed: int
    length_scale_m: float
    weight: float
    """0 … 1, and 0 for the cosine model."""


@dataclass(frozen=True)
class Moment:
    """The wind at one time; ``before`` differs from ``wind`` only while two gust fields are blended."""

    before: Wind
    wind: Wind
    time_s: float
    travel: float
    share: float
    """Weight of ``wind`` (``before`` has the rest); 1 unless two gust fields are blended."""
    crown: CrownFade


def steady(wind: Wind) -> WindState:
    """The state of a wind that has never changed; its travel is 0 at time 0."""
    return WindState(wind, wind)


def parse_state(document: object) -> WindState:
    """Parse a state. Raises WindError with the invalid field."""
    if not isinstance(document, Mapping):
        raise WindError("wind_state", "expected an object")
    fields = cast(Mapping[str, Any], document)
    for name in ("since_s", "travel"):
        value = fields.get(name)
        if isinstance(value, bool) or not isinstance(value, int | float) or not -1e9 <= value <= 1e9:
            raise WindError(f"wind_state.{name}", "expected a number in -1e9..1e9")
    before, wind = parse_wind(fields.get("before")), parse_wind(fields.get("wind"))
    fronts = parse_fronts(fields.get("fronts", []))
    then = parse_wind(fields["next"]) if "next" in fields else None
    return WindState(before, wind, float(fields["since_s"]), float(fields["travel"]), fronts, then)


def parse_wind_or_state(document: object) -> WindState:
    """Parse what a client may send: the document of a steady wind, or the state of a changing one."""
    if isinstance(document, Mapping) and "since_s" in document:
        return parse_state(cast(object, document))
    return steady(parse_wind(document))


def change_wind(state: WindState, wind: Wind, time_s: float) -> WindState:
    """Change to another document at this time, s: the transition starts now, or after one that must end."""
    state = _in_force(state, time_s)
    if _progress(state, time_s) < 1.0 and not _same_gusts(state.before, state.wind):
        return replace(state, next=wind)
    now = at(state, time_s)
    return WindState(now.wind, wind, time_s, now.travel, state.fronts)


def with_front(state: WindState, x_m: float, z_m: float, time_s: float) -> WindState:
    """The same wind with a gust front that starts at a place at this time, s; old fronts are dropped."""
    wind = at(state, time_s).wind
    front = Front(time_s, x_m, z_m, wind.direction_deg, wind.mean_speed_m_s)
    kept = [old for old in state.fronts if time_s - old.since_s < FRONT_LIFE_S]
    return replace(state, fronts=(*kept, front)[-MOST_FRONTS:])


def at(state: WindState, time_s: float) -> Moment:
    """The wind at a time, s."""
    state = _in_force(state, time_s)
    t = _progress(state, time_s)
    share = t * t * (3.0 - 2.0 * t)
    travel, crown = _travel(state, time_s), _crown_fade(state.before, state.wind, share)
    if t >= 1.0 or state.before == state.wind:
        return Moment(state.wind, state.wind, time_s, travel, 1.0, crown)
    wind = _between(state.before, state.wind, share)
    if _same_field(state.before, state.wind):
        return Moment(wind, wind, time_s, travel, 1.0, crown)
    before = replace(
        wind,
        model=state.before.model,
        seed=state.before.seed,
        beta=state.before.beta,
        waves=state.before.waves,
        recording=state.before.recording,
    )
    return Moment(before, wind, time_s, travel, share, crown)


def _in_force(state: WindState, time_s: float) -> WindState:
    """The state itself, or the transition to its next wind when that has begun."""
    if state.next is None or _progress(state, time_s) < 1.0:
        return state
    start_s = state.since_s + TRANSITION_S
    return WindState(state.wind, state.next, start_s, _travel(state, start_s), state.fronts)


def _progress(state: WindState, time_s: float) -> float:
    """How much of the transition has passed, 0 … 1."""
    return min(max((time_s - state.since_s) / TRANSITION_S, 0.0), 1.0)


def _travel(state: WindState, time_s: float) -> float:
    """Distance travelled at a time, s, in length scales."""
    t, since_s = _progress(state, time_s), time_s - state.since_s
    old_rate, new_rate = _rate(state.before), _rate(state.wind)
    # the integral of the smoothstep is t³ − t⁴/2, thus ½ at the end of the transition
    transition_s = TRANSITION_S * t * t * t * (1.0 - 0.5 * t) + max(0.0, since_s - TRANSITION_S)
    return state.travel + old_rate * since_s + (new_rate - old_rate) * transition_s


def _crown_fade(before: Wind, wind: Wind, share: float) -> CrownFade:
    if _crown(before) == _crown(wind):
        return CrownFade(*_crown(wind))
    if share < 0.5:
        seed, length_scale_m, weight = _crown(before)
        return CrownFade(seed, length_scale_m, (1.0 - 2.0 * share) * weight)
    seed, length_scale_m, weight = _crown(wind)
    return CrownFade(seed, length_scale_m, (2.0 * share - 1.0) * weight)


def _crown(wind: Wind) -> tuple[int, float, float]:
    """Seed, length scale and weight of the gusts within crowns; the cosine model has none."""
    return wind.seed, wind.length_scale_m, 0.0 if wind.model == "cosine" else 1.0


def _rate(wind: Wind) -> float:
    return wind.convection_speed_m_s / wind.length_scale_m


def gust_key(wind: Wind) -> tuple[object, ...]:
    """Equal for winds that share the same gust field."""
    return wind.model, wind.seed, wind.beta, wind.waves, wind.recording


def _same_field(a: Wind, b: Wind) -> bool:
    return gust_key(a) == gust_key(b)


def _same_gusts(a: Wind, b: Wind) -> bool:
    """Whether the transition only changes numbers that a document of the same model can hold in between."""
    return _same_field(a, b) and a.length_scale_m == b.length_scale_m


def _between(a: Wind, b: Wind, share: float) -> Wind:
    """Interpolate the numbers from a to b, the direction along the shorter arc; the rest is taken from b."""
    numbers = {name: _mix(getattr(a, name), getattr(b, name), share) for name in _INTERPOLATED}
    direction = b.direction_deg - (1.0 - share) * _normalised_angle(b.direction_deg - a.direction_deg)
    return replace(b, **numbers, direction_deg=_normalised_angle(direction))


def _mix(a: float, b: float, share: float) -> float:
    """Linear interpolation clamped to [a, b], so that rounding cannot make a document invalid."""
    return min(max(a + share * (b - a), min(a, b)), max(a, b))


def _normalised_angle(angle_deg: float) -> float:
    """The angle normalised to [−180, 180)."""
    return (angle_deg + 180.0) % 360.0 - 180.0
