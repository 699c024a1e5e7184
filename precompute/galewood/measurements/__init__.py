"""Text files of measurements (inventories, anemometer records) to the JSON that page and player read."""

from galewood.measurements.anemometer import (
    Measurement,
    MeasurementError,
    MeasurementReport,
    measured_wind,
    read_measurement,
)
from galewood.measurements.data_file import UnknownContentError, read_data_file
from galewood.measurements.inventory import Inventory, InventoryError, InventoryReport, Stem, read_inventory
from galewood.measurements.limited import convert_limited

__all__ = [
    "Inventory",
    "InventoryError",
    "InventoryReport",
    "Measurement",
    "MeasurementError",
    "MeasurementReport",
    "Stem",
    "UnknownContentError",
    "convert_limited",
    "measured_wind",
    "read_data_file",
    "read_inventory",
    "read_measurement",
]
