"""Training error of the modal model: a check in every build."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from galewood.motion.modal import ModalTensors
from galewood.pipeline.reduction.modal_runs import RunLike
from galewood.pipeline.reduction.pod import Subspace
from galewood.pipeline.sampling import CrownGusts
from galewood.player import ModalForest
from galewood.util import Floats


def training_error_m(modal: ModalTensors, subspace: Subspace, runs: Sequence[RunLike], dt_s: float) -> float:
    """Mean over the training runs of the largest vertex error of each run, m, simulated from rest.

    The mean and not the maximum, as the single run that bends the tree farthest would decide otherwise.
    """
    winds = [(np.asarray(run.pressure_pa, np.float64), CrownGusts.of_array(run.gusts)) for run in runs]
    shown = simulated_q(modal, winds, dt_s)
    gaps = [_largest_gap_m(subspace, q, run.displacement_m) for q, run in zip(shown, runs, strict=True)]
    return float(np.mean(gaps))


def simulated_q(modal: ModalTensors, winds: Sequence[tuple[Floats, CrownGusts]], dt_s: float) -> list[Floats]:
    """Output modes (T + 1, r), starting at rest, under pressures (T, 2), Pa, with gusts within the crown."""
    count, frames = len(winds), max(len(pressure) for pressure, _ in winds)
    place_m = np.asarray(modal.place, np.float64)
    pressures, gusts = np.zeros((frames + 1, 2, count)), np.zeros((frames + 1, count, 2 * len(place_m)))
    for i, (pressure, within) in enumerate(winds):
        pressures[: len(pressure), :, i] = pressure
        gusts[: len(pressure), i] = within.relative(place_m, pressure, dt_s)
    forest = ModalForest(modal, dt_s, np.ones(modal.modes, np.float32), count)
    q = np.empty((frames + 1, count, modal.modes))
    for frame, (x, z) in enumerate(pressures):
        forest.advance(dt_s, x, z, gusts[frame])  # right after a step, q is the pose before that step
        q[frame] = forest.q
    return [q[: len(pressure) + 1, i] for i, (pressure, _) in enumerate(winds)]


def _largest_gap_m(subspace: Subspace, q: Floats, reference_m: npt.NDArray[np.floating]) -> float:
    flat = subspace.basis.reshape(-1, subspace.modes)
    squared = np.square((q @ flat.T).reshape(reference_m.shape) - reference_m)
    # a sum over the last axis of length 3 would take five times as long
    return float(np.sqrt((squared[..., 0] + squared[..., 1] + squared[..., 2]).max()))
