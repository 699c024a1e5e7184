"""Training runs side by side, as the output-error fit steps them all at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from galewood.motion.modal import ModalTensors
from galewood.pipeline.reduction.modal_runs import ModalRun
from galewood.util import Floats


@dataclass(frozen=True)
class Target:
    """The runs side by side, each a lane; shorter ones end in still air without weight."""

    pressure_pa: Floats  # (T, 2, R) at the tree
    felt_pa: Floats  # (T, 2, R) mean over the crown
    air_pa: Floats  # (T, 2m, R) at the drag points
    local_pa: Floats  # (T, 2G, R) gusts at the places
    e: Floats  # (T + 1, d, R)
    weight: Floats  # (T + 1, R) of the squared error


def side_by_side(model: ModalTensors, runs: Sequence[ModalRun], weights: Floats) -> Target:
    """The runs with their weights (R,) as lanes; each run's squared errors are averaged over its frames."""
    mean = model.mean_gust
    counts = [len(run.wind.pressure_pa) for run in runs]
    return Target(
        pressure_pa=_lanes([run.wind.pressure_pa for run in runs]),
        felt_pa=_lanes([run.felt_pa(mean) for run in runs]),
        air_pa=_lanes([run.air_pa(model.drag_place) for run in runs]),
        local_pa=_lanes([run.wind.local_pa.reshape(len(run.wind.local_pa), -1) for run in runs]),
        e=_lanes([run.e for run in runs]),
        weight=_lanes([np.full(n + 1, w * w / n) for n, w in zip(counts, weights.tolist(), strict=True)]),
    )


def _lanes(rows: Sequence[Floats]) -> Floats:
    """Arrays (T, …) of different lengths along a last axis, zero after their ends."""
    lanes = np.zeros((max(len(row) for row in rows), *rows[0].shape[1:], len(rows)))
    for i, row in enumerate(rows):
        lanes[: len(row), ..., i] = row
    return lanes
