"""Blob transfer: exchange of models and training runs through a bucket with workers that share no disk.

Models are stored under their content hash, finished runs under the name of their trajectory file. A worker
keeps the last model it simulated.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import obstore
from galewood.util import Cancelled, write_atomically

from galewood_server.storage import fetch, list_keys, open_bucket, stored

if TYPE_CHECKING:
    from galewood.pipeline.sampling import SampleTask

POLL_S = 0.5


@dataclass(frozen=True)
class TransferredTask:
    """A training run for a worker that has access only to the bucket."""

    task: SampleTask
    url: str
    flag: str
    """Key whose existence means that the job was cancelled."""


class BlobTransfer:
    """The server's side: uploads models and fetches runs.

    It also stores the tetrahedral mesh for another server that takes over the job: meshing is not
    reproducible, and finished runs are valid only for the same mesh.
    """

    def __init__(self, url: str, job_id: str) -> None:
        self._url = url
        self._bucket = open_bucket(url)
        self._flag = flag_key(job_id)
        self._tets = f"transfer/tets/{job_id}/"

    def upload_model(self, task: SampleTask) -> TransferredTask:
        """Upload the model of a task, if missing, and return the task for a remote worker."""
        key = model_key(task.model)
        if stored(self._bucket, key) is None:
            obstore.put(self._bucket, key, task.model.read_bytes())
        return TransferredTask(task, self._url, self._flag)

    def fetch_run(self, task: SampleTask) -> bool:
        """Fetch a finished run; False if it does not exist. It stays in the bucket until `delete_runs`."""
        try:
            data = fetch(self._bucket, run_key(task.path))
        except FileNotFoundError:
            return False
        write_atomically(task.path, data)
        return True

    def store_tetrahedra(self, name: str, data: bytes) -> None:
        """Store the tetrahedral mesh of a build for servers that take over the job."""
        obstore.put(self._bucket, self._tets + name, data)

    def fetch_tetrahedra(self, folder: Path) -> None:
        """Fetch the tetrahedral mesh stored by an earlier server of this job, if any, into `folder`."""
        for key in self._tetrahedra_keys():
            write_atomically(folder / key.rsplit("/", 1)[-1], fetch(self._bucket, key))

    def _tetrahedra_keys(self) -> list[str]:
        return list_keys(self._bucket, self._tets)

    def delete_runs(self, runs: Sequence[Path]) -> None:
        """Delete the runs and the tetrahedral mesh after the table is stored."""
        obstore.delete(self._bucket, [*(run_key(run) for run in runs), *self._tetrahedra_keys()])

    def set_cancel_flag(self) -> None:
        """Signal the workers that the job was cancelled."""
        obstore.put(self._bucket, self._flag, b"")


def model_key(model: Path) -> str:
    return f"transfer/models/{model.name}"


def run_key(run: Path) -> str:
    return f"transfer/trajectories/{run.name}"


def flag_key(job_id: str) -> str:
    return f"transfer/cancelled/{job_id}"


def run_and_upload(item: TransferredTask) -> str:
    """In a worker: simulate and store a run, unless it exists or the job was cancelled. Returns its key."""
    from galewood.pipeline.sampling import run_task  # loads the solver, which only workers need

    bucket, key = open_bucket(item.url), run_key(item.task.path)
    if stored(bucket, key) is not None:
        return key
    with tempfile.TemporaryDirectory(prefix="galewood-run-") as folder:
        path = Path(folder) / item.task.path.name
        model = _model(item.url, item.task.model)
        try:
            run_task(replace(item.task, model=model, path=path), _cancel_check(bucket, item.flag))
        except Cancelled:  # the job was cancelled: return normally so that Dask does not retry
            return ""
        obstore.put(bucket, key, path.read_bytes())
    return key


def _cancel_check(bucket: object, flag: str) -> Callable[[float], None]:
    checked_s = time.monotonic()

    def check(_fraction: float) -> None:
        nonlocal checked_s
        if time.monotonic() - checked_s > POLL_S:
            checked_s = time.monotonic()
            if stored(bucket, flag) is not None:
                raise Cancelled

    return check


@lru_cache(maxsize=1)
def _models_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="galewood-models-")  # removed when the worker ends


def _model(url: str, model: Path) -> Path:
    """A local copy of a model; only the newest is kept."""
    copy = Path(_models_folder().name) / model.name
    if not copy.exists():
        for other in copy.parent.glob("*.npz"):
            other.unlink()
        write_atomically(copy, fetch(open_bucket(url), model_key(model)))
    return copy
