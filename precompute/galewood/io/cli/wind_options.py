"""The options that choose a wind: a preset or a wind document, and single values that change it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from pydantic import BaseModel, Field

from galewood.motion.wind import PRESETS, Wind, WindError, parse_wind

DEFAULT_WIND = Wind()


class WindOptions(BaseModel):
    """A wind as chosen on the command line."""

    wind: str | None = Field(
        default=None,
        description=f"Preset ({', '.join(PRESETS)}) or file of a wind document.",
    )
    speed: float | None = Field(
        default=None, description=f"Mean wind speed, m/s (default {DEFAULT_WIND.mean_speed_m_s:g})."
    )
    direction: float | None = Field(
        default=None,
        description=f"Direction the wind blows towards, degrees (default {DEFAULT_WIND.direction_deg:g}).",
    )
    gustiness: float | None = Field(
        default=None, description=f"Gustiness, 0 (steady) to 1 (default {DEFAULT_WIND.gustiness:g})."
    )
    seed: int | None = Field(default=None, description=f"Seed of the gusts (default {DEFAULT_WIND.seed}).")

    def chosen(self) -> Wind:
        """The preset, the document or the default wind, with the given values. OSError or ValueError."""
        return self.changed(DEFAULT_WIND if self.wind is None else named_wind(self.wind, "--wind"))

    def changed(self, wind: Wind) -> Wind:
        """A wind with the given values."""
        given = {
            "mean_speed_m_s": self.speed,
            "direction_deg": self.direction,
            "gustiness": self.gustiness,
            "seed": self.seed,
        }
        return replace(wind, **{field: value for field, value in given.items() if value is not None})


def named_wind(name: str, option: str) -> Wind:
    """The preset of a name, or the wind document of a file. OSError or WindError, which names the option."""
    if name in PRESETS:
        return PRESETS[name]
    if not Path(name).is_file():
        raise WindError(option, f"expected a file or one of {', '.join(PRESETS)}", f", not {name!r}")
    try:
        document = json.loads(Path(name).read_bytes())
    except ValueError:
        rest = f", not {name}: `galewood convert` makes one of a measured wind"
        raise WindError(option, "expected a wind document (JSON)", rest) from None
    return parse_wind(document)
