"""The wind document, version 1: fields, ranges and parsing. Specified in spec/formats/wind.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, cast

from galewood.constants import (
    FOREST_WAVES,
    MOST_WAVES,
    UNUSED_LENGTH_SCALE_M,
    WAVE_FIELDS,
    WAVE_SHARE_TOLERANCE,
    WIND_FIELDS,
    WIND_LISTS,
    WIND_MODELS,
    WIND_VERSION,
)
from galewood.motion.wind.fields import (
    Field,
    WindError,
    checked,
    found_text,
    number_at,
    object_at,
    refuse_unknown,
)
from galewood.motion.wind.recording import EMPTY_RECORDING, Recording, recording_at

FIELDS = {name: Field(**field) for name, field in WIND_FIELDS.items()}
"""Numbers of a wind document."""
WAVES_EXPECTED = f"expected a list of 1..{MOST_WAVES} waves"
WAVE_RULES = {name: Field(**field) for name, field in WAVE_FIELDS.items()}


def check_direction(direction_deg: float) -> None:
    """Raise WindError for a direction, degrees, that no wind document may have."""
    checked(direction_deg, FIELDS["direction_deg"], "direction_deg")


@dataclass(frozen=True)
class Wave:
    """One cosine gust wave; a negative phase_turns derives the phase from the seed."""

    frequency_hz: float
    share: float
    across: float = 0.0
    phase_turns: float = -1.0

    def __post_init__(self) -> None:
        for name, rule in WAVE_RULES.items():
            if getattr(self, name) != rule.default:
                object.__setattr__(self, name, checked(getattr(self, name), rule, f"wave.{name}"))


DEFAULT_WAVES = tuple(Wave(**wave) for wave in FOREST_WAVES)
"""Waves of a cosine document without its own."""


@dataclass(frozen=True)
class Wind:
    """A wind document; fields that its model does not use keep their defaults.

    The wind blows *towards* (cos θ, 0, sin θ) in (x, y, z) with θ = ``direction_deg``, y up; x is east and z
    south, so 0 is a westerly and 90 a northerly wind. ``mean_speed_m_s`` is that at ``reference_height_m``.
    spec/formats/wind.md describes the models and the other fields. WindError if a number is out of its range.
    """

    mean_speed_m_s: float = 8.0
    direction_deg: float = 30.0
    gustiness: float = 0.5
    convection_speed_m_s: float = 8.0
    seed: int = 1
    model: str = "cosine"
    length_scale_m: float = UNUSED_LENGTH_SCALE_M
    beta: float = WIND_FIELDS["beta"]["default"]
    height_exponent: float = WIND_FIELDS["height_exponent"]["default"]
    reference_height_m: float = WIND_FIELDS["reference_height_m"]["default"]
    heading_swing_deg: float = WIND_FIELDS["heading_swing_deg"]["default"]
    waves: tuple[Wave, ...] = field(default=DEFAULT_WAVES)
    recording: Recording = EMPTY_RECORDING
    """The measured fluctuations; model recorded only."""

    def __post_init__(self) -> None:
        if self.model not in WIND_MODELS:
            raise _unknown_model(self.model)
        for name, rule in FIELDS.items():
            if self.model in rule.models:
                number = checked(getattr(self, name), rule, f"wind.{name}")
                object.__setattr__(self, name, int(number) if rule.whole else number)
        _check_waves(self.waves)

    def document(self) -> dict[str, object]:
        """The JSON object that ``parse_wind`` accepts; optional fields with default values are omitted."""
        numbers = {
            name: getattr(self, name)
            for name, rule in FIELDS.items()
            if self.model in rule.models and getattr(self, name) != rule.default
        }
        document: dict[str, object] = {"version": WIND_VERSION, "model": self.model, **numbers}
        if self.model == "cosine" and self.waves != DEFAULT_WAVES:
            document["waves"] = [_wave_document(wave) for wave in self.waves]
        if self.model == "recorded":
            document["recording"] = self.recording.document()
        return document


def _unknown_model(model: object) -> WindError:
    return WindError("wind.model", f"expected one of {', '.join(WIND_MODELS)}", found_text(model))


def _check_waves(waves: Sequence[Wave]) -> None:
    if not 1 <= len(waves) <= MOST_WAVES:
        raise WindError("wind.waves", WAVES_EXPECTED)
    if sum(wave.share for wave in waves) > 1.0 + WAVE_SHARE_TOLERANCE:
        raise WindError("wind.waves", "expected shares that sum to at most 1")


def _wave_document(wave: Wave) -> dict[str, float]:
    return {name: v for name, rule in WAVE_RULES.items() if (v := getattr(wave, name)) != rule.default}


def parse_wind(document: object) -> Wind:
    """Parse a wind document. Raises WindError with the invalid field and what is accepted there."""
    fields = object_at(document, "wind")
    if fields.get("version") != WIND_VERSION or isinstance(fields.get("version"), bool):
        raise WindError(
            "wind.version", f"this reader knows version {WIND_VERSION}", found_text(fields.get("version"))
        )
    model = fields.get("model")
    if not isinstance(model, str) or model not in WIND_MODELS:
        raise _unknown_model(model)
    rules = {name: rule for name, rule in FIELDS.items() if model in rule.models}
    known = [*rules, "version", "model", *WIND_LISTS.get(model, ())]
    refuse_unknown(fields, known, "wind", f"not a field of the {model} model")
    numbers: dict[str, Any] = {name: number_at(fields, name, rule, "wind") for name, rule in rules.items()}
    if "waves" in fields:
        numbers["waves"] = _waves(fields["waves"])
    if model == "recorded":
        numbers["recording"] = recording_at(fields.get("recording"), "wind.recording")
    return Wind(model=model, **numbers)


def _waves(value: object) -> tuple[Wave, ...]:
    if not isinstance(value, list | tuple):
        raise WindError("wind.waves", WAVES_EXPECTED)
    return tuple(_wave(wave, f"wind.waves[{k}]") for k, wave in enumerate(cast(Sequence[object], value)))


def _wave(value: object, path: str) -> Wave:
    fields = object_at(value, path)
    refuse_unknown(fields, list(WAVE_RULES), path, "not a field of a wave")
    return Wave(**{name: number_at(fields, name, rule, path) for name, rule in WAVE_RULES.items()})
