"""The TrajectoryRunner that simulates training runs on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from galewood.util import Cancelled

from galewood_server.jobs.cluster.blob_transfer import BlobTransfer, TransferredTask, run_and_upload
from galewood_server.jobs.cluster.dask_cluster import EngineLostError, connected, map_on_cluster

if TYPE_CHECKING:
    from galewood.pipeline.sampling import SampleTask


@dataclass(frozen=True)
class CancellableTask:
    """A training run and the file whose existence means that the job was cancelled."""

    task: SampleTask
    flag: Path


class DaskRunner:
    """Simulates training runs on a cluster. Workers write trajectories to the shared cache folder or
    transfer them through a bucket (blob_transfer.py).
    """

    def __init__(
        self,
        address: Callable[[], str],
        flag: Path,
        on_samples: Callable[[int, int], None] = lambda on_done, total: None,
        transfer: BlobTransfer | None = None,
    ) -> None:
        """`address` is called when runs are missing; `on_samples(done, total)` with the number of finished
        runs before each report."""
        self._address = address
        self._flag = flag
        self._on_samples = on_samples
        self._transfer = transfer
        self.priority = 0
        """Priority of the runs on the cluster."""
        self.model: Path | None = None
        """File of the FEM model of the last call."""
        self.runs: list[Path] = []
        """Trajectory files of all requested runs."""

    def __call__(self, tasks: Sequence[SampleTask], on_done: Callable[[int], None]) -> list[Path]:
        """Simulate the missing runs and return all trajectory files. EngineLostError."""
        self.model = tasks[0].model if tasks else None
        self.runs += [task.path for task in tasks]
        missing = [task for task in tasks if not self._available(task)]
        ready = len(tasks) - len(missing)

        def report(count: int) -> None:
            self._on_samples(ready + count, len(tasks))
            on_done(ready + count)

        report(0)
        if missing:
            self._run(missing, report)
        return [task.path for task in tasks]

    def _available(self, task: SampleTask) -> bool:
        return task.path.exists() or (self._transfer is not None and self._transfer.fetch_run(task))

    def _run(self, missing: list[SampleTask], report: Callable[[int], None]) -> None:
        transfer, flag = self._transfer, self._flag

        def fetched(count: int, item: TransferredTask) -> None:
            if transfer and not transfer.fetch_run(item.task):
                raise EngineLostError("a run finished by a worker is missing in the bucket")
            report(count)

        with connected(self._address()) as client:
            if transfer:
                uploaded = [transfer.upload_model(task) for task in missing]
                map_on_cluster(client, run_and_upload, uploaded, fetched, self.priority)
            else:
                items = [CancellableTask(task, flag) for task in missing]
                map_on_cluster(
                    client, run_unless_cancelled, items, lambda count, _: report(count), self.priority
                )


def run_unless_cancelled(item: CancellableTask) -> str:
    """In a worker: simulate a run and check the cancel flag between frames, as Dask cannot stop a task."""
    from galewood.pipeline.sampling import run_task  # loads the solver, which only workers need

    def check_cancelled(_fraction: float) -> None:
        if item.flag.exists():
            raise Cancelled

    try:
        return str(run_task(item.task, check_cancelled))
    except Cancelled:  # the job was cancelled: return normally so that Dask does not retry
        return ""
