"""The pipeline's trajectory runner on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from galewood.sampling import SampleTask, run_task
from galewood.util import Cancelled

from galewood_server.jobs.cluster.blob_transfer import BlobTransfer, TransferredTask, run_elsewhere
from galewood_server.jobs.cluster.dask_cluster import EngineLostError, connected, map_on_cluster


@dataclass(frozen=True)
class CancellableTask:
    """A run to record, and the file whose existence means that nobody wants it any more."""

    task: SampleTask
    flag: Path


class DaskRunner:
    """Samples every wind on the cluster. The trajectories are files in the cache, which the workers share, or
    come there through a bucket (exchange.py) from workers that do not.
    """

    def __init__(
        self,
        address: str,
        flag: Path,
        samples: Callable[[int, int], None] = lambda done, total: None,
        transfer: BlobTransfer | None = None,
    ) -> None:
        """``samples`` hears how many runs there are, of how many, each time before ``done`` does."""
        self._address = address
        self._flag = flag
        self._samples = samples
        self._transfer = transfer
        self.model: Path | None = None
        """The finite-element model whose runs were asked for."""
        self.runs: list[Path] = []
        """Every run that was asked for."""

    def __call__(self, tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        """A galewood.sampling.runner.TrajectoryRunner; sends only what is not there yet. EngineLostError."""
        self.model = tasks[0].model if tasks else None
        self.runs += [task.path for task in tasks]
        missing = [task for task in tasks if not self._here(task)]
        ready = len(tasks) - len(missing)

        def tell(count: int) -> None:
            self._samples(ready + count, len(tasks))
            done(ready + count)

        tell(0)
        if missing:
            self._run(missing, tell)
        return [task.path for task in tasks]

    def _here(self, task: SampleTask) -> bool:
        return task.path.exists() or (self._transfer is not None and self._transfer.take(task))

    def _run(self, missing: list[SampleTask], tell: Callable[[int], None]) -> None:
        transfer, flag = self._transfer, self._flag

        def taken(count: int, item: TransferredTask) -> None:
            if transfer and not transfer.take(item.task):
                raise EngineLostError("a worker's run did not arrive")
            tell(count)

        with connected(self._address) as client:
            if transfer:
                map_on_cluster(client, run_elsewhere, [transfer.ask(task) for task in missing], taken)
            else:
                items = [CancellableTask(task, flag) for task in missing]
                map_on_cluster(client, run_unless_cancelled, items, lambda count, _: tell(count))


def run_unless_cancelled(item: CancellableTask) -> str:
    """In a worker: record a run, looking for the flag between frames, as Dask cannot stop what has begun."""

    def look(_fraction: float) -> None:
        if item.flag.exists():
            raise Cancelled

    try:
        return str(run_task(item.task, look))
    except Cancelled:  # whoever asked for it is gone: end without a noise
        return ""
