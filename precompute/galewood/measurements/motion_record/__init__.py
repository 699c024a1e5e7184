"""Records of the motion of a measured tree: from the file of a logger to samples at equal intervals."""

from galewood.measurements.motion_record.columns import CHOSEN_NAMES, UNITS, Quantity
from galewood.measurements.motion_record.reading import MotionRecord, motion_record, read_motion

__all__ = ["CHOSEN_NAMES", "UNITS", "MotionRecord", "Quantity", "motion_record", "read_motion"]
