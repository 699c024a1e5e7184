"""Measured winds: from the file of a logger to a wind document of the model recorded."""

from galewood.measurements.anemometer.arrays import measured_wind
from galewood.measurements.anemometer.reading import Measurement, measured_velocities, read_measurement
from galewood.measurements.anemometer.report import MeasurementReport
from galewood.measurements.anemometer.samples import is_measurement

__all__ = [
    "Measurement",
    "MeasurementReport",
    "is_measurement",
    "measured_velocities",
    "measured_wind",
    "read_measurement",
]
