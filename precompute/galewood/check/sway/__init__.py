"""Recorded motion of trees in wind; in: records of strain, tilt, acceleration or sway; out: their figures."""

from galewood.check.sway.analysis import AxisSway, SwayAnalysis, analyse_motion
from galewood.check.sway.calibration import Calibration, calibrated
from galewood.check.sway.plots import COLOURS, GREY_COLOUR, sway_figure
from galewood.check.sway.predicted import PredictedSway, predicted_sway
from galewood.check.sway.simulated import simulated_motion
from galewood.check.sway.sway_mode import SwayMode, main_sway_mode
from galewood.check.sway.wind_response import WindResponse

__all__ = [
    "COLOURS",
    "GREY_COLOUR",
    "AxisSway",
    "Calibration",
    "PredictedSway",
    "SwayAnalysis",
    "SwayMode",
    "WindResponse",
    "analyse_motion",
    "calibrated",
    "main_sway_mode",
    "predicted_sway",
    "simulated_motion",
    "sway_figure",
]
