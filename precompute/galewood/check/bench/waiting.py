"""What a visitor waits for after an upload, in times of work that cannot be left out.

Seconds differ between machines, and with what else runs there; ratios of CPU seconds can be compared: reading
and the first motion with trimesh reading the same file, the complete table with the finite-element steps of
its training runs.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from galewood.options import ImportRequest
from galewood.pipeline.stages import READ_IN_CHILD, read_upload
from galewood.sandbox import Limits, PreparedFunction
from galewood.solid.fem import FemModel, Simulator
from galewood.util import cpu_seconds

REPEAT_COUNT = 3
SOLVED_STEPS = 30
PRESSURE_PA = np.array([30.0, 10.0])


def bench_upload(mesh: Path) -> dict[str, Any]:
    """Seconds from a file to its tree and its first table, as an upload is read, and those of trimesh.

    The process that reads is loaded before; the first call is not counted.
    """
    data, function = mesh.read_bytes(), PreparedFunction(READ_IN_CHILD)
    function.prepare()
    run = partial(function.run, limits=Limits(), what="Reading the mesh")

    def read(moving: bool) -> None:
        read_upload(run, data, mesh.name, ImportRequest(), moving=moving)

    try:
        read(True)
        read_s, moving_s = _best(lambda: read(False)), _best(lambda: read(True))
    finally:
        function.close()
    trimesh_s = _best(partial(_read_with_trimesh, mesh), time.process_time)
    return {
        "tree": mesh.stem,
        "trimesh_cpu_s": trimesh_s,
        "read_cpu_s": read_s,
        "first_motion_cpu_s": moving_s,
        **ratios({"read": read_s, "first_motion": moving_s}, trimesh_s),
    }


def _read_with_trimesh(mesh: Path) -> None:
    import trimesh  # slow to load

    trimesh.load(mesh)


def _best(work: Callable[[], None], clock_s: Callable[[], float] = cpu_seconds) -> float:
    """Fewest CPU seconds of several calls; the default clock counts child processes too, in hundredths."""
    spent: list[float] = []
    for _ in range(REPEAT_COUNT):
        begun_s = clock_s()
        work()
        spent.append(clock_s() - begun_s)
    return min(spent)


def solve_s(model: FemModel, frames: int) -> float:
    """CPU seconds of this many steps of a model in a steady wind, from a few of them."""
    simulator = Simulator(model)
    simulator.reset()
    simulator.step(PRESSURE_PA)  # may compile
    begun = time.thread_time()
    for _ in range(SOLVED_STEPS):
        simulator.step(PRESSURE_PA)
    return (time.thread_time() - begun) / SOLVED_STEPS * frames


def ratios(spent_s: dict[str, float], unit_s: float) -> dict[str, float]:
    """Times in units of another one: name -> ratio."""
    return {f"{name}_ratio": seconds / max(unit_s, 1e-9) for name, seconds in spent_s.items()}
