"""The paper's Table 1 and its forest frame rates, timed in this process, and the memory of a table.

Times are process CPU time, the best of several repeats, so that other load on the machine matters little.
They are measured in every run and never cached.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.check.evaluation import Forest, Source
from galewood.check.paper.gestures import small_table
from galewood.check.paper.plan import Notes, OnProgress, Plan
from galewood.check.paper.search import Literal
from galewood.motion.wind import PRESETS, WindField
from galewood.pipeline.sampling import (
    SampledRun,
    Trajectory,
    read_trajectory,
    run_in_processes,
    sample_tasks,
    sample_winds,
)
from galewood.player import ModalForest, PaperForest, grid_placements
from galewood.solid.skeleton import extract_skeleton, sampled_elements
from galewood.table import Table, encode

DIRECTION_DEG = 60.0
TREE_COUNT = 1000
REPEAT_COUNT = 5
FORESTS: dict[str, Callable[[Table, int], Forest]] = {
    "modal": lambda table, count: ModalForest(
        table.modal, float(table.metadata["dt_s"]), table.mode_scale, count
    ),
    "paper": lambda table, count: PaperForest(table, count),
}


def by_elements(
    notes: Notes, table: Table, source: Source, content: str, on_progress: OnProgress
) -> dict[str, Any]:
    """Table 1: µs per tree and step for each number of sampled elements, with six winds in one direction.

    ``exhaustive`` is Algorithm 1 as printed, which compares every record's whole state at every step. The
    runs and the tables, identified by ``content``, may come from the cache; the times never do.
    """
    plan = notes.plan
    runs, counts, vertices = _runs_of_most(plan, table, source, on_progress)
    found: dict[str, Any] = {}
    for k, count in enumerate(plan.elements):
        on_progress(0.4 + 0.6 * k / len(plan.elements), f"Table 1: {count} elements")
        kept = [_at_points(run, vertices, counts[count]) for run in runs]
        small = notes.table(
            f"elements-{count}", f"{content} {count}", partial(small_table, table, source, kept)
        )
        found[str(count)] = {
            "records": len(small.records.dq),
            "points": len(counts[count]),
            "table_bytes": len(encode(small)),
            "exhaustive_us": exhaustive_us(kept, small, plan),
            **{f"{name}_us": step_us(small, name, plan) for name in FORESTS},
            **{f"{name}_single_us": step_us(small, name, plan, 1) for name in FORESTS},
        }
    return found


def _runs_of_most(
    plan: Plan, table: Table, source: Source, on_progress: OnProgress
) -> tuple[list[Trajectory], dict[int, npt.NDArray[np.int64]], npt.NDArray[np.int64]]:
    """Runs recorded at the vertices of the most elements.

    Returns the runs, the vertices of each number of elements, and all recorded vertices (sorted).
    """
    skeleton = extract_skeleton(source.mesh)
    most = source.mesh.tets[sampled_elements(source.mesh, skeleton, plan.elements[-1])]
    counts = {count: np.unique(most[:count]).astype(np.int64) for count in plan.elements}
    speed_m_s, dt_s = float(table.metadata["design_speed_m_s"]), float(table.metadata["dt_s"])
    sampled = sample_winds(speed_m_s, dt_s, table.streamlined_exponent, plan.element_frames)
    winds = [
        wind for wind in sampled if wind.name.startswith("cosine") and wind.direction_deg == DIRECTION_DEG
    ]
    tasks = sample_tasks(source.model, winds, most, plan.cache_dir)

    def done(ready: int) -> None:
        on_progress(0.4 * ready / len(tasks), "Table 1: simulating the winds")

    paths = run_in_processes(tasks, done, plan.workers)
    return [read_trajectory(path) for path in paths], counts, np.unique(most).astype(np.int64)


def _at_points(run: Trajectory, vertices: npt.NDArray[np.int64], kept: npt.NDArray[np.int64]) -> Trajectory:
    """Reduce a run recorded at ``vertices`` (sorted) to the vertices ``kept``."""
    where = np.searchsorted(vertices, kept)
    return Trajectory(
        run.displacement_m, run.pressure_pa, run.gusts,
        run.velocity[:, where], run.force[:, where], run.stiffness[:, where],
    )  # fmt: skip


def step_us(table: Table, method: str, plan: Plan, trees: int = TREE_COUNT) -> float:
    """CPU time, µs, of one step of one tree under a gusty wind."""
    forest, dt_s = FORESTS[method](table, trees), float(table.metadata["dt_s"])
    x, z, yaw, _ = grid_placements(trees)
    forest.set_trees(x, z, yaw, np.ones(trees))
    field, pressure = WindField(PRESETS["autumn-gusts"]), np.zeros((2, trees), np.float32)
    steps = plan.steps if trees > 1 else 20 * plan.steps
    best = np.inf
    for repeat in range(REPEAT_COUNT):
        spent = 0.0
        for step in range(steps):
            if trees > 1 or step % 20 == 0:
                time_s = (repeat * steps + step) * dt_s
                field.pressure(x, z, time_s, pressure[0], pressure[1], table.streamlined_exponent)
            start = time.process_time_ns()
            forest.advance(dt_s * (1 + 1e-12), pressure[0], pressure[1])
            spent += time.process_time_ns() - start
        best = min(best, spent / steps / trees / 1e3)
    return float(best)


def exhaustive_us(runs: Sequence[SampledRun], table: Table, plan: Plan) -> float:
    """CPU time, µs, of one step of one tree if its state is compared with every record, as printed."""
    literal, rng = Literal(table, runs), np.random.default_rng(plan.seed)
    peak = float(np.abs(table.records.pressure_pa).max())
    state = literal.find(-1, 0.0, (peak, 0.0))
    best = np.inf
    for _ in range(REPEAT_COUNT):
        start = time.process_time_ns()
        for _ in range(max(4, plan.steps // 10)):
            fx, fz = rng.uniform(-peak, peak, 2)
            state = literal.find(state, literal.most, (float(fx), float(fz)))
        best = min(best, (time.process_time_ns() - start) / max(4, plan.steps // 10) / 1e3)
    return float(best)


def forests(plan: Plan, tables: dict[str, Table]) -> dict[str, Any]:
    """CPU time, ms, of one step of mixed forests: of both methods and of the wind, by number of trees."""
    found: dict[str, Any] = {}
    for count in plan.trees:
        shares = [len(part) for part in np.array_split(np.arange(count), len(tables))]
        row = {name: _forest_ms(plan, list(tables.values()), shares, name) for name in FORESTS}
        found[str(count)] = {
            "wind_ms": min(row[name][0] for name in row),
            **{f"{name}_ms": row[name][1] for name in row},
        }
    return found


def _forest_ms(
    plan: Plan, tables: Sequence[Table], shares: Sequence[int], method: str
) -> tuple[float, float]:
    """CPU time, ms, of the wind and of the trees of one step."""
    parts = [FORESTS[method](table, count) for table, count in zip(tables, shares, strict=True)]
    x, z, yaw, _ = grid_placements(sum(shares))
    bounds = np.cumsum([0, *shares])
    cuts = [slice(a, b) for a, b in pairwise(bounds.tolist())]
    for forest, cut in zip(parts, cuts, strict=True):
        forest.set_trees(x[cut], z[cut], yaw[cut], np.ones(cut.stop - cut.start))
    field, pressure = WindField(PRESETS["autumn-gusts"]), np.zeros((2, len(x)), np.float32)
    dt_s, exponent = float(tables[0].metadata["dt_s"]), tables[0].streamlined_exponent
    best = (np.inf, np.inf)
    for repeat in range(REPEAT_COUNT):
        wind_ns = step_ns = 0
        for step in range(plan.steps):
            began = time.process_time_ns()
            time_s = (repeat * plan.steps + step) * dt_s
            field.pressure(x, z, time_s, pressure[0], pressure[1], exponent)
            blown = time.process_time_ns()
            for forest, cut in zip(parts, cuts, strict=True):
                forest.advance(dt_s * (1 + 1e-12), pressure[0, cut], pressure[1, cut])
            wind_ns, step_ns = wind_ns + blown - began, step_ns + time.process_time_ns() - blown
        best = min(best[0], wind_ns / plan.steps / 1e6), min(best[1], step_ns / plan.steps / 1e6)
    return best


def memory(table: Table, table_bytes: int, source: Source) -> dict[str, float]:
    """Size of a table and of the paper's tuples in single precision, bytes.

    ``raw``: every K (3n × 3n, dense as in Eq. 5), v, f_int, f_ext and Δu. ``reduced``: K̃ (3q × 3q), ṽ and f̃
    of the sampled elements and Δu of every vertex. ``reduced_blocks``: the same with only the compared 3 × 3
    blocks of K̃.
    """
    records = table.records
    z, n, q = len(records.dq), source.model.vertex_count, int(records.metadata["points"])
    return {
        "records": z,
        "vertices": n,
        "points": q,
        "trajectories": len(records.trajectory) - 1,
        "table": table_bytes,
        "search": records.offsets.nbytes + records.candidate.nbytes + records.mismatches.nbytes,
        "raw": 4.0 * z * (9 * n * n + 12 * n),
        "reduced": 4.0 * z * (9 * q * q + 6 * q + 3 + 3 * n),
        "reduced_blocks": 4.0 * z * (9 * q + 6 * q + 3 + 3 * n),
        "increments": 4.0 * z * 3 * n,
    }
