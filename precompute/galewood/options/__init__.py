"""What a user may choose, declared once: every interface follows from it."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from galewood.options.evaluation import (
    EVALUATION_FRAMES,
    EVALUATION_PEAK_RATIO,
    EVALUATION_SEED,
    EvaluationOptions,
    EvaluationSeed,
)
from galewood.options.individual import IndividualRequest
from galewood.options.method import METHOD_HELP, METHOD_NAMES, Method
from galewood.options.request import (
    AFTER_BEAMS,
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
    "AFTER_BEAMS",
    "EVALUATION_FRAMES",
    "EVALUATION_PEAK_RATIO",
    "EVALUATION_SEED",
    "MAX_HEIGHT_M",
    "MAX_TETS",
    "METHOD_HELP",
    "METHOD_NAMES",
    "MIN_HEIGHT_M",
    "MIN_TETS",
    "TRAINING_SEED",
    "USUAL_TETS",
    "Axis",
    "BuildRequest",
    "EvaluationOptions",
    "EvaluationSeed",
    "ImportRequest",
    "IndividualRequest",
    "Method",
    "TableRequest",
    "list_fields",
]
