"""The options that choose a wind: a preset or a wind document, and single values that change it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import BaseModel, Field

if TYPE_CHECKING:
    from galewood.motion.wind import Wind


class WindOptions(BaseModel):
    """A wind as chosen on the command line."""

    wind: str | None = Field(
        default=None,
        description="Preset (still, breeze, autumn-gusts, storm-front) or file of a wind document.",
    )
    speed: float | None = Field(default=None, description="Mean wind speed, m/s (default 8).")
    direction: float | None = Field(
        default=None, description="Direction the wind blows towards, degrees (default 30)."
    )
    gustiness: float | None = Field(default=None, description="Gustiness, 0 (steady) to 1 (default 0.5).")
    seed: int | None = Field(default=None, description="Seed of the gusts (default 1).")

    def chosen(self) -> Wind:
        """The preset, the document or the default wind, with the given values. OSError or ValueError."""
        from galewood.motion.wind import PRESETS, Wind, WindError, parse_wind

        given = {
            "mean_speed_m_s": self.speed,
            "direction_deg": self.direction,
            "gustiness": self.gustiness,
            "seed": self.seed,
        }
        name = self.wind
        if name is None:
            wind = Wind()
        elif name in PRESETS:
            wind = PRESETS[name]
        elif Path(name).is_file():
            wind = parse_wind(json.loads(Path(name).read_bytes()))
        else:
            raise WindError("--wind", f"expected a file or one of {', '.join(PRESETS)}", f", not {name!r}")
        return replace(wind, **{field: value for field, value in given.items() if value is not None})
