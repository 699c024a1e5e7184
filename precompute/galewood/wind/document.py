"""The wind document, version 1: fields, ranges and parsing. Specified in docs/formats/wind.md."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, cast

from galewood.wind.fields import (
    MODELS,
    Field,
    WindError,
    found_text,
    number_at,
    object_at,
    refuse_unknown,
)
from galewood.wind.recording import STILL, Recording, recording_at

VERSION = 1
TRAVELLING = ("perlin", "spectral", "navier-stokes")
"""Models whose gusts have a length scale and are advected by the air."""
LISTS = {"cosine": ("waves",), "recorded": ("recording",)}
"""Fields that are not numbers."""
MOST_WAVES = 16
SHARE_TOLERANCE = 1e-9


FIELDS: dict[str, Field] = {
    "mean_speed_m_s": Field(0.0, 60.0),
    "direction_deg": Field(-360.0, 360.0),
    "gustiness": Field(0.0, 1.0),
    "convection_speed_m_s": Field(0.5, 60.0),
    "seed": Field(0.0, 4294967295.0, whole=True),
    "length_scale_m": Field(5.0, 200.0, TRAVELLING),
    "beta": Field(0.0, 2.0, ("spectral",), 5.0 / 3.0),
    "height_exponent": Field(0.0, 1.0, MODELS, 0.2),
    "reference_height_m": Field(1.0, 60.0, MODELS, 12.0),
    "heading_swing_deg": Field(0.0, 60.0, ("cosine",), 12.0),
}
WAVE_FIELDS: dict[str, Field] = {
    "frequency_hz": Field(0.001, 4.0),
    "share": Field(0.0, 1.0),
    "across": Field(-2.0, 2.0, default=0.0),
    "phase_turns": Field(0.0, 1.0, default=-1.0),
}


@dataclass(frozen=True)
class Wave:
    """One cosine gust wave; a negative phase_turns derives the phase from the seed."""

    frequency_hz: float
    share: float
    across: float = 0.0
    phase_turns: float = -1.0


FOREST_WAVES = (
    Wave(0.05, 0.262, 0.6),
    Wave(0.087, 0.218, -0.45),
    Wave(0.152, 0.181, 0.75),
    Wave(0.264, 0.15, -0.6),
    Wave(0.46, 0.105, 0.5),
    Wave(0.8, 0.084, -0.7),
)
"""The amplitudes decrease roughly as f^(−1/3), as a −5/3 power spectrum requires, and sum to one. ``across``
is the wavenumber across the wind relative to that along it; alternating signs make the gusts cross.
"""


@dataclass(frozen=True)
class Wind:
    """A parsed wind document; fields that its model does not use keep their defaults."""

    mean_speed_m_s: float = 8.0
    direction_deg: float = 30.0
    gustiness: float = 0.5
    convection_speed_m_s: float = 8.0
    seed: int = 1
    model: str = "cosine"
    length_scale_m: float = 20.0
    beta: float = 5.0 / 3.0
    height_exponent: float = 0.2
    reference_height_m: float = 12.0
    heading_swing_deg: float = 12.0
    waves: tuple[Wave, ...] = field(default=FOREST_WAVES)
    recording: Recording = STILL
    """The measured fluctuations; model recorded only."""

    def document(self) -> dict[str, object]:
        """The JSON object that ``parse_wind`` accepts; optional fields with default values are omitted."""
        numbers = {
            name: getattr(self, name)
            for name, rule in FIELDS.items()
            if self.model in rule.models and getattr(self, name) != rule.default
        }
        document: dict[str, object] = {"version": VERSION, "model": self.model, **numbers}
        if self.model == "cosine" and self.waves != FOREST_WAVES:
            document["waves"] = [_wave_document(wave) for wave in self.waves]
        if self.model == "recorded":
            document["recording"] = self.recording.document()
        return document


def _wave_document(wave: Wave) -> dict[str, float]:
    return {name: v for name, rule in WAVE_FIELDS.items() if (v := getattr(wave, name)) != rule.default}


def parse_wind(document: object) -> Wind:
    """Parse a wind document. Raises WindError with the invalid field and what is accepted there."""
    fields = object_at(document, "wind")
    if fields.get("version") != VERSION or isinstance(fields.get("version"), bool):
        raise WindError(
            "wind.version", f"this reader knows version {VERSION}", found_text(fields.get("version"))
        )
    model = fields.get("model")
    if not isinstance(model, str) or model not in MODELS:
        raise WindError("wind.model", f"expected one of {', '.join(MODELS)}", found_text(model))
    rules = {name: rule for name, rule in FIELDS.items() if model in rule.models}
    known = [*rules, "version", "model", *LISTS.get(model, ())]
    refuse_unknown(fields, known, "wind", f"not a field of the {model} model")
    numbers: dict[str, Any] = {name: number_at(fields, name, rule, "wind") for name, rule in rules.items()}
    numbers["seed"] = int(numbers["seed"])
    if "waves" in fields:
        numbers["waves"] = _waves(fields["waves"])
    if model == "recorded":
        numbers["recording"] = recording_at(fields.get("recording"), "wind.recording")
    return Wind(model=model, **numbers)


def _waves(value: object) -> tuple[Wave, ...]:
    if not isinstance(value, list | tuple) or not 1 <= len(cast(Sequence[object], value)) <= MOST_WAVES:
        raise WindError("wind.waves", f"expected a list of 1..{MOST_WAVES} waves")
    waves = tuple(_wave(wave, f"wind.waves[{k}]") for k, wave in enumerate(cast(Sequence[object], value)))
    if sum(wave.share for wave in waves) > 1.0 + SHARE_TOLERANCE:
        raise WindError("wind.waves", "expected shares that sum to at most 1")
    return waves


def _wave(value: object, path: str) -> Wave:
    fields = object_at(value, path)
    refuse_unknown(fields, list(WAVE_FIELDS), path, "not a field of a wave")
    return Wave(**{name: number_at(fields, name, rule, path) for name, rule in WAVE_FIELDS.items()})
