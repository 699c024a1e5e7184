"""The public API of the library; ``import galewood`` gives its names."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from galewood.io.api.envelopes import sway_envelope
from galewood.io.api.evaluation import evaluate
from galewood.io.api.exports import body_winds, export_tree
from galewood.io.api.field_reports import field_report
from galewood.io.api.forests import Forest, Placements, PointMotion, grid
from galewood.io.api.individuals import Individual, grow, regrow
from galewood.io.api.measured_motion import calibrate, simulated_motion
from galewood.io.api.models import Model, Motion
from galewood.io.api.risk import critical_wind, gust_strain, stand_risk, strain
from galewood.io.api.tables import MotionTable, build, load, save
from galewood.io.api.trees import Tree, read

__all__ = [
    "Forest",
    "Individual",
    "Model",
    "Motion",
    "MotionTable",
    "Placements",
    "PointMotion",
    "Tree",
    "body_winds",
    "build",
    "calibrate",
    "critical_wind",
    "evaluate",
    "export_tree",
    "field_report",
    "grid",
    "grow",
    "gust_strain",
    "load",
    "read",
    "regrow",
    "save",
    "simulated_motion",
    "stand_risk",
    "strain",
    "sway_envelope",
]
