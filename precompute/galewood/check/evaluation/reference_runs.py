"""Reference solutions (FEM) under given winds, computed in worker processes and cached by content."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from galewood.solid.fem import Simulator, load_model
from galewood.util import Floats, WorkerPool, write_arrays

Task = TypeVar("Task")

REFERENCE_VERSION = 2
"""Part of every cache key: increase it when a change of the simulation or this file changes the result."""
MAX_SCALING_RUNS = 6
"""Largest number of runs to find the scale of a wind."""
SWAY_TOLERANCE = 0.02
"""Relative tolerance of the sway that a wind is scaled to."""


@dataclass(frozen=True)
class ReferenceTask:
    """A wind (T, 2) Pa to run on a model file.

    With ``sway_m`` the wind is scaled until the tree sways that far, or until its peak is ``most_pa``.
    """

    model: Path
    pressure_pa: Floats
    sway_m: float | None = None
    most_pa: float = np.inf


@dataclass(frozen=True)
class ReferenceRun:
    """The wind after scaling (T, 2), Pa, and the displacement of the vertices after each step, m."""

    pressure_pa: Floats
    displacement_m: npt.NDArray[np.float32]  # (T, n, 3)


def reference_path(task: ReferenceTask, cache_dir: Path) -> Path:
    """Cache file of a run. The name of the model file is the hash of its content."""
    digest = hashlib.sha256(f"{REFERENCE_VERSION} {task.model.stem} {task.sway_m} {task.most_pa}".encode())
    digest.update(np.ascontiguousarray(task.pressure_pa, np.float64).tobytes())
    return cache_dir / "references" / f"{digest.hexdigest()}.npz"


def run_references(
    tasks: Sequence[ReferenceTask], cache_dir: Path, done: Callable[[int], None], workers: int = 2
) -> list[Path]:
    """Simulate the runs that are not cached and return all files in the order of the tasks.

    ``done`` is called with the number of finished tasks. Raises FloatingPointError for a diverging run.
    """
    paths = [reference_path(task, cache_dir) for task in tasks]
    run_missing(run_reference, tasks, paths, done, workers)
    return paths


def run_missing(
    run: Callable[[Task, Path], None],
    tasks: Sequence[Task],
    paths: Sequence[Path],
    done: Callable[[int], None],
    workers: int,
) -> None:
    """Run the tasks whose files do not exist; ``done`` is called with the number of finished tasks."""
    missing = [(task, path) for task, path in zip(tasks, paths, strict=True) if not path.exists()]
    ready = len(tasks) - len(missing)
    done(ready)
    if len(missing) == 1 or workers == 1:
        for count, (task, path) in enumerate(missing, 1):
            run(task, path)
            done(ready + count)
    elif missing:
        with WorkerPool(min(workers, len(missing))) as pool:
            futures = [pool.start(run, task, path) for task, path in missing]
            for count, future in enumerate(as_completed(futures), 1):
                future.result()
                done(ready + count)


def run_reference(task: ReferenceTask, path: Path) -> None:
    """Simulate one wind and write the result atomically."""
    simulator = simulator_of(task.model)
    reference = follow(simulator, task.pressure_pa)
    if task.sway_m is not None:
        reference = _scaled(simulator, reference, task.sway_m, task.most_pa)
    write_arrays(path, pressure_pa=reference.pressure_pa, displacement_m=reference.displacement_m)


def read_reference_run(path: Path) -> ReferenceRun:
    """Read a file that ``run_reference`` wrote."""
    with np.load(path, allow_pickle=False) as arrays:
        return ReferenceRun(arrays["pressure_pa"], arrays["displacement_m"])


def follow(simulator: Simulator, pressure_pa: Floats) -> ReferenceRun:
    """Simulate a wind (T, 2) Pa from gravity rest."""
    simulator.reset()
    track = np.empty((len(pressure_pa), simulator.model.vertex_count, 3), np.float32)
    for frame, pressure in enumerate(pressure_pa):
        simulator.step(pressure)
        track[frame] = simulator.u
    return ReferenceRun(pressure_pa, track)


def sway_of(reference: ReferenceRun) -> float:
    """Largest displacement of any vertex from rest, m."""
    return float(np.sqrt(np.square(reference.displacement_m).sum(axis=2).max()))


def _scaled(simulator: Simulator, reference: ReferenceRun, sway_m: float, most_pa: float) -> ReferenceRun:
    """Scale the wind to reach ``sway_m`` by fixed-point iteration; sway grows slightly less than the wind."""
    for _ in range(MAX_SCALING_RUNS):
        gap, peak = (
            sway_m / max(sway_of(reference), 1e-9),
            np.linalg.norm(reference.pressure_pa, axis=1).max(),
        )
        factor = min(gap, 3.0, most_pa / max(float(peak), 1e-9))
        if abs(gap - 1.0) <= SWAY_TOLERANCE or abs(factor - 1.0) <= 1e-3:
            break
        reference = _follow_scaled(simulator, reference.pressure_pa, factor)
    return reference


def _follow_scaled(simulator: Simulator, pressure_pa: Floats, factor: float) -> ReferenceRun:
    """Simulate the wind times ``factor``; if the simulation diverges, retry with a factor nearer to 1."""
    for _ in range(4):
        try:
            return follow(simulator, pressure_pa * factor)
        except FloatingPointError:
            factor = 1.0 + 0.5 * (factor - 1.0)
    raise FloatingPointError(
        "the simulation diverges before it reaches the requested sway: request a smaller sway"
    )


@lru_cache(maxsize=1)
def simulator_of(model: Path) -> Simulator:
    """The simulator of a model file; the last one is kept."""
    return Simulator(load_model(model))
