"""What the drift-free method makes of the very runs that it was fitted to: a check of every build."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from galewood.modal import ModalTensors
from galewood.player import ModalForest
from galewood.reduction.modal_fit import RunLike
from galewood.reduction.pod import Subspace
from galewood.util import Floats


def training_error_m(modal: ModalTensors, subspace: Subspace, runs: Sequence[RunLike], dt_s: float) -> float:
    """Mean over the runs of a run's largest vertex error, in metres, the method stepped from rest on its own.

    Not the largest of all: the one run that bends the tree farthest would decide alone.
    """
    shown = simulated_q(modal, [np.asarray(run.pressure_pa, np.float64) for run in runs], dt_s)
    gaps = [_largest_gap_m(subspace, q, run.displacement_m) for q, run in zip(shown, runs, strict=True)]
    return float(np.mean(gaps))


def simulated_q(modal: ModalTensors, pressures_pa: Sequence[Floats], dt_s: float) -> list[Floats]:
    """The shown modes (T + 1, r) of the states from rest on, under each pressure (T, 2), side by side."""
    count, frames = len(pressures_pa), max(len(pressure) for pressure in pressures_pa)
    winds = np.zeros((frames + 1, 2, count))
    for i, pressure in enumerate(pressures_pa):
        winds[: len(pressure), :, i] = pressure
    forest = ModalForest(modal, dt_s, np.ones(modal.modes, np.float32), count)
    q = np.empty((frames + 1, count, modal.modes))
    for frame, (x, z) in enumerate(winds):
        forest.advance(dt_s, x, z)  # a forest shows the state before the step that it has just made
        q[frame] = forest.q
    return [q[: len(pressure) + 1, i] for i, pressure in enumerate(pressures_pa)]


def _largest_gap_m(subspace: Subspace, q: Floats, reference_m: npt.NDArray[np.floating]) -> float:
    flat = subspace.basis.reshape(-1, subspace.modes)
    gap = (q @ flat.T).reshape(reference_m.shape) - reference_m
    return float(np.sqrt(np.square(gap).sum(axis=2).max()))
