"""The wind field; in: wind document, positions, time; out: velocity or pressure vectors.

Documents are cheap to import; the names that evaluate the wind load numba and are loaded when first used.
"""

from typing import TYPE_CHECKING

from galewood.motion.wind.document import Wind, WindError, parse_wind
from galewood.motion.wind.presets import PRESETS
from galewood.motion.wind.recording import quantised
from galewood.motion.wind.transition import WindState, change_wind, parse_wind_or_state, with_front
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.motion.wind.crown import crown_carried, crown_field, write_gusts
    from galewood.motion.wind.evaluation import wind_pressure
    from galewood.motion.wind.field import WindField
    from galewood.motion.wind.pressure import (
        compress_pressure,
        dynamic_pressure,
        height_factor,
        limit_pressure,
        pressure_per_speed,
        speed_of_pressure,
        to_tree_frame,
    )

_PRESSURE = (
    "compress_pressure",
    "dynamic_pressure",
    "height_factor",
    "limit_pressure",
    "pressure_per_speed",
    "speed_of_pressure",
    "to_tree_frame",
)
__getattr__ = lazily(
    __name__,
    {
        "WindField": "galewood.motion.wind.field",
        **dict.fromkeys(("crown_carried", "crown_field", "write_gusts"), "galewood.motion.wind.crown"),
        "wind_pressure": "galewood.motion.wind.evaluation",
        **dict.fromkeys(_PRESSURE, "galewood.motion.wind.pressure"),
    },
)
__all__ = [
    "PRESETS",
    "Wind",
    "WindError",
    "WindField",
    "WindState",
    "change_wind",
    "compress_pressure",
    "crown_carried",
    "crown_field",
    "dynamic_pressure",
    "height_factor",
    "limit_pressure",
    "parse_wind",
    "parse_wind_or_state",
    "pressure_per_speed",
    "quantised",
    "speed_of_pressure",
    "to_tree_frame",
    "wind_pressure",
    "with_front",
    "write_gusts",
]
