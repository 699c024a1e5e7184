"""The converged reference: the same elements and winds with smaller time steps.

The time scheme is of second order, so steps a quarter as long have a sixteenth of the error. A free decay
from 20 % sway agrees with Newton's method on both stages of steps an eighth as long within 0.1 % of the
height (docs/physics.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from galewood.check.evaluation.reference_runs import ReferenceTask, read_reference_run, run_references
from galewood.check.evaluation.source import Source
from galewood.pipeline.sampling import content_hash
from galewood.solid.fem import FemModel, save_model

STEP_REFINEMENT = 4
"""Steps of the converged reference per step of the elements."""


def converged_model(model: FemModel) -> FemModel:
    """The model with smaller time steps."""
    substeps = STEP_REFINEMENT * max(model.settings.substeps, 1)
    return replace(model, settings=replace(model.settings, substeps=min(substeps, 64)))


def run_converged(source: Source, paths: Sequence[Path], cache_dir: Path, workers: int) -> list[Path]:
    """Simulate the winds of reference runs with smaller steps; returns the files of the runs."""
    model = converged_model(source.model)
    path = cache_dir / "models" / f"{content_hash(model)}.npz"
    if not path.exists():
        save_model(model, path)
    tasks = [ReferenceTask(path, read_reference_run(reference).pressure_pa) for reference in paths]
    return run_references(tasks, cache_dir, lambda count: None, workers)
