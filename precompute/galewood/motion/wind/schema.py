"""The wind document as JSON Schema (2020-12), generated from the field table that the parser uses."""

from __future__ import annotations

from typing import Any

from galewood.constants import MOST_RECORDING_SAMPLES, MOST_WAVES, WIND_MODELS, WIND_VERSION
from galewood.motion.wind.document import FIELDS, WAVE_RULES
from galewood.motion.wind.fields import Field
from galewood.motion.wind.recording import RECORDING_RULES


def wind_schema() -> dict[str, Any]:
    """The schema, with one alternative per model. It cannot express that the shares of the waves sum to at
    most 1.
    """
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Galewood wind document",
        "oneOf": [_model_schema(model) for model in WIND_MODELS],
        "$defs": {"wave": _object_schema(WAVE_RULES, {})},
    }


def _model_schema(model: str) -> dict[str, Any]:
    fields = {name: rule for name, rule in FIELDS.items() if model in rule.models}
    schema = _object_schema(fields, {"version": {"const": WIND_VERSION}, "model": {"const": model}})
    if model == "cosine":
        waves = {"type": "array", "minItems": 1, "maxItems": MOST_WAVES, "items": {"$ref": "#/$defs/wave"}}
        schema["properties"]["waves"] = waves
    if model == "recorded":
        schema["properties"]["recording"] = _recording_schema()
        schema["required"].append("recording")
    return schema


def _recording_schema() -> dict[str, Any]:
    schema = _object_schema(RECORDING_RULES, {})
    longest = 4 * -(-MOST_RECORDING_SAMPLES * 4 // 3)
    pairs = {"type": "string", "contentEncoding": "base64", "minLength": 12, "maxLength": longest}
    schema["properties"]["pairs"] = pairs
    schema["required"].append("pairs")
    return schema


def _object_schema(fields: dict[str, Field], constants: dict[str, Any]) -> dict[str, Any]:
    required = [name for name, rule in fields.items() if rule.default is None]
    return {
        "type": "object",
        "additionalProperties": False,
        "required": [*constants, *required],
        "properties": {**constants, **{name: _number_schema(rule) for name, rule in fields.items()}},
    }


def _number_schema(rule: Field) -> dict[str, Any]:
    schema: dict[str, Any] = {
        "type": "integer" if rule.whole else "number",
        "minimum": rule.low,
        "maximum": rule.high,
    }
    if rule.default is not None and rule.default >= rule.low:
        schema["default"] = rule.default
    return schema
