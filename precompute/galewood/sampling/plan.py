"""The simulation runs of a table: their winds, order and storage."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from galewood.sampling.recording import DIRECTIONS_DEG, SampledRun, StoredRun, sample_winds
from galewood.sampling.runner import SampleTask, TrajectoryRunner, sample_tasks
from galewood.sampling.training_winds import SEED, further_winds, training_winds
from galewood.util import Array

if TYPE_CHECKING:
    from galewood.fem import FemModel

FIRST_NAMES = {
    "still-000",
    *(f"cosine-{k}-{direction:03.0f}" for k in (1, 3, 5) for direction in DIRECTIONS_DEG[::2]),
    *(f"gust-{direction:03.0f}" for direction in DIRECTIONS_DEG[::3]),
}
"""Runs of the preliminary table: weak, medium and strong winds from three directions, and two gusts."""
FIRST_TRAINING = slice(0, None, 3)
"""The preliminary table uses every third training wind."""


@dataclass(frozen=True)
class Samples:
    """Runs recorded for the paper's state search, and runs that only train the modal model."""

    default: Sequence[SampleTask]
    """Runs that the modal model is fitted to."""
    paper: Sequence[SampleTask]
    """Recorded runs of the paper's state search."""
    further: Sequence[SampleTask] = ()
    """Additional training runs, simulated only for trees that deflect strongly."""

    @property
    def ready(self) -> bool:
        return all(task.path.exists() for task in self.default)

    def paper_runs(self) -> list[SampledRun]:
        return [StoredRun(task.path) for task in self.paper]

    def default_runs(self) -> list[SampledRun]:
        return [StoredRun(task.path) for task in self.default]

    def further_runs(
        self, runner: TrajectoryRunner, on_progress: Callable[[float], None]
    ) -> list[SampledRun]:
        """The additional training runs, simulated now if they are missing."""
        runner(self.further, lambda number: on_progress(number / max(len(self.further), 1)))
        return [StoredRun(task.path) for task in self.further]

    def first(self) -> Samples:
        """The runs of the preliminary table, in the same order."""
        return Samples(self.default[FIRST_TRAINING], ())


def planned(
    model: FemModel, speed_m_s: float, points: Array, cache_dir: Path, *, frames: int = 180, seed: int = SEED
) -> Samples:
    """All winds up to the given maximum speed, to be recorded at the given vertices.

    ``frames`` is the length of each cosine wind, ``seed`` that of the noise and gusts of the training winds.
    """
    dt_s = model.settings.dt_s
    winds = sample_winds(speed_m_s, dt_s, frames)
    more = training_winds(speed_m_s, dt_s, seed=seed)
    further = further_winds(speed_m_s, dt_s, seed=seed)
    tasks = iter(sample_tasks(model, [*winds, *more, *further], points, cache_dir))
    paper, own, additional = (list(islice(tasks, len(some))) for some in (winds, more, further))
    free = [task for task in paper if not task.wind.fade_frames]
    return Samples([*free, *own], paper, additional)


def simulate(
    samples: Samples,
    runner: TrajectoryRunner,
    on_progress: Callable[[float], None],
    at_first: Callable[[], None],
) -> None:
    """Simulate the missing runs of the default method, those of the early table first.

    ``at_first`` is called as soon as those are complete, unless they are the only ones.
    """
    first = samples.first()
    taken = {task.path for task in first.default}
    others = [task for task in samples.default if task.path not in taken]
    tasks, waiting = [*first.default, *others], [at_first]
    frames = [len(task.wind.pressure_pa) for task in tasks]

    def done(number: int) -> None:
        on_progress(sum(frames[:number]) / sum(frames))
        if waiting and number < len(tasks) and first.ready:
            waiting.pop()()

    runner(tasks, done)
