"""Samples a model under many winds in processes of its own; other runners (a cluster) run the same task."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from functools import lru_cache
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from precompute.dynamics import Simulator, load_model
from precompute.sampling import SampleWind, sample_trajectory, trajectory_key, write_trajectory

Array = npt.NDArray[Any]


@dataclass(frozen=True)
class SampleTask:
    """One run to record: everything a worker needs that shares the cache folder."""

    model: Path
    wind: SampleWind
    points: tuple[int, ...]
    path: Path
    """Named by the content hash of all of the above: when it exists, it is this run."""


TrajectoryRunner = Callable[[Sequence[SampleTask], Callable[[int], None]], list[Path]]
"""Runs all tasks, telling after each how many are done; what that raises stops the rest."""


def sample_tasks(
    model: Path, model_hash: str, winds: Sequence[SampleWind], points: Array, folder: Path
) -> list[SampleTask]:
    """The runs of a table. Files are kept in ``folder``, so that a stopped build goes on where it was."""
    vertices = tuple(int(vertex) for vertex in points)
    paths = [folder / f"{trajectory_key(model_hash, wind, points)}.npz" for wind in winds]
    return [SampleTask(model, wind, vertices, path) for wind, path in zip(winds, paths, strict=True)]


@lru_cache(maxsize=1)
def _simulator(model: Path) -> Simulator:
    return Simulator(load_model(model))


def run_task(task: SampleTask, tick: Callable[[float], None] = lambda fraction: None) -> Path:
    """Make one trajectory, in whatever process this is, unless it is there; ``tick`` may raise to stop."""
    if not task.path.exists():
        simulator = _simulator(task.model)
        dt_s = simulator.model.settings.dt_s
        run = sample_trajectory(simulator, task.wind, np.array(task.points, np.int64), dt_s, tick)
        write_trajectory(task.path, run)
    return task.path


def run_in_processes(
    tasks: Sequence[SampleTask], done: Callable[[int], None], workers: int | None = None
) -> list[Path]:
    """A TrajectoryRunner on this machine's cores."""
    missing = [task for task in tasks if not task.path.exists()]
    ready = len(tasks) - len(missing)
    done(ready)
    if missing:
        _run_missing(missing, lambda count: done(ready + count), workers or os.cpu_count() or 1)
    return [task.path for task in tasks]


def _run_missing(tasks: Sequence[SampleTask], done: Callable[[int], None], workers: int) -> None:
    # Spawned, not forked: this process may hold threads and compiled code that do not survive a fork.
    with ProcessPoolExecutor(min(workers, len(tasks)), mp_context=get_context("spawn")) as pool:
        futures = [pool.submit(run_task, task) for task in tasks]
        try:
            for count, future in enumerate(as_completed(futures), 1):
                future.result()
                done(count)
        finally:
            pool.shutdown(wait=True, cancel_futures=True)
