"""The public API of the library; ``import galewood`` gives its names."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from galewood.api.evaluation import evaluate
from galewood.api.exports import export_tree
from galewood.api.field_reports import field_report
from galewood.api.forests import Forest, Placements, grid
from galewood.api.models import Model, Motion
from galewood.api.tables import MotionTable, build, load, save
from galewood.api.trees import Tree, read

__all__ = [
    "Forest",
    "Model",
    "Motion",
    "MotionTable",
    "Placements",
    "Tree",
    "build",
    "evaluate",
    "export_tree",
    "field_report",
    "grid",
    "load",
    "read",
    "save",
]
