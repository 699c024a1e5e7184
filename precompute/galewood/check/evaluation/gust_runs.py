"""Reference solutions in a wind whose gusts differ within the crown, cached by content."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from galewood.check.evaluation.reference_runs import (
    MAX_SCALING_RUNS,
    SWAY_TOLERANCE,
    run_missing,
    simulator_of,
)
from galewood.constants import WIND_FIELDS
from galewood.motion.wind import Wind, WindState
from galewood.solid.fem import Place, Simulator, node_pressures
from galewood.util import write_arrays

GUST_RUN_VERSION = 1
"""Part of every cache key: increase it when a change of the simulation or the wind changes the result."""
MOST_SPEED_M_S = float(WIND_FIELDS["mean_speed_m_s"]["high"])


@dataclass(frozen=True)
class GustTask:
    """A wind to run on a model file, at a place; with ``sway_m``, its mean speed is scaled to this sway."""

    model: Path
    wind: Wind
    place: Place
    frames: int
    height_m: float
    most_pa: float
    sway_m: float | None = None


@dataclass(frozen=True)
class GustRun:
    """The wind after scaling, the displacement of the vertices after each step, m, and how strong it was."""

    wind: Wind
    displacement_m: npt.NDArray[np.float32]  # (T, n, 3)
    ratio: float
    """Strongest pressure at the tree over the strongest of the table, before it was compressed."""

    @property
    def sway_m(self) -> float:
        """Largest displacement of any vertex from rest, m."""
        return float(np.sqrt(np.square(self.displacement_m).sum(axis=2).max()))


def run_gusts(
    tasks: Sequence[GustTask], cache_dir: Path, done: Callable[[int], None], workers: int = 2
) -> list[GustRun]:
    """Simulate the runs that are not cached; ``done`` gets the number of finished tasks.

    Raises FloatingPointError for a diverging run.
    """
    paths = [gust_path(task, cache_dir) for task in tasks]
    run_missing(run_gust_task, tasks, paths, done, workers)
    return [_read(task, path) for task, path in zip(tasks, paths, strict=True)]


def gust_path(task: GustTask, cache_dir: Path) -> Path:
    """Cache file of a run. The name of the model file is the hash of its content."""
    settings = [task.frames, task.height_m, task.most_pa, task.sway_m]
    of = [GUST_RUN_VERSION, task.model.stem, task.wind.document(), asdict(task.place), settings]
    digest = hashlib.sha256(json.dumps(of, sort_keys=True).encode())
    return cache_dir / "references" / f"{digest.hexdigest()}.npz"


def run_gust_task(task: GustTask, path: Path) -> None:
    """Simulate one task and write the result atomically."""
    simulator = simulator_of(task.model)
    run = _follow(simulator, task, task.wind) if task.sway_m is None else _scaled(simulator, task)
    speed_m_s, ratio = np.float64(run.wind.mean_speed_m_s), np.float64(run.ratio)
    write_arrays(path, mean_speed_m_s=speed_m_s, ratio=ratio, displacement_m=run.displacement_m)


def _read(task: GustTask, path: Path) -> GustRun:
    with np.load(path, allow_pickle=False) as arrays:
        wind = replace(task.wind, mean_speed_m_s=float(arrays["mean_speed_m_s"]))
        return GustRun(wind, arrays["displacement_m"], float(arrays["ratio"]))


def _follow(simulator: Simulator, task: GustTask, wind: Wind) -> GustRun:
    """Simulate a wind from gravity rest."""
    simulator.reset()
    model, ratio = simulator.model, 0.0
    track = np.empty((task.frames, model.vertex_count, 3), np.float32)
    state = WindState(wind, wind)
    pressures = node_pressures(
        model, state, task.place, task.frames, height_m=task.height_m, most_pa=task.most_pa
    )
    for frame, pressure in enumerate(pressures):
        simulator.step(pressure.node_pa)
        track[frame], ratio = simulator.u, max(ratio, pressure.ratio)
    return GustRun(wind, track, ratio)


def _scaled(simulator: Simulator, task: GustTask) -> GustRun:
    """Scale the mean speed to reach ``sway_m``: the sway grows about as the pressure does."""
    assert task.sway_m is not None
    run = _follow(simulator, task, task.wind)
    for _ in range(MAX_SCALING_RUNS):
        gap, speed_m_s = task.sway_m / max(run.sway_m, 1e-9), run.wind.mean_speed_m_s
        factor = min(gap, 3.0) ** (1.0 / simulator.model.streamlined_exponent)
        wanted_m_s = min(speed_m_s * factor, MOST_SPEED_M_S)
        if abs(gap - 1.0) <= SWAY_TOLERANCE or abs(wanted_m_s - speed_m_s) <= 1e-3 * speed_m_s:
            break
        run = _follow_scaled(simulator, task, run.wind, wanted_m_s)
    return run


def _follow_scaled(simulator: Simulator, task: GustTask, wind: Wind, speed_m_s: float) -> GustRun:
    """Simulate the wind at another mean speed; if the simulation diverges, retry with one nearer to it."""
    for _ in range(4):
        try:
            return _follow(simulator, task, replace(wind, mean_speed_m_s=speed_m_s))
        except FloatingPointError:
            speed_m_s = 0.5 * (speed_m_s + wind.mean_speed_m_s)
    raise FloatingPointError(
        "the simulation diverges before it reaches the requested sway: request a smaller sway"
    )
