"""Samples a model under many winds in processes of its own; other runners (a cluster) run the same task."""

from __future__ import annotations

import hashlib
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

from precompute.dynamics import FemModel, Simulator, load_model, save_model
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
    model: FemModel, winds: Sequence[SampleWind], points: Array, cache_dir: Path
) -> list[SampleTask]:
    """The runs of a table, recorded at the given vertices (any shape, repeats allowed).

    Model and runs are kept in ``cache_dir`` under their content's hash: a stopped build goes on where it was.
    """
    key, vertices = content_hash(model), np.unique(points)
    path = cache_dir / "models" / f"{key}.npz"
    path.parent.mkdir(parents=True, exist_ok=True)
    save_model(model, path)
    folder = cache_dir / "trajectories"
    runs = [folder / f"{trajectory_key(key, wind, vertices)}.npz" for wind in winds]
    numbers = tuple(int(vertex) for vertex in vertices)
    return [SampleTask(path, wind, numbers, run) for wind, run in zip(winds, runs, strict=True)]


def content_hash(model: FemModel) -> str:
    """Hash of everything that decides how a model moves."""
    digest = hashlib.sha256(repr((model.alpha, model.beta, model.settings)).encode())
    for name in ("nodes_m", "elements", "blocks", "mass_kg", "drag_area_m2", "fixed", "gravity_n", "u_rest"):
        digest.update(np.ascontiguousarray(getattr(model, name)).tobytes())
    return digest.hexdigest()


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
