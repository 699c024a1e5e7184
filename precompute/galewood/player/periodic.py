"""Motion that repeats: the steady state of a tree's modal model under gusts that are made periodic.

The pressures of the wind over a little more than one period are blended, the last part into the first, so
that they repeat; then the model runs, period after period, until its state repeats too. Nothing of the
motion itself is blended: it is what the model does in such a wind.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.motion.wind import TreePressure, Wind, WindField
from galewood.player.modal_forest import ModalForest
from galewood.player.place_gusts import PlaceGusts
from galewood.solid.skinning import node_pose
from galewood.table import Table
from galewood.util import Floats

BLEND_S = 3.0
"""Longest part of a period over which the wind blends into that before it."""
BLEND_SHARE = 0.4
"""The same as a share of the period."""
REPEAT_TOLERANCE = 2e-5
"""Displacement of any node from one period to the next, over the height, at which the motion repeats."""
MOST_PERIODS = 60
PERIOD_START_S = 20.0
"""Time of the wind document at which the period begins: its gusts have then developed."""


@dataclass(frozen=True)
class PeriodicMotion:
    """Poses q (N, r) of one period, one for each table step dt_s."""

    q: Floats
    after: Floats
    """(r,) pose one period after the first, which it should equal."""
    dt_s: float
    seam: float
    """Largest displacement of a node between the end of the period and its beginning, over the height."""
    periods: int
    """How many periods were played until the motion repeated."""


@dataclass(frozen=True)
class _Pressures:
    """Pressures (T, 1) at the tree, x and z, Pa, and relative gusts (T, 1, 2G) at the places of its crown."""

    x: Floats
    z: Floats
    gusts: Floats


def periodic_motion(table: Table, wind: Wind, seconds: float) -> PeriodicMotion:
    """The motion of one tree, at the origin, that repeats after ``seconds``, rounded to table steps.

    Raises ValueError for a period shorter than 4 table steps.
    """
    dt_s = float(table.metadata["dt_s"])
    steps = round(seconds / dt_s)
    if steps < 4:
        raise ValueError(f"the period must be at least {4 * dt_s:.2g} s")
    blend = max(1, min(round(BLEND_S / dt_s), int(BLEND_SHARE * steps)))
    recorded = _recorded(table, wind, steps + blend)
    return _steady(table, _repeating(recorded, steps, blend), dt_s)


def _recorded(table: Table, wind: Wind, count: int) -> _Pressures:
    """The pressures of ``count`` table steps, as ``WindDrivenTrees`` has them."""
    dt_s, field, place = float(table.metadata["dt_s"]), WindField(wind), np.zeros(1)
    height_m, most_pa = [float(table.metadata["height_m"])], float(table.modal_limits[2])
    exponent = table.streamlined_exponent
    pressure = TreePressure(place, place, height_m, most_pa, exponent, limited=False)
    forest, places = _tree(table), PlaceGusts(table.modal_place, exponent, 1)
    found = _Pressures(
        np.zeros((count, 1)), np.zeros((count, 1)), np.zeros((count, 1, 2 * len(table.modal_place)))
    )
    for k in range(count):
        now_s = PERIOD_START_S + k * dt_s
        pressure.advance(field, now_s)
        found.x[k], found.z[k] = pressure.x_pa, pressure.z_pa
        found.gusts[k] = places.at(field, now_s, forest.standing, pressure.x_pa, pressure.z_pa)
    return found


def _repeating(recorded: _Pressures, steps: int, blend: int) -> _Pressures:
    return _Pressures(*(_wrapped(rows, steps, blend) for rows in (recorded.x, recorded.z, recorded.gusts)))


def _wrapped(rows: Floats, steps: int, blend: int) -> Floats:
    """(steps, …) rows whose beginning continues their end.

    The deviations from the mean are weighted by a sine and a cosine, so that the blend of two unrelated
    gusts is as strong as each of them; a mean of both would be weaker.
    """
    mean = rows.mean(axis=0)
    quarter = 0.5 * np.pi * (np.arange(blend) / blend).reshape(-1, *[1] * (rows.ndim - 1))
    found = rows[:steps].copy()
    after = rows[steps : steps + blend] - mean
    found[:blend] = mean + np.sin(quarter) * (rows[:blend] - mean) + np.cos(quarter) * after
    return found


def _tree(table: Table) -> ModalForest:
    forest = ModalForest(table.modal, float(table.metadata["dt_s"]), table.mode_scale, 1)
    forest.set_trees(0.0, 0.0, 0.0, 1.0)
    return forest


def _steady(table: Table, pressures: _Pressures, dt_s: float) -> PeriodicMotion:
    """Play the period until the motion repeats."""
    forest = _tree(table)
    steps, height_m = len(pressures.x), float(table.metadata["height_m"])
    dt_s_up = dt_s * (1 + 1e-12)  # so that rounding never skips a step
    track = np.zeros((steps, forest.q.shape[1]))
    periods = 0
    while True:
        for k in range(steps):
            forest.advance(dt_s_up, pressures.x[k], pressures.z[k], pressures.gusts[k])
            if k == 0 and periods:
                after = forest.q[0].astype(np.float64)
                seam = _farthest_m(table, after - track[0]) / height_m
                if seam <= REPEAT_TOLERANCE or periods == MOST_PERIODS:
                    return PeriodicMotion(track, after, dt_s, seam, periods)
            track[k] = forest.q[0]
        periods += 1


def _farthest_m(table: Table, q: Floats) -> float:
    """Largest displacement of a node at coordinates q (r,), m."""
    return float(np.linalg.norm(node_pose(table, q).moved_m, axis=1).max())
