"""Measured winds: from the file of a logger to a wind document of the model recorded."""

from galewood.measurements.anemometer.arrays import measured_wind
from galewood.measurements.anemometer.errors import MeasurementError
from galewood.measurements.anemometer.reading import Measurement, read_measurement
from galewood.measurements.anemometer.report import MeasurementReport
from galewood.measurements.anemometer.samples import is_measurement

__all__ = [
    "Measurement",
    "MeasurementError",
    "MeasurementReport",
    "is_measurement",
    "measured_wind",
    "read_measurement",
]
