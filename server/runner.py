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

    def __init__(self, address: str, flag: Path) -> None:
        self._address = address
        self._flag = flag

    def __call__(self, tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        """A precompute.runner.TrajectoryRunner; sends only what is not there yet. EngineLostError."""
        missing = [CancellableTask(task, self._flag) for task in tasks if not task.path.exists()]
        ready = len(tasks) - len(missing)
        done(ready)
        if missing:
            with connected(self._address) as client:
                map_on_cluster(client, run_unless_cancelled, missing, lambda count: done(ready + count))
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
