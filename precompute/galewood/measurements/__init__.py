"""Text files of measurements (inventories, anemometer records) to the JSON that page and player read."""

from galewood.measurements.anemometer import (
    Measurement,
    MeasurementReport,
    measured_velocities,
    measured_wind,
    read_measurement,
)
from galewood.measurements.data_file import UnknownContentError, read_data_file
from galewood.measurements.errors import MeasurementError
from galewood.measurements.inventory import (
    Inventory,
    InventoryError,
    InventoryReport,
    Stem,
    is_projected,
    local_m,
    read_inventory,
    wood_species_of,
)
from galewood.measurements.limited import convert_limited
from galewood.measurements.motion_record import CHOSEN_NAMES, MotionRecord, motion_record, read_motion

__all__ = [
    "CHOSEN_NAMES",
    "Inventory",
    "InventoryError",
    "InventoryReport",
    "Measurement",
    "MeasurementError",
    "MeasurementReport",
    "MotionRecord",
    "Stem",
    "UnknownContentError",
    "convert_limited",
    "is_projected",
    "local_m",
    "measured_velocities",
    "measured_wind",
    "motion_record",
    "read_data_file",
    "read_inventory",
    "read_measurement",
    "read_motion",
    "wood_species_of",
]
