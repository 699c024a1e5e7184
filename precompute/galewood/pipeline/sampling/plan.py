"""The simulation runs of a table: their winds, order and storage."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from galewood.pipeline.sampling.recording import (
    COSINE_PREFIX,
    SampledRun,
    SampleWind,
    StoredRun,
    sample_winds,
)
from galewood.pipeline.sampling.runner import SampleTask, TrajectoryRunner, sample_tasks
from galewood.util import Array

if TYPE_CHECKING:
    from galewood.solid.fem import FemModel

UNRECORDED_PREFIXES = tuple(f"{COSINE_PREFIX}{k}-" for k in (0, 2, 4))
"""Cosine winds without which the paper's method errs no more (docs/design/0013-training-runs.md)."""


@dataclass(frozen=True)
class Samples:
    """The runs of a table; those of the default method and of the paper's state search are disjoint."""

    default: Sequence[SampleTask]
    """The runs that the modal model is fitted to; each follows the FEM dynamics to its end."""
    paper: Sequence[SampleTask]
    """The runs whose states are recorded for the paper's state search."""

    @property
    def winds(self) -> list[SampleWind]:
        return [task.wind for task in (*self.default, *self.paper)]

    @property
    def ready(self) -> bool:
        """Whether all runs of the default method exist."""
        return all(task.path.exists() for task in self.default)

    def default_runs(self) -> list[SampledRun]:
        return [StoredRun(task.path) for task in self.default]

    def paper_runs(self) -> list[SampledRun]:
        return [StoredRun(task.path) for task in self.paper]


def plan_samples(
    model: FemModel,
    speed_m_s: float,
    points: Array,
    cache_dir: Path,
    training: Sequence[SampleWind],
    *,
    frames: int = 180,
    all_winds: bool = False,
) -> Samples:
    """The training winds, and the paper's winds up to the given speed, recorded at the given vertices.

    ``frames`` is the length of each of the paper's cosine winds. Three of the six are recorded, in six
    directions, or with ``all_winds`` all six.
    """
    paper = sample_winds(speed_m_s, model.settings.dt_s, model.streamlined_exponent, frames)
    tasks = sample_tasks(model, [*training, *paper], points, cache_dir)
    own, every = tasks[: len(training)], tasks[len(training) :]
    recorded = [task for task in every if not task.wind.name.startswith(UNRECORDED_PREFIXES)]
    return Samples(own, every if all_winds else recorded)


def simulate(samples: Samples, runner: TrajectoryRunner, on_progress: Callable[[float], None]) -> None:
    """Simulate the missing runs of the default method; ``on_progress`` receives the share of frames done."""
    frames = [len(task.wind.pressure_pa) for task in samples.default]
    runner(samples.default, lambda number: on_progress(sum(frames[:number]) / sum(frames)))
