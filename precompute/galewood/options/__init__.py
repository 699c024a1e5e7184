"""Options of mesh import and build: one model from which every interface follows."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from galewood.options.evaluation import EvaluationOptions
from galewood.options.request import (
    MAX_HEIGHT_M,
    MAX_TETS,
    MIN_HEIGHT_M,
    MIN_TETS,
    TRAINING_SEED,
    USUAL_TETS,
    Axis,
    BuildRequest,
    ImportRequest,
    TableRequest,
    list_fields,
)

__all__ = [
    "MAX_HEIGHT_M",
    "MAX_TETS",
    "MIN_HEIGHT_M",
    "MIN_TETS",
    "TRAINING_SEED",
    "USUAL_TETS",
    "Axis",
    "BuildRequest",
    "EvaluationOptions",
    "ImportRequest",
    "TableRequest",
    "list_fields",
]
