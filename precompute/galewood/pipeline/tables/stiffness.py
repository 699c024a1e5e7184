"""Livelier or stiffer trees: the wood's stiffness is scaled until the tree has a requested frequency."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from galewood.pipeline.tables.expected import STORM_M_S
from galewood.pipeline.tables.options import BuildOptions
from galewood.solid.fem import FemModel
from galewood.solid.model import BeamModel, beam_model
from galewood.tree import TreeMesh
from galewood.util import MeshError
from galewood.wood import Wood

FREQUENCY_TOLERANCE = 0.02
"""Accepted deviation of the first frequency from the requested one."""
MAX_CORRECTIONS = 3
MIN_FACTOR, MAX_FACTOR = 1e-5, 1e4
"""Limits of the factor of the stiffness."""


@dataclass(frozen=True)
class Goal:
    """First frequency to reach, Hz, and a first guess of the factor of the stiffness."""

    frequency_hz: float
    factor: float


def goal_of(tree: TreeMesh, wood: Wood, options: BuildOptions) -> Goal | None:
    """The first frequency that a build's options ask for; None: as stiff as its wood. Raises MeshError."""
    if options.first_frequency_hz is None and options.sway is None:
        return None
    beams = _beams(tree, wood, options)
    if options.first_frequency_hz is not None:
        asked_hz = options.first_frequency_hz
        return Goal(asked_hz, 1.0 if beams is None else (asked_hz / float(beams.frequencies_hz[0])) ** 2)
    if beams is None:
        raise MeshError(
            "no-branches",
            "unsuitable",
            "The sway of this tree cannot be set, because its wood has no branches.",
            "Set its first frequency instead.",
        )
    factor = beams.steady_sway_m(STORM_M_S) / ((options.sway or math.inf) * tree.height_m)
    return Goal(float(beams.frequencies_hz[0]) * math.sqrt(factor), factor)


def _beams(tree: TreeMesh, wood: Wood, options: BuildOptions) -> BeamModel | None:
    try:
        return beam_model(tree, wood, leaves=options.foliage == "leaf")
    except ValueError:
        return None


def scaled_to(goal: Goal, wood: Wood, build: Callable[[Wood], FemModel]) -> tuple[FemModel, Wood]:
    """The model whose first frequency is the requested one, and its wood.

    Frequencies follow the square root of the stiffness, apart from the weight of the tree, which bends and
    softens it: the factor is corrected with the frequency of each model.
    """
    factor = min(max(goal.factor, MIN_FACTOR), MAX_FACTOR)
    model = build(wood.scaled(factor))
    for _ in range(MAX_CORRECTIONS):
        ratio = goal.frequency_hz / float(model.report["frequencies_hz"][0])
        if abs(ratio - 1) <= FREQUENCY_TOLERANCE:
            break
        factor = min(max(factor * ratio**2, MIN_FACTOR), MAX_FACTOR)
        model = build(wood.scaled(factor))
    model.report["stiffness"] = stiffness_report(goal, factor, model)
    return model, wood.scaled(factor)


def stiffness_report(goal: Goal, factor: float, model: FemModel) -> dict[str, Any]:
    """What a build's report says: factor, first frequency requested, reached, and of the unscaled wood."""
    reached_hz = float(model.report["frequencies_hz"][0])
    return {
        "factor": factor,
        "requested_frequency_hz": goal.frequency_hz,
        "first_frequency_hz": reached_hz,
        "of_wood_hz": reached_hz / math.sqrt(factor),
    }
