"""Sampled runs through a bucket: for workers that share no disk with whoever asks them.

The model goes there under its file's name, which is its content's hash; each run comes back under the name of
its trajectory. A worker keeps the last model it simulated.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import obstore
from galewood.sampling import SampleTask, run_task
from galewood.util import Cancelled, write_whole

from galewood_server.storage import fetch, open_bucket, stored

LOOK_S = 0.5


@dataclass(frozen=True)
class TransferredTask:
    """A run to record on a machine that knows nothing but the bucket."""

    task: SampleTask
    url: str
    flag: str
    """Key whose existence means that nobody wants the run any more."""


class BlobTransfer:
    """The asking side: models out, runs in; and the tetrahedra, which no two meshings make alike, kept for
    the server that may take the job over: with others the finished runs would be of no use.
    """

    def __init__(self, url: str, job_id: str) -> None:
        self._url = url
        self._bucket = open_bucket(url)
        self._flag = flag_key(job_id)
        self._tets = f"transfer/tets/{job_id}/"

    def ask(self, task: SampleTask) -> TransferredTask:
        """The task as a worker elsewhere can run it; its model is put where the worker finds it."""
        key = model_key(task.model)
        if stored(self._bucket, key) is None:
            obstore.put(self._bucket, key, task.model.read_bytes())
        return TransferredTask(task, self._url, self._flag)

    def take(self, task: SampleTask) -> bool:
        """Bring a finished run here; whether it was there. It stays, in case another server takes over."""
        try:
            data = fetch(self._bucket, run_key(task.path))
        except FileNotFoundError:
            return False
        write_whole(task.path, data)
        return True

    def keep_tetrahedra(self, name: str, data: bytes) -> None:
        """Put a build's mesh where the next server of this job finds it."""
        obstore.put(self._bucket, self._tets + name, data)

    def bring_tetrahedra(self, folder: Path) -> None:
        """Put the mesh of this job's earlier servers, if there is one, into the cache of meshes."""
        for key in self._kept_tetrahedra():
            write_whole(folder / key.rsplit("/", 1)[-1], fetch(self._bucket, key))

    def _kept_tetrahedra(self) -> list[str]:
        return [item["path"] for page in obstore.list(self._bucket, prefix=self._tets) for item in page]

    def forget(self, runs: Sequence[Path]) -> None:
        """Once the table is published: nobody needs the runs and the mesh there any more."""
        obstore.delete(self._bucket, [*(run_key(run) for run in runs), *self._kept_tetrahedra()])

    def cancel(self) -> None:
        """Tell the workers that nobody wants the runs of this job."""
        obstore.put(self._bucket, self._flag, b"")


def model_key(model: Path) -> str:
    return f"transfer/models/{model.name}"


def run_key(run: Path) -> str:
    return f"transfer/trajectories/{run.name}"


def flag_key(job_id: str) -> str:
    return f"transfer/cancelled/{job_id}"


def run_elsewhere(item: TransferredTask) -> str:
    """In a worker: record a run and store it, unless it is there or nobody wants it any more."""
    bucket, key = open_bucket(item.url), run_key(item.task.path)
    if stored(bucket, key) is not None:
        return key
    with tempfile.TemporaryDirectory(prefix="galewood-run-") as folder:
        path = Path(folder) / item.task.path.name
        model = _model(item.url, item.task.model)
        try:
            run_task(replace(item.task, model=model, path=path), _watch(bucket, item.flag))
        except Cancelled:  # whoever asked for it is gone: end without a noise
            return ""
        obstore.put(bucket, key, path.read_bytes())
    return key


def _watch(bucket: object, flag: str) -> Callable[[float], None]:
    looked_s = time.monotonic()

    def look(_fraction: float) -> None:
        nonlocal looked_s
        if time.monotonic() - looked_s > LOOK_S:
            looked_s = time.monotonic()
            if stored(bucket, flag) is not None:
                raise Cancelled

    return look


@lru_cache(maxsize=1)
def _models_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="galewood-models-")  # removed when the worker ends


def _model(url: str, model: Path) -> Path:
    """The model's file on this machine; only the newest is kept."""
    here = Path(_models_folder().name) / model.name
    if not here.exists():
        for other in here.parent.glob("*.npz"):
            other.unlink()
        write_whole(here, fetch(open_bucket(url), model_key(model)))
    return here
