"""Simulation of many winds in worker processes; other runners (a cluster) use the same tasks."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from galewood.pipeline.sampling.recording import (
    SampleWind,
    is_whole,
    sample_trajectory,
    trajectory_key,
    write_trajectory,
)
from galewood.util import Array, WorkerPool

if TYPE_CHECKING:  # loaded only where a run is simulated
    from galewood.solid.fem import FemModel, Simulator


@dataclass(frozen=True)
class SampleTask:
    """One run to record, with everything a worker needs that shares the cache folder."""

    model: Path
    wind: SampleWind
    points: tuple[int, ...]
    path: Path
    """Named by the content hash of the fields above; if it exists, the run is complete."""


TrajectoryRunner = Callable[[Sequence[SampleTask], Callable[[int], None]], list[Path]]
"""Runs all tasks and reports how many are complete after each; an exception in the callback cancels the rest.
"""


def sample_tasks(
    model: FemModel, winds: Sequence[SampleWind], points: Array, cache_dir: Path
) -> list[SampleTask]:
    """The runs of a table, recorded at the given vertices (any shape, repeats allowed).

    Model and runs are stored in ``cache_dir`` under their content hash, so an interrupted build resumes. A
    damaged file (after a power failure or with a full disk) is deleted, and its run simulated again.
    """
    from galewood.solid.fem import save_model

    key = content_hash(model)
    path = cache_dir / "models" / f"{key}.npz"
    save_model(model, path)
    vertices = np.unique(points)
    tasks = [_task(path, wind, vertices if wind.recorded else vertices[:0]) for wind in winds]
    for task in tasks:
        if task.path.exists() and not is_whole(task.path):
            task.path.unlink(missing_ok=True)
    return tasks


def _task(model: Path, wind: SampleWind, vertices: Array) -> SampleTask:
    run = model.parent.parent / "trajectories" / f"{trajectory_key(model.stem, wind, vertices)}.npz"
    return SampleTask(model, wind, tuple(int(vertex) for vertex in vertices), run)


def content_hash(model: FemModel) -> str:
    """Hash of everything that determines how a model moves."""
    coefficients = (model.alpha, model.beta, model.streamlined_exponent, model.settings)
    digest = hashlib.sha256(repr(coefficients).encode())
    for name in ("nodes_m", "elements", "blocks", "mass_kg", "drag_area_m2", "fixed", "gravity_n"):
        digest.update(np.ascontiguousarray(getattr(model, name)).tobytes())
    for name in ("strain_m", "exposed_area_m2", "wind_profile", "foundation_n_m"):
        if (array := getattr(model, name)) is not None:
            digest.update(name.encode() + np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


@lru_cache(maxsize=1)
def _simulator(model: Path) -> Simulator:
    from galewood.solid.fem import Simulator, load_model

    return Simulator(load_model(model))


def run_task(task: SampleTask, on_progress: Callable[[float], None] = lambda fraction: None) -> Path:
    """Simulate one trajectory in this process unless its file exists; ``on_progress`` may raise to cancel."""
    if not task.path.exists():
        simulator = _simulator(task.model)
        dt_s = simulator.model.settings.dt_s
        run = sample_trajectory(simulator, task.wind, np.array(task.points, np.int64), dt_s, on_progress)
        write_trajectory(task.path, run)
    return task.path


def run_in_processes(
    tasks: Sequence[SampleTask],
    done: Callable[[int], None],
    workers: int | None = None,
    pool: WorkerPool | None = None,
) -> list[Path]:
    """A TrajectoryRunner on the local cores, in the given ``pool`` or in ``workers`` processes of its own."""
    missing = [task for task in tasks if not task.path.exists()]
    ready = len(tasks) - len(missing)
    done(ready)
    if missing and pool:
        _run_missing(missing, lambda count: done(ready + count), pool)
    elif missing:
        with WorkerPool(workers) as own:
            _run_missing(missing, lambda count: done(ready + count), own)
    return [task.path for task in tasks]


def _run_missing(tasks: Sequence[SampleTask], done: Callable[[int], None], pool: WorkerPool) -> None:
    futures = [pool.start(run_task, task) for task in tasks]
    try:
        for count, future in enumerate(as_completed(futures), 1):
            future.result()
            done(count)
    finally:
        for future in futures:
            future.cancel()
