"""The motion of trees as arrays over time, with its derivatives.

A table advances a tree in steps of its own time (1/30 s at scale 1), and what is shown is linear in between:
it has no acceleration. The track of a point is therefore a cubic spline through its places at the ends of the
steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicSpline

from galewood.motion.wind import WindField
from galewood.player.wind_driven import WindDrivenTrees
from galewood.util import Floats


@dataclass(frozen=True)
class GroupTracks:
    """T samples of one point of each of the n trees of a group."""

    moved: Floats
    """(3, T, n, 3) displacement, m, velocity and acceleration, in the frames of the trees at scale 1."""
    blown: Floats
    """(2, T, n, 2) wind, m/s, at the tops and pressure, Pa, on the trees, along world x and z."""


def record_points(
    groups: Sequence[WindDrivenTrees],
    rows: Sequence[Floats],
    field: WindField,
    time_s: Floats,
    step: Callable[[WindField, float, float], None],
) -> list[GroupTracks]:
    """Step groups of trees from time_s[0] to time_s[-1] and return the motion of a point at these times.

    ``step`` advances all of them (``WindDrivenForest.step``). ``rows`` (3, r) of each group give the
    displacement of its point per modal coordinate. The motion is as it is shown, a step of the table behind
    the wind.
    """
    first_s, span_s = float(time_s[0]), float(time_s[-1] - time_s[0])
    shortest_s = min(float(one.period_s.min()) for one in groups)
    frames = math.ceil(span_s / shortest_s)  # no tree takes two steps in a frame
    dt_s = span_s / frames
    frame_s = np.linspace(first_s + dt_s, first_s + span_s, frames)
    recorders = [_Recorder(*one, first_s) for one in zip(groups, rows, strict=True)]
    for now_s in frame_s.tolist():
        step(field, now_s, dt_s)
        for recorder in recorders:
            recorder.take(field, now_s, dt_s)
    return [GroupTracks(one.moved(time_s), one.blown(time_s, frame_s)) for one in recorders]


class _Recorder:
    """Collects the steps of a group."""

    def __init__(self, trees: WindDrivenTrees, rows: Floats, time_s: float) -> None:
        self._trees, self._rows = trees, rows
        before, now, phase = trees.steps
        self._phase, self._period_s = phase.copy(), trees.period_s
        begun_s = time_s - phase * self._period_s
        self._times = [
            [late_s, late_s + step_s] for late_s, step_s in zip(begun_s, self._period_s, strict=True)
        ]
        self._points = [list(pair) for pair in zip(before @ rows.T, now @ rows.T, strict=True)]
        self._blown: list[Floats] = []

    def take(self, field: WindField, time_s: float, dt_s: float) -> None:
        """Note which trees took a step in the frame that ended now."""
        _, now, phase = self._trees.steps
        stepped = np.flatnonzero(phase < self._phase + 0.5 * dt_s / self._period_s)
        end_s = time_s + (1.0 - phase) * self._period_s  # when the new pose will be shown
        for tree, point in zip(stepped.tolist(), now[stepped] @ self._rows.T, strict=True):
            self._times[tree].append(end_s[tree])
            self._points[tree].append(point)
        self._phase = phase.copy()
        self._blown.append(np.stack([self._trees.wind_m_s(field, time_s), self._trees.pressure_pa]))

    def moved(self, time_s: Floats) -> Floats:
        """(3, T, n, 3) places, velocities and accelerations."""
        splines = [
            CubicSpline(np.array(times), np.array(points))
            for times, points in zip(self._times, self._points, strict=True)
        ]
        return np.array([np.stack([one(time_s, order) for one in splines], axis=1) for order in range(3)])

    def blown(self, time_s: Floats, frame_s: Floats) -> Floats:
        """(2, T, n, 2) wind and pressure, linear between the frames."""
        series = np.array(self._blown)
        columns = series.reshape(len(frame_s), -1).T
        sampled = np.array([np.interp(time_s, frame_s, column) for column in columns])
        return np.moveaxis(sampled.T.reshape(len(time_s), *series.shape[1:]), 1, 0)
