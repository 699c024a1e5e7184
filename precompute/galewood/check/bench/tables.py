"""Cost of a table: build time by stage, memory, size, and a step of a forest that plays it."""

from __future__ import annotations

import time
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import zstandard

from galewood.check.bench.waiting import ratios, solve_s
from galewood.constants import STAGES_AFTER_TABLE
from galewood.motion.wind import Wind, wind_pressure
from galewood.pipeline.stages import TETS_PREFIX, Progress, build_table
from galewood.pipeline.tables import BuildOptions
from galewood.player import ModalForest, PaperForest, grid_placements
from galewood.solid.fem import load_model
from galewood.table import Table, decode
from galewood.util import PeakMemory, cpu_seconds

OnProgress = Callable[[float, str], None]
Forest = PaperForest | ModalForest
COMPLETE_TABLE = "complete table of the default method"
ELEMENTS = (35, 435)
COMPARED_FRAMES, QUICK_FRAMES = 60, 30
SEARCHED_TREES, FOREST_TREES = 1000, 10_000
STEP_COUNT, REPEAT_COUNT = 60, 3


def bench_build(
    mesh: Path, options: BuildOptions, cache_dir: Path, on_progress: OnProgress
) -> tuple[dict[str, Any], bytes]:
    """Wall and CPU seconds of a build by stage, its memory and its publications; and the table's bytes."""
    begun_s, begun_cpu_s = time.perf_counter(), cpu_seconds()
    published: dict[str, dict[str, float]] = {}

    def publish(name: str, content: bytes) -> None:
        shown = "tetrahedra" if name.startswith(TETS_PREFIX) else name
        published[shown] = {
            "wall_s": time.perf_counter() - begun_s,
            "cpu_s": cpu_seconds() - begun_cpu_s,
            "bytes": len(content),
        }

    with PeakMemory() as memory:
        result = build_table(
            mesh.read_bytes(), mesh.name, options, progress=_reporter(on_progress, ""), cache_dir=cache_dir,
            publish=publish, on_table=lambda default: publish(COMPLETE_TABLE, default.table),
        )  # fmt: skip
    data = result.whole_table()
    wall_s, cpu_s = result.report["seconds"], result.report["cpu_seconds"]
    frames = sum(decode(data).metadata["provenance"]["frames"])
    solved_s = solve_s(load_model(next((cache_dir / "models").glob("*.npz"))), frames)
    stages_s = {name: spent_s for name, spent_s in cpu_s.items() if name not in STAGES_AFTER_TABLE}
    figures = {
        "tree": mesh.stem,
        "wall_s": wall_s | {"total": sum(wall_s.values())},
        "cpu_s": cpu_s | {"total": sum(cpu_s.values())},
        "published": published,
        "solve_cpu_s": solved_s,
        **ratios({"complete": published[COMPLETE_TABLE]["cpu_s"], **stages_s}, solved_s),
        "peak_memory_mb": {
            "parent": memory.parent_mb,
            "largest_worker": memory.child_mb,
            "all_at_the_same_time": memory.total_mb,
        },
        "table": sizes(decode(data), data, int(result.report["meshing"]["vertices"])),
    }
    return figures, data


def _reporter(on_progress: OnProgress, what: str) -> Callable[[Progress], None]:
    return lambda progress: on_progress(progress.fraction, what + progress.message)


def sizes(table: Table, data: bytes, vertices: int) -> dict[str, Any]:
    """Bytes of a table, stored and compressed, and of Δu as the paper stores it (float32, all vertices)."""
    return {
        "records": len(table.records.dq),
        "modes": len(table.mode_scale),
        "bytes": len(data),
        "deflated_bytes": len(zlib.compress(data, 9)),
        "zstd_bytes": len(zstandard.compress(data, 19)),
        "raw_displacement_bytes": len(table.records.dq) * vertices * 3 * 4,
    }


def bench_search(
    mesh: Path, options: BuildOptions, cache_dir: Path, *, quick: bool, on_progress: OnProgress
) -> Any:
    """The paper's state search with 35 and with 435 sampled elements, both with as many frames."""
    frames = QUICK_FRAMES if quick else COMPARED_FRAMES
    found: dict[str, Any] = {"frames_per_wind": frames, "trees": SEARCHED_TREES}
    for k, count in enumerate(ELEMENTS):
        with PeakMemory() as memory:
            result = build_table(
                mesh.read_bytes(),
                mesh.name,
                options.model_copy(update={"sampled_elements": count, "frames": frames}),
                progress=_reporter(
                    lambda f, m, k=k: on_progress((k + f) / len(ELEMENTS), m), f"{count} elements: "
                ),
                cache_dir=cache_dir,
            )  # fmt: skip
        data = result.whole_table()
        table = decode(data)
        found[str(count)] = {
            "records": len(table.records.dq),
            "points": int(table.records.metadata["points"]),
            "candidates": len(table.records.candidate),
            "table_bytes": len(data),
            "us_per_tree_step": step_us(searching(table, SEARCHED_TREES), table, SEARCHED_TREES),
            "build_peak_memory_mb": memory.total_mb,
        }
    return found


def bench_forest(table: Table) -> dict[str, Any]:
    """CPU time of a step of a large forest in gusts, on one core: {method: {ms, us_per_tree}}."""
    made = {"modal": swaying, "paper": searching}
    us = {name: step_us(make(table, FOREST_TREES), table, FOREST_TREES) for name, make in made.items()}
    steps = {name: {"ms": value * FOREST_TREES / 1e3, "us_per_tree": value} for name, value in us.items()}
    return {"trees": FOREST_TREES, **steps}


def searching(table: Table, trees: int) -> PaperForest:
    """A forest that plays the table with the paper's state search."""
    return PaperForest(table, trees)


def swaying(table: Table, trees: int) -> ModalForest:
    """A forest that plays the table with the modal model."""
    return ModalForest(table.modal, float(table.metadata["dt_s"]), table.mode_scale, trees)


def step_us(forest: Forest, table: Table, trees: int) -> float:
    """CPU µs per tree and step in a forest of ``trees`` in gusts: the mean of the fastest repeat."""
    x, z, yaw, _ = grid_placements(trees)
    forest.set_trees(x, z, yaw, np.ones(trees))
    dt_s = float(table.metadata["dt_s"])
    pressure, exponent = np.zeros((2, trees), np.float32), table.streamlined_exponent
    best = np.inf
    for repeat in range(REPEAT_COUNT + 1):  # the first repeat may compile and starts from rest: not counted
        spent = 0.0
        for step in range(STEP_COUNT):
            time_s = (repeat * STEP_COUNT + step) * dt_s
            wind_pressure(Wind(), x, z, time_s, pressure[0], pressure[1], exponent)
            begun = time.process_time()
            forest.advance(dt_s * (1 + 1e-12), pressure[0], pressure[1])
            spent += time.process_time() - begun
        best = min(best, spent / STEP_COUNT / trees) if repeat else np.inf
    return best * 1e6
