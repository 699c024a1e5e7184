"""Livelier or stiffer trees: the wood's stiffness is scaled until the tree has a requested frequency."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from galewood.pipeline.tables.expected import MOST_SOFTENED, STORM_M_S, is_softened, motion_of
from galewood.pipeline.tables.options import BuildOptions
from galewood.solid.fem import FemModel
from galewood.solid.model import BeamModel, beam_model, typical_frequency_hz
from galewood.tree import TreeMesh
from galewood.util import MeshError
from galewood.wood import Wood

FREQUENCY_TOLERANCE = 0.005
"""Deviation of the first frequency from the requested one at which the search ends; 1 % is promised."""
MAX_MODELS = 12
MIN_FACTOR, MAX_FACTOR = 1e-5, 1e4
"""Limits of the factor of the stiffness."""
WIDEST_STEP = 100.0
"""Largest change of the factor in a step of the search."""
SMALLEST_SLOPE, AIM_RATIO = 0.02, 1.02
"""Least growth of ln frequency with ln factor that the search believes, and how far it aims beyond the goal,
so that the next point is on the other side of it."""


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
    stiffness and mass change with that of the wood. The factor is therefore searched for between factors that
    are known to be too small and too large.
    """
    search = _Search(goal.frequency_hz)
    factor = 1.0 if goal.at_most else _limited(goal.factor)
    best: tuple[float, FemModel, float] | None = None
    for _ in range(MAX_MODELS):
        model = build(factor)
        found_hz = _first_hz(model)
        if goal.at_most and factor == 1 and goal.frequency_hz > MOST_SOFTENED * found_hz:
            return model, factor
        off = abs(math.log(found_hz / goal.frequency_hz))
        if best is None or off < best[0]:
            best = off, model, factor
        if off <= FREQUENCY_TOLERANCE:
            break
        search.add(factor, found_hz)
        following = search.next()
        if following == factor:
            break
        factor = following
    assert best is not None
    _, model, factor = best
    model.report["stiffness"] = stiffness_report(goal, factor, model)
    return model, factor


class _Search:
    """The factor of a frequency, by secants through points (ln factor, ln frequency over the wanted one).

    If a secant stays on one side of the bracket, the other end counts half (the Illinois rule).
    """

    def __init__(self, wanted_hz: float) -> None:
        self._wanted = math.log(wanted_hz)
        self._points: list[tuple[float, float]] = []
        self._ends: dict[bool, tuple[float, float]] = {}

    def add(self, factor: float, found_hz: float) -> None:
        """Take a factor and the frequency that it gave, Hz."""
        point = math.log(factor), math.log(found_hz) - self._wanted
        high = point[1] > 0
        if self._points and (self._points[-1][1] > 0) == high and (not high) in self._ends:
            x, y = self._ends[not high]
            self._ends[not high] = x, y / 2
        self._points.append(point)
        self._ends[high] = point

    def next(self) -> float:
        """The factor to try next."""
        if len(self._ends) == 2:
            (a, below), (b, above) = self._ends[False], self._ends[True]
            return _limited(math.exp(a - below * (b - a) / (above - below)))
        (x, y), slope = self._points[-1], 0.5  # the square root, until two points tell more
        if len(self._points) > 1:
            before_x, before_y = self._points[-2]
            slope = min(max((y - before_y) / (x - before_x), SMALLEST_SLOPE), 0.5)
        step = min(max(-AIM_RATIO * y / slope, -math.log(WIDEST_STEP)), math.log(WIDEST_STEP))
        return _limited(math.exp(x + step))


def _limited(factor: float) -> float:
    return min(max(factor, MIN_FACTOR), MAX_FACTOR)


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
