"""The wind field; in: wind document, positions, time; out: velocity or pressure vectors.

Documents are cheap to import; the names that evaluate the wind load numba and are loaded when first used.
"""

from typing import TYPE_CHECKING

from galewood.util import lazily
from galewood.wind.document import Wind, WindError, parse_wind
from galewood.wind.presets import PRESETS
from galewood.wind.transition import WindState, change_wind, parse_wind_or_state, with_front

if TYPE_CHECKING:
    from galewood.wind.crown import crown_carried, crown_field, write_gusts
    from galewood.wind.evaluation import wind_pressure
    from galewood.wind.field import WindField
    from galewood.wind.measured.errors import MeasurementError
    from galewood.wind.measured.reading import Measurement, read_measurement
    from galewood.wind.measured.report import MeasurementReport
    from galewood.wind.measured.samples import is_measurement
    from galewood.wind.pressure import (
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
        "Measurement": "galewood.wind.measured.reading",
        "MeasurementError": "galewood.wind.measured.errors",
        "MeasurementReport": "galewood.wind.measured.report",
        "WindField": "galewood.wind.field",
        "is_measurement": "galewood.wind.measured.samples",
        "read_measurement": "galewood.wind.measured.reading",
        **dict.fromkeys(("crown_carried", "crown_field", "write_gusts"), "galewood.wind.crown"),
        "wind_pressure": "galewood.wind.evaluation",
        **dict.fromkeys(_PRESSURE, "galewood.wind.pressure"),
    },
)
__all__ = [
    "PRESETS",
    "Measurement",
    "MeasurementError",
    "MeasurementReport",
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
    "is_measurement",
    "limit_pressure",
    "parse_wind",
    "parse_wind_or_state",
    "pressure_per_speed",
    "read_measurement",
    "speed_of_pressure",
    "to_tree_frame",
    "wind_pressure",
    "with_front",
    "write_gusts",
]
