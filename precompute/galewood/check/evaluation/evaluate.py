"""Errors of a table's methods against the reference solution (FEM), on winds that were not sampled.

They are measured at two sets of vertices: the vertices of the wood's tetrahedra (error of the method and of
the truncated basis), and the render vertices as the viewer moves them (also the error of vertices that share
a node). ``floor`` is the error that would remain if the method itself were exact.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from galewood.check.evaluation.converged import run_converged
from galewood.check.evaluation.measures import CHUNK_FRAMES, errors, figures, hausdorff_by_frame, joined
from galewood.check.evaluation.reference_runs import (
    ReferenceRun,
    ReferenceTask,
    read_reference_run,
    run_references,
)
from galewood.check.evaluation.source import Source
from galewood.check.evaluation.winds import unseen_winds
from galewood.options import EvaluationOptions
from galewood.player import ModalForest, PaperForest
from galewood.solid.skinning import joint_rows
from galewood.table import Table
from galewood.util import Array, Floats

Forest = PaperForest | ModalForest
Make = Callable[[Table], Forest]
OnProgress = Callable[[float, str], None]

METHODS: dict[str, Make] = {
    "modal": lambda table: ModalForest(table.modal, float(table.metadata["dt_s"]), table.mode_scale, 1),
    "paper": lambda table: PaperForest(table, 1),
    "paper-literal": lambda table: PaperForest(table, 1, pose_easing=0.0, still_air=False),
}


PAPER_METHODS = ("paper", "paper-literal")


def methods_of(table: Table) -> dict[str, Make]:
    """The methods of a table; those of the paper only if it has their records."""
    return {name: make for name, make in METHODS.items() if table.paper or name not in PAPER_METHODS}


def play_pressures(table: Table, pressure_pa: Floats, make: Make) -> tuple[Floats, float]:
    """Play one tree of the table under ``pressure_pa`` (T, 2).

    Returns its pose q (T, r) after each step and the largest extrapolation ratio (1 for methods without one).
    A displayed pose lies between the last two steps and right after a step is the older of them, so the track
    is recorded one frame later.
    """
    forest, dt_s = make(table), float(table.metadata["dt_s"])
    poses, extrapolation_ratio = [], 0.0
    for x, z in np.concatenate([pressure_pa, pressure_pa[-1:]]):
        forest.advance(dt_s, [x], [z])
        poses.append(forest.q[0].astype(np.float64))
        extrapolation_ratio = max(
            extrapolation_ratio,
            float(forest.extrapolation_ratio[0]) if isinstance(forest, ModalForest) else 1.0,
        )
    return np.array(poses[1:]), extrapolation_ratio


def nearest_sample(table: Table, pressure_pa: Floats) -> Floats:
    """(T, r) q of the sampled run whose wind is nearest to this one (mean square), repeated."""
    records = table.records
    starts = records.trajectory.astype(np.int64)
    places = [np.resize(np.arange(a, b), len(pressure_pa)) for a, b in pairwise(starts.tolist())]
    gaps = [float(np.mean((records.pressure_pa[place] - pressure_pa) ** 2)) for place in places]
    return table.recorded_q_m[places[int(np.argmin(gaps))]]


def evaluate_table(
    table: Table,
    source: Source,
    options: EvaluationOptions,
    cache_dir: Path,
    on_progress: OnProgress,
    winds: Mapping[str, Floats] | None = None,
) -> dict[str, Any]:
    """Error figures per unseen wind and method, with a tree at rest and the nearest sampled run as baselines.

    ``winds`` (pressures (T, 2) Pa by name) replace the default ones.
    """
    winds = winds or _winds(table, options)
    tasks = reference_tasks(table, source, list(winds.values()), options.sway)

    def done(count: int) -> None:
        on_progress(0.8 * count / len(tasks), "Simulating the winds")

    paths = run_references(tasks, cache_dir, done, options.workers)
    exact = run_converged(source, paths, cache_dir, options.workers) if options.converged else None
    found: dict[str, Any] = {}
    for k, (name, path) in enumerate(zip(winds, paths, strict=True)):
        on_progress(0.8 + 0.2 * k / len(paths), f"Comparing: {name}")
        reference = read_reference_run(path)
        found[name] = compare_methods(table, source, reference, len(reference.pressure_pa) - options.frames)
        if exact:
            limit = read_reference_run(exact[k])
            found[name]["converged"] = against_converged(table, source, reference, limit)
    on_progress(1.0, "Done")
    return found


def _winds(table: Table, options: EvaluationOptions) -> dict[str, Floats]:
    speed_m_s, dt_s = float(table.metadata["design_speed_m_s"]), float(table.metadata["dt_s"])
    first_hz = next(iter(table.metadata.get("frequencies_hz") or ()), None)
    strength = options.strength if options.sway is None else 0.9
    return unseen_winds(
        speed_m_s, options.frames, dt_s, table.streamlined_exponent,
        strength=strength, seed=options.seed, first_hz=first_hz,
    )  # fmt: skip


def reference_tasks(
    table: Table, source: Source, winds: list[Floats], sway: float | None
) -> list[ReferenceTask]:
    """Reference runs of the winds (T, 2) Pa; ``sway`` as in EvaluationOptions."""
    if sway is None:
        return [ReferenceTask(source.model_path, wind) for wind in winds]
    most_pa = table.peak_pressure_pa
    sway_m = sway * float(table.metadata["height_m"])
    return [ReferenceTask(source.model_path, wind, sway_m, most_pa) for wind in winds]


def compare_methods(table: Table, source: Source, reference: ReferenceRun, lead: int = 0) -> dict[str, Any]:
    """Error figures of all methods and both baselines on one wind; ``lead`` frames of it are a lead-in.

    Without the paper's records, those are the modal model and the tree at rest.
    """
    pressure = reference.pressure_pa
    tracks = {method: play_pressures(table, pressure, make) for method, make in methods_of(table).items()}
    if table.paper:
        tracks["nearest-sample"] = (nearest_sample(table, pressure), 1.0)
    tracks["rest-pose"] = (np.zeros((len(pressure), source.subspace.modes)), 1.0)
    found = {
        method: {
            **compare(table, source, q, reference.displacement_m, lead),
            "extrapolation_ratio": extrapolation_ratio,
        }
        for method, (q, extrapolation_ratio) in tracks.items()
    }
    found["floor"] = floor(table, source, reference.displacement_m)
    return found


def against_converged(
    table: Table, source: Source, reference: ReferenceRun, limit: ReferenceRun
) -> dict[str, Any]:
    """Largest errors over the height: of the elements' time steps, of the table, and of both together."""
    height_m = float(table.metadata["height_m"])
    q, _ = play_pressures(table, reference.pressure_pa, METHODS["modal"])
    worst = {"elements": 0.0, "table": 0.0, "total": 0.0}
    for a in range(0, len(q), CHUNK_FRAMES):
        part = slice(a, a + CHUNK_FRAMES)
        shown, own, exact = (
            source.subspace.expand(q[part]),
            reference.displacement_m[part],
            limit.displacement_m[part],
        )
        for name, one, other in (("elements", own, exact), ("table", shown, own), ("total", shown, exact)):
            worst[name] = max(worst[name], float(errors(one, other).largest_m.max() / height_m))
    return worst


def compare(table: Table, source: Source, q: Floats, reference_m: Array, lead: int = 0) -> dict[str, Any]:
    """Error figures of q (T, r) at the wood's vertices, and under ``rendered`` at the render vertices."""
    height_m, q = float(table.metadata["height_m"]), q[:, : source.subspace.modes]
    wood, rendered = [], []
    for a in range(0, len(q), CHUNK_FRAMES):
        pose, exact = q[a : a + CHUNK_FRAMES], reference_m[a : a + CHUNK_FRAMES]
        wood.append(errors(source.subspace.expand(pose), exact))
        rendered.append(
            errors(
                rendered_track(table, source, pose), rendered_reference(source, exact), source.rendered.count
            )
        )
    first = slice(0, 60)
    shown = source.subspace.expand(q[first])
    return {
        **figures(joined(wood), height_m, lead),
        "reference_sway": float(joined(wood).sway_m.max() / height_m),
        "hausdorff": hausdorff_by_frame(source.rest_m, shown, reference_m[first], height_m),
        "rendered": figures(joined(rendered), height_m, lead),
    }


def rendered_track(table: Table, source: Source, q: Floats) -> Floats:
    """(T, j, 3) displacement of the joints that hold the render vertices, m, by the first modes of q."""
    rows = joint_rows(table, table.node_basis[:, :, : q.shape[1]]).astype(np.float64)
    # laid out in memory as rendered_reference
    return np.einsum("nik,tk->nti", rows, q).transpose(1, 0, 2)


def rendered_reference(source: Source, reference_m: Array) -> Floats:
    """(T, j, 3) displacement of the same joints with the reference solution (T, n, 3), m."""
    frames, n, _ = reference_m.shape
    flat = reference_m.astype(np.float64).transpose(1, 0, 2).reshape(n, -1)
    return np.asarray(source.rendered.binding @ flat).reshape(-1, frames, 3).transpose(1, 0, 2)


def floor(table: Table, source: Source, reference_m: Array) -> dict[str, float]:
    """Unavoidable errors over the height: truncated modes, and render vertices that share a node."""
    height_m, truncation, nodes = float(table.metadata["height_m"]), [], []
    for a in range(0, len(reference_m), CHUNK_FRAMES):
        exact = reference_m[a : a + CHUNK_FRAMES].astype(np.float64)
        q = source.subspace.project(exact)
        truncation.append(errors(source.subspace.expand(q), exact))
        nodes.append(
            errors(rendered_track(table, source, q), rendered_reference(source, exact), source.rendered.count)
        )
    return {
        "truncation": float(joined(truncation).largest_m.max() / height_m),
        "truncation_and_nodes": float(joined(nodes).largest_m.max() / height_m),
        "truncation_and_nodes_rms": float(np.sqrt(joined(nodes).mean_square_m2.mean()) / height_m),
    }
