"""The widget: what Python and the front end (web/player/src/notebook/widget.ts) know of each other."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import anywidget
import traitlets

from galewood.motion.wind import PRESETS, Wind, WindError, parse_wind


class WindTrait(traitlets.TraitType[Wind, Wind | str | Mapping[str, Any]]):
    """A wind: in Python a ``Wind``, which presets and documents become; in the front end a document."""

    info_text = f"a galewood.Wind, a wind document, or one of {', '.join(PRESETS)}"

    def validate(self, obj: Any, value: object) -> Wind:
        """The wind that a value stands for. TraitError."""
        try:
            return wind_of(value)
        except WindError as error:
            raise traitlets.TraitError(f"{error} ({self.name} must be {self.info_text})") from None


def wind_of(value: object) -> Wind:
    """A wind from itself, the name of a preset, or a document, also as JSON. WindError."""
    if isinstance(value, Wind):
        return parse_wind(value.document())
    if not isinstance(value, str):
        return parse_wind(value)
    if value in PRESETS:
        return PRESETS[value]
    try:
        return parse_wind(json.loads(value))
    except (json.JSONDecodeError, RecursionError):
        raise WindError("wind", "neither a preset nor JSON", f": {value[:40]!r}") from None


def _to_front_end(wind: Wind, widget: object) -> dict[str, object]:
    return wind.document()


def _from_front_end(document: object, widget: object) -> Wind:
    return parse_wind(document)


class ForestWidget(anywidget.AnyWidget):
    """Trees of one table that sway; ``wind`` may be changed while they do, here and on the page."""

    table = traitlets.Bytes(read_only=True).tag(sync=True)
    """The table file."""
    mesh = traitlets.Bytes(read_only=True).tag(sync=True)
    """The GLB that belongs to it."""
    trees = traitlets.Int(5, min=1, max=500, read_only=True).tag(sync=True)
    """Number of trees."""
    wind = WindTrait(PRESETS["breeze"]).tag(sync=True, to_json=_to_front_end, from_json=_from_front_end)
    """The wind that blows."""
    height_px = traitlets.Int(400, min=50, max=4000).tag(sync=True)
    """Height of the picture, px."""

    def __init__(self, front_end: str, **state: Any) -> None:
        """``front_end``: source of the JavaScript module; ``state``: values of the traits. TraitError."""
        self._esm = front_end
        fixed = {name: state.pop(name) for name in ("table", "mesh", "trees")}
        for name, value in fixed.items():
            self.set_trait(name, value)
        super().__init__(**state)
