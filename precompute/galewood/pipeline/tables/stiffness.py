"""Livelier or stiffer trees: the wood's stiffness is scaled until the tree has a requested frequency."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from scipy.optimize import brentq

from galewood.pipeline.tables.expected import MOST_SOFTENED, STORM_M_S, is_softened, motion_of
from galewood.pipeline.tables.options import BuildOptions
from galewood.solid.fem import FemModel
from galewood.solid.model import BeamModel, beam_model, typical_frequency_hz
from galewood.tree import TreeMesh
from galewood.util import MeshError
from galewood.wood import Wood

FREQUENCY_TOLERANCE = 0.005
"""Deviation of the first frequency from the requested one at which the search ends; 1 % is promised."""
MAX_ROUNDS = 8
LN_FACTORS = math.log(1e-5), math.log(1e4)
"""Limits of the logarithm of the factor of the stiffness."""
AIM_RATIO = 1.02
"""How far the search aims beyond the goal, so that the next point is on the other side of it."""


@dataclass(frozen=True)
class Goal:
    """First frequency to reach, Hz, a first guess of the factor of the stiffness, and why.

    ``at_most``: trees whose wood gives a frequency that is not much higher keep their wood.
    """

    frequency_hz: float
    factor: float
    reason: str = "requested"
    at_most: bool = False


def goal_of(tree: TreeMesh, wood: Wood, options: BuildOptions) -> Goal | None:
    """The first frequency that a build's options ask for; None: as stiff as its wood. Raises MeshError."""
    asked_hz = options.first_frequency_hz
    if asked_hz is None and options.sway is None:
        return _visible_goal(tree, wood, options)
    beams = _beams(tree, wood, options)
    if asked_hz is not None:
        return Goal(asked_hz, 1.0 if beams is None else beams.factor_for(asked_hz))
    if beams is None:
        raise MeshError(
            "no-branches",
            "unsuitable",
            "The sway of this tree cannot be set, because its wood has no branches.",
            "Set its first frequency instead.",
        )
    factor = beams.steady_sway_m(STORM_M_S) / ((options.sway or math.inf) * tree.height_m)
    return Goal(float(beams.frequencies_with(factor).min()), factor)


def _visible_goal(tree: TreeMesh, wood: Wood, options: BuildOptions) -> Goal | None:
    """The goal of a tree that is made softer so that its motion is visible; None: it keeps its wood.

    A modulus that was given is kept, like the radii of a scanned tree. Without beams nothing is known of the
    sway: the tree is then at most as stiff as measured ones.
    """
    if not options.may_soften or "qsm" in tree.report:
        return None
    beams = _beams(tree, wood, options)
    expected = None if beams is None else motion_of(tree, beams)
    if beams is None or expected is None:
        return Goal(typical_frequency_hz(tree.height_m), 1.0, "as measured trees of its height", at_most=True)
    if not is_softened(expected):
        return None
    hertz = float(expected["default_frequency_hz"])
    return Goal(hertz, beams.factor_for(hertz), "for visible motion")


def _beams(tree: TreeMesh, wood: Wood, options: BuildOptions) -> BeamModel | None:
    try:
        return beam_model(tree, wood, leaves=options.foliage == "leaf")
    except ValueError:
        return None


def scaled_to(goal: Goal, build: Callable[[float], FemModel]) -> tuple[FemModel, float]:
    """The model whose first frequency is the requested one, and the factor of the stiffness of its wood.

    ``build`` makes the model of a factor.

    Frequencies follow the square root of the stiffness, apart from the weight of the tree, which bends and
    softens it, and apart from what lets a soft tree stand (`galewood.solid.fem.support`): its own factors of
    stiffness and mass change with that of the wood. So the root is sought between factors that are known to
    be too small and too large, in the logarithms of both (Brent's method).
    """
    models: dict[float, FemModel] = {}

    def excess(ln_factor: float) -> float:
        """Logarithm of the first frequency over the requested one."""
        if ln_factor not in models:
            models[ln_factor] = build(math.exp(ln_factor))
        return math.log(_first_hz(models[ln_factor]) / goal.frequency_hz)

    start = 0.0 if goal.at_most else min(max(math.log(goal.factor), LN_FACTORS[0]), LN_FACTORS[1])
    if goal.at_most and excess(start) < -math.log(MOST_SOFTENED):
        return models[start], 1.0
    near, beyond = _bracket(excess, start)
    if near != beyond:
        brentq(excess, near, beyond, xtol=FREQUENCY_TOLERANCE, maxiter=MAX_ROUNDS, disp=False)
    best = min(models, key=lambda ln_factor: abs(excess(ln_factor)))
    model, factor = models[best], math.exp(best)
    model.report["stiffness"] = stiffness_report(goal, factor, model)
    return model, factor


def _bracket(excess: Callable[[float], float], start: float) -> tuple[float, float]:
    """Two places on either side of the root; twice the same if it is near enough, or if there are none."""
    near, gain = start, AIM_RATIO / 0.5  # the frequency follows the square root
    for _ in range(MAX_ROUNDS):
        found = excess(near)
        beyond = min(max(near - gain * found, LN_FACTORS[0]), LN_FACTORS[1])
        if abs(found) <= FREQUENCY_TOLERANCE or beyond == near:
            break
        if excess(beyond) * found < 0:
            return near, beyond
        near, gain = beyond, 2 * gain
    return near, near


def _first_hz(model: FemModel) -> float:
    return float(model.report["frequencies_hz"][0])


def stiffness_report(goal: Goal, factor: float, model: FemModel) -> dict[str, Any]:
    """What a build's report says: factor, reason, first frequency requested and reached.

    ``of_wood_hz`` is that of the unscaled wood, apart from the weight of the tree.
    """
    reached_hz = _first_hz(model)
    reached = abs(math.log(reached_hz / goal.frequency_hz)) <= 2 * FREQUENCY_TOLERANCE
    warning = (
        f"The first frequency is {reached_hz:.3g} Hz instead of {goal.frequency_hz:.3g} Hz: no stiffness of "
        "the wood was found with which the tree stands and has it. Choose another frequency."
    )
    return {
        "factor": factor,
        "reason": goal.reason,
        "requested_frequency_hz": goal.frequency_hz,
        "first_frequency_hz": reached_hz,
        "of_wood_hz": reached_hz / math.sqrt(factor),
        **({} if reached else {"warning": warning}),
    }
