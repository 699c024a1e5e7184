"""The wind field; in: wind document, positions, time; out: velocity or pressure vectors."""

from galewood.wind.document import MODELS, Wind, WindError, parse_wind
from galewood.wind.evaluation import wind_pressure
from galewood.wind.field import WindField
from galewood.wind.presets import PRESETS
from galewood.wind.pressure import (
    STREAMLINED_EXPONENT,
    dynamic_pressure,
    height_factor,
    limit_pressure,
    sampled_peak_pa,
    to_tree_frame,
)
from galewood.wind.transition import WindState, change_wind, parse_wind_or_state

__all__ = [
    "MODELS",
    "PRESETS",
    "STREAMLINED_EXPONENT",
    "Wind",
    "WindError",
    "WindField",
    "WindState",
    "change_wind",
    "dynamic_pressure",
    "height_factor",
    "limit_pressure",
    "parse_wind",
    "parse_wind_or_state",
    "sampled_peak_pa",
    "to_tree_frame",
    "wind_pressure",
]
