"""How far a live tree is from its table in the same wind."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from galewood.io.export.live.gusts import LiveGusts
from galewood.io.export.live.model import LiveModel
from galewood.motion.wind import Wind, WindField
from galewood.player import PERIOD_START_S, WindDrivenTrees
from galewood.solid.skinning import drawn_positions, vertex_rows
from galewood.table import Table
from galewood.util import Floats

MEASURED_S = 20.0
EVERY_STEPS = 10


class Targets(NamedTuple):
    """Modes of the table (k,) that are morph targets, and q at a weight of 1 (k,), m."""

    modes: npt.NDArray[np.int64]
    scale_m: Floats


def live_deviation(
    table: Table, rest_m: Floats, wind: Wind, gusts: LiveGusts, model: LiveModel, targets: Targets
) -> dict[str, float]:
    """Distance of vertices from where the table draws them, in % of the height: largest, and root mean
    square.

    In the wind that the file begins with, of the cosine model, in which gusts are the same over the whole
    crown.
    """
    dt_s, height_m = model.dt_s, float(table.metadata["height_m"])
    field = WindField(replace(wind, model="cosine"))
    tree = WindDrivenTrees(table, [[0.0, 0.0, 0.0, 1.0]])
    steps, first = round((PERIOD_START_S + MEASURED_S) / dt_s), round(PERIOD_START_S / dt_s)
    times_s = [dt_s * (k + 1) for k in range(steps)]
    weights = model.played(np.array([gusts.at(time_s) for time_s in times_s]), dt_s)
    rows = vertex_rows(table, rest_m)[:, :, targets.modes] * targets.scale_m.astype(np.float32)
    square, sway, count = 0.0, 0.0, 0
    farthest = 0.0
    for k, time_s in enumerate(times_s):
        # a little more than the table's step, so that rounding never skips one
        tree.step(field, time_s, dt_s * (1 + 1e-12))
        if k >= first and (k - first) % EVERY_STEPS == 0:
            drawn = drawn_positions(table, rest_m, tree.q[0])
            apart_m = np.linalg.norm(rest_m + rows @ weights[k] - drawn, axis=1)
            farthest, count = max(farthest, float(apart_m.max())), count + 1
            square += float(np.square(apart_m).mean())
            sway = max(sway, float(np.linalg.norm(drawn - rest_m, axis=1).max()))
    return {
        "live_error_percent_of_height": 100 * farthest / height_m,
        "live_rms_percent_of_height": 100 * float(np.sqrt(square / count)) / height_m,
        "sway_percent_of_height": 100 * sway / height_m,
    }
