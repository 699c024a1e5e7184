"""How far a tree reaches in gusts; in: a table and its mesh, winds; out: reach by height and direction."""

from galewood.check.envelope.clearance import Clearance, clearances, read_lines
from galewood.check.envelope.hours import WindClass, wind_classes
from galewood.check.envelope.plots import envelope_figure
from galewood.check.envelope.reach import SwayEnvelope, sway_envelope

__all__ = [
    "Clearance",
    "SwayEnvelope",
    "WindClass",
    "clearances",
    "envelope_figure",
    "read_lines",
    "sway_envelope",
    "wind_classes",
]
