"""Errors of a table in gusts that differ within the crown, as the page and every forest play them.

The table is played as a forest plays it (``WindDrivenTrees``); the reference solution feels the same wind at
each of its nodes (``galewood.solid.fem.node_pressures``). Place, heading and gusts follow from the seed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from galewood.check.evaluation.branches import branch_motion_m
from galewood.check.evaluation.evaluate import OnProgress, methods_of
from galewood.check.evaluation.gust_runs import GustRun, GustTask, run_gusts
from galewood.check.evaluation.source import ModelSource
from galewood.motion.wind import PRESETS, Wind, WindField, WindState
from galewood.options import METHOD_NAMES, EvaluationOptions, Method
from galewood.player import WindDrivenTrees
from galewood.solid.fem import Place
from galewood.solid.skinning import joint_rows, points_embedding
from galewood.table import Table
from galewood.util import Array, Floats

SPEEDS_M_S, SWAYS = (7.0, 18.0), (0.1, 0.2)
"""Mean speeds of the winds, and the shares of the height to which further ones are scaled."""
SCALED_FROM_M_S = 12.0
SETTLING_S = 4.0
"""Time from rest that is left out of the root mean squares, at most a quarter of a run."""
FARTHEST_PLACE_M, LATEST_START_S = 200.0, 600.0


@dataclass(frozen=True)
class GustCase:
    """A wind, scaled to a sway if one is given, as a share of the height."""

    wind: Wind
    sway: float | None = None


def gust_cases(options: EvaluationOptions) -> dict[str, GustCase]:
    """The winds of an evaluation by name: the preset "Autumn gusts" at several speeds and sways."""
    heading = np.random.default_rng(options.seed).uniform(0.0, 360.0)
    gusts = replace(PRESETS["autumn-gusts"], seed=options.seed, direction_deg=float(heading))
    scaled = replace(gusts, mean_speed_m_s=SCALED_FROM_M_S)
    sways = SWAYS if options.sway is None else (options.sway,)
    speeds = SPEEDS_M_S if options.sway is None else ()
    return {
        **{f"{speed:g} m/s": GustCase(replace(gusts, mean_speed_m_s=speed)) for speed in speeds},
        **{f"{100 * sway:g} % sway": GustCase(scaled, sway) for sway in sways},
    }


def place_of(seed: int) -> Place:
    """Where the tree of an evaluation stands."""
    rng = np.random.default_rng([seed, 1])
    x_m, z_m = rng.uniform(-FARTHEST_PLACE_M, FARTHEST_PLACE_M, 2).tolist()
    return Place(x_m, z_m, float(rng.uniform(0.0, 2.0 * np.pi)), float(rng.uniform(0.0, LATEST_START_S)))


def evaluate_in_gusts(
    table: Table,
    source: ModelSource,
    options: EvaluationOptions,
    cache_dir: Path,
    on_progress: OnProgress,
    cases: Mapping[str, GustCase] | None = None,
) -> dict[str, Any]:
    """Figures by case (spec/formats/evaluation.md); ``cases`` replace the default ones."""
    cases, place = cases or gust_cases(options), place_of(options.seed)
    height_m, most_pa = float(table.metadata["height_m"]), strongest_pa(table)
    tasks = [
        GustTask(
            source.model_path, case.wind, place, options.frames, height_m, most_pa,
            None if case.sway is None else case.sway * height_m,
        )
        for case in cases.values()
    ]  # fmt: skip

    def done(count: int) -> None:
        on_progress(0.9 * count / len(tasks), "Simulating gusts")

    runs = run_gusts(tasks, cache_dir, done, options.workers)
    found: dict[str, Any] = {}
    for k, (name, run) in enumerate(zip(cases, runs, strict=True)):
        on_progress(0.9 + 0.1 * k / len(runs), f"Comparing: {name}")
        found[name] = case_figures(table, source, place, run)
    on_progress(1.0, "Done")
    return found


def strongest_pa(table: Table) -> float:
    """The pressure to which the trees of a table compress a stronger wind, Pa."""
    return WindDrivenTrees(table, np.array([[0.0, 0.0, 0.0, 1.0]])).most_pa


def play_in_wind(
    table: Table, wind: WindState, place: Place, frames: int, method: Method = "modal"
) -> tuple[Floats, float]:
    """Play one tree as a forest does: its poses q (T, r), m, after each step, and its extrapolation ratio.

    A displayed pose lies between the last two steps and right after a step is the older of them, so the track
    is recorded one frame later.
    """
    trees = WindDrivenTrees(table, np.array([[place.x_m, place.z_m, place.yaw_rad, 1.0]]), method)
    field, dt_s, ratio = WindField(wind), float(table.metadata["dt_s"]), 0.0
    poses = np.empty((frames + 1, len(table.mode_scale)))
    for frame in range(frames + 1):
        trees.step(field, place.start_s + (frame + 1) * dt_s, dt_s)
        poses[frame], ratio = trees.q[0], max(ratio, float(trees.extrapolation_ratio[0]))
    return poses[1:], ratio


def case_figures(table: Table, source: ModelSource, place: Place, run: GustRun) -> dict[str, Any]:
    """Figures of the reference solution, and of each method of the table against it."""
    height_m, frames = float(table.metadata["height_m"]), len(run.displacement_m)
    late = slice(min(round(SETTLING_S / float(table.metadata["dt_s"])), frames // 4), None)
    nodes = _embedded(points_embedding(table.node_rest_m, source.mesh), run.displacement_m)
    joints = _embedded(points_embedding(table.joint_rest_m, source.mesh), run.displacement_m)
    sway_m = _rms(nodes[late] - nodes[late].mean(axis=0))
    branches_m = branch_motion_m(table, nodes[late])
    basis = table.node_basis.astype(np.float64)
    rows = joint_rows(table, table.node_basis).astype(np.float64)

    def figures(q: Floats) -> dict[str, Any]:
        moved = np.einsum("nik,tk->tni", basis, q)
        own_m = branch_motion_m(table, moved[late])
        gap_m = np.linalg.norm(np.einsum("nik,tk->tni", rows, q) - joints, axis=2).max(axis=1)
        return {
            "rms_error_of_rms_sway": _rms(moved[late] - nodes[late]) / max(sway_m, 1e-12),
            "max_error": float(gap_m.max() / height_m),
            "branches": own_m / max(branches_m, 1e-12) if own_m is not None and branches_m else None,
            "error_by_frame": [float(gap) for gap in gap_m / height_m],
        }

    state = WindState(run.wind, run.wind)
    methods: dict[str, Any] = {}
    playable = methods_of(table)
    for name in METHOD_NAMES:
        if name not in playable:
            continue
        q, ratio = play_in_wind(table, state, place, frames, name)
        methods[name] = {**figures(q), "extrapolation_ratio": ratio}
    flat = nodes.reshape(frames, -1).T
    best = np.linalg.lstsq(basis.reshape(-1, basis.shape[2]), flat, rcond=None)[0].T
    return {
        "mean_speed_m_s": run.wind.mean_speed_m_s,
        "reference_sway": run.sway_m / height_m,
        "rms_sway": sway_m / height_m,
        "branches_m": branches_m,
        "pressure_ratio": run.ratio,
        **methods,
        "floor": figures(np.asarray(best, np.float64)),
    }


def _embedded(weights: scipy.sparse.csr_matrix, displacement_m: Array) -> Floats:
    """(T, m, 3) displacement of points with these weights (m, n) on the vertices, whose is (T, n, 3), m."""
    frames, n, _ = displacement_m.shape
    flat = displacement_m.astype(np.float64).transpose(1, 0, 2).reshape(n, -1)
    return np.ascontiguousarray(np.asarray(weights @ flat).reshape(-1, frames, 3).transpose(1, 0, 2))


def _rms(vectors: Floats) -> float:
    """Root mean square length of vectors (..., 3)."""
    return float(np.sqrt(np.square(vectors).sum(axis=-1).mean()))
