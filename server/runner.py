"""The pipeline's trajectory runner on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from precompute.build_types import Cancelled
from precompute.runner import SampleTask, run_task
from server.engine import connected, map_on_cluster


@dataclass(frozen=True)
class CancellableTask:
    """A run to record, and the file whose existence means that nobody wants it any more."""

    task: SampleTask
    flag: Path


class DaskRunner:
    """Samples every wind on the cluster; the trajectories are files in the cache that all processes share."""

    def __init__(
        self, address: str, flag: Path, samples: Callable[[int, int], None] = lambda done, total: None
    ) -> None:
        """``samples`` hears how many runs there are, of how many, before ``done`` of each call does."""
        self._address = address
        self._flag = flag
        self._samples = samples
        self.model: Path | None = None
        """The finite-element model whose runs were asked for."""

    def __call__(self, tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        """A precompute.runner.TrajectoryRunner; sends only what is not there yet. EngineLostError."""
        self.model = tasks[0].model if tasks else None
        missing = [CancellableTask(task, self._flag) for task in tasks if not task.path.exists()]
        ready = len(tasks) - len(missing)

        def tell(count: int) -> None:
            self._samples(ready + count, len(tasks))
            done(ready + count)

        tell(0)
        if missing:
            with connected(self._address) as client:
                map_on_cluster(client, run_unless_cancelled, missing, tell)
        return [task.path for task in tasks]


def run_unless_cancelled(item: CancellableTask) -> str:
    """In a worker: record a run, looking for the flag between frames, as Dask cannot stop what has begun."""

    def look(_fraction: float) -> None:
        if item.flag.exists():
            raise Cancelled

    try:
        return str(run_task(item.task, look))
    except Cancelled:  # whoever asked for it is gone: end without a noise
        return ""
