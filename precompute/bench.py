"""Speed and memory in one run: the FEM step, a build by stage, the table, the lookup."""

from __future__ import annotations

import resource
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from precompute.bench_fem import bench_fem
from precompute.bench_wind import bench_wind
from precompute.dynamics import load_model
from precompute.intake_types import IntakeOptions
from precompute.lookup import ForestLookup
from precompute.pipeline import BuildOptions, BuildResult, Progress, build_table
from precompute.play import planted
from precompute.table import Table, decode
from precompute.wind import Wind, wind_pressure

Tick = Callable[[float, str], None]
ELEMENTS = (35, 435)
FORESTS = (1000, 10000)
QUICK_FRAMES = 30
RECORDED_POINTS = 140


def run_bench(mesh: Path, *, quick: bool, tick: Tick) -> dict[str, Any]:
    """Every figure of ``galewood bench``. The table of 435 elements has fewer frames a wind, and says so."""
    options = BuildOptions(intake=IntakeOptions(species=mesh.stem, height_m=12.0))
    frames = {35: QUICK_FRAMES if quick else options.frames, 435: QUICK_FRAMES}
    with tempfile.TemporaryDirectory() as folder:
        built = {
            count: _build(
                mesh, replace(options, sampled_elements=count, frames=frames[count]), folder, tick, k
            )
            for k, count in enumerate(ELEMENTS)
        }
        tick(0.9, "Timing the FEM step")
        fem = _fem_step(Path(folder))
    tables = {count: decode(result.table) for count, result in built.items()}
    tick(0.95, "Timing the lookup")
    return {
        "fem_step": fem,
        "build_seconds": built[35].report["seconds"],
        "build_seconds_total": sum(built[35].report["seconds"].values()),
        "table_bytes": {str(count): len(result.table) for count, result in built.items()},
        "table_records": {str(count): len(table.dq) for count, table in tables.items()},
        "frames_per_wind": {str(count): frames[count] for count in ELEMENTS},
        "lookup_us_per_tree_step": {str(count): step_us(table, 1000) for count, table in tables.items()},
        "forest_step_ms": {str(count): step_us(tables[35], count) * count / 1e3 for count in FORESTS},
        "wind": bench_wind(),
        "peak_memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        "peak_worker_memory_mb": resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024,
    }


def _build(mesh: Path, options: BuildOptions, folder: str, tick: Tick, turn: int) -> BuildResult:
    def tell(progress: Progress) -> None:
        told = f"{options.sampled_elements} elements: {progress.message}"
        tick(0.45 * (turn + progress.fraction), told)

    return build_table(mesh.read_bytes(), mesh.name, options, progress=tell, cache_dir=Path(folder))


def _fem_step(folder: Path) -> dict[str, Any]:
    model = load_model(next((folder / "models").glob("*.npz")))
    points = np.linspace(0, model.vertex_count - 1, RECORDED_POINTS).astype(np.int32)
    return bench_fem(model, points)


def step_us(table: Table, trees: int, steps: int = 120, repeats: int = 3) -> float:
    """CPU µs of one lookup step of one tree, in a forest of this many under a gusty wind: the best repeat."""
    x, z, yaw, _ = planted(trees)
    forest = ForestLookup(table, trees)
    forest.set_trees(x, z, yaw, np.ones(trees))
    dt_s = float(table.metadata["dt_s"])
    pressure = np.zeros((2, trees), np.float32)
    best = np.inf
    for repeat in range(repeats):
        spent = 0.0
        for step in range(steps):
            wind_pressure(Wind(), x, z, (repeat * steps + step) * dt_s, pressure[0], pressure[1])
            start = time.process_time()
            forest.advance(dt_s * (1 + 1e-12), pressure[0], pressure[1])
            spent += time.process_time() - start
        best = min(best, spent / steps / trees)
    return best * 1e6
