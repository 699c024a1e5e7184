"""The paper's Fig. 3 and 5: poses at single frames, by the reference solution and by the table's methods."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from galewood.check.evaluation import (
    FRAMES_SHOWN,
    METHODS,
    Make,
    ReferenceTask,
    Source,
    directed_pressure,
    hausdorff,
    play_pressures,
    read_reference_run,
    recorded_runs,
    run_references,
    samples_of,
)
from galewood.check.paper.plan import Plan
from galewood.pipeline.reduction import ModalTraining, Subspace, oscillators_of, output_modes
from galewood.pipeline.sampling import DIRECTIONS_DEG, SampledRun, sample_winds
from galewood.pipeline.tables import TableContext, TableSettings, assemble_table, render_mesh
from galewood.player import PaperForest
from galewood.solid.skeleton import extract_skeleton
from galewood.solid.skinning import axis_of_tets
from galewood.table import Table
from galewood.util import Floats

TARGET_DIRECTION_DEG = 60.0
TARGET_WIND = (0.62, 0.45, 4.3)
"""Wind of the paper's Fig. 3a, which has no numbers: peak over the design speed, depth, period in s."""
DIRECTION_FRAME = 20
OWN_TABLE = "paper-own-table"


@dataclass(frozen=True)
class Fig3:
    """One target wind: figures by method, and poses at the paper's frames for the pictures."""

    figures: dict[str, Any]
    reference_m: dict[int, Floats]  # frame: (n, 3)
    pose: dict[str, dict[int, Floats]]  # method: frame: (r,)


@dataclass(frozen=True)
class Fig5:
    """Six winds of equal strength: figures by direction, and poses at frame 20."""

    figures: dict[str, Any]
    reference_m: list[Floats]
    pose: list[Floats]


def target_wind(table: Table, frames: int) -> Floats:
    """(frames, 2) Pa: a cosine wind at 60° with an amplitude and a period that no sampled wind has."""
    peak, depth, period_s = TARGET_WIND
    t = np.arange(frames) * float(table.metadata["dt_s"])
    wave = (1 + depth * np.cos(2 * np.pi * (t / period_s + 0.5))) / (1 + depth)
    return directed_pressure(
        float(table.metadata["design_speed_m_s"]) * peak * wave, np.radians(TARGET_DIRECTION_DEG),
        table.streamlined_exponent,
    )  # fmt: skip


def paper_gestures(plan: Plan, table: Table, source: Source) -> Fig3:
    """Fig. 3 by every method, and by the literal search on a table of six winds at 60° (Sec. 6.1)."""
    wind = target_wind(table, max(FRAMES_SHOWN))
    task = ReferenceTask(source.model_path, wind)
    reference = read_reference_run(
        run_references([task], plan.cache_dir, lambda done: None)[0]
    ).displacement_m
    own, own_modes = own_table(plan, table, source)
    literal: Make = lambda small: PaperForest(small, 1, pose_easing=0.0, still_air=False)  # noqa: E731
    shapes: dict[str, tuple[Subspace, Floats]] = {
        name: (source.subspace, play_pressures(table, wind, make)[0]) for name, make in METHODS.items()
    }
    shapes[OWN_TABLE] = (own_modes, play_pressures(own, wind, literal)[0])
    sway = np.linalg.norm(reference, axis=2).max(axis=1)
    height_m = float(table.metadata["height_m"])
    figures = {
        "first_maximum_frame": first_maximum(sway),
        "sway": {str(f): float(sway[f - 1] / height_m) for f in FRAMES_SHOWN},
        "hausdorff": {
            name: {
                str(f): _hausdorff(source, modes, q[f - 1], reference[f - 1]) / height_m
                for f in (*FRAMES_SHOWN, first_maximum(sway))
            }
            for name, (modes, q) in shapes.items()
        },
    }
    shown = (20, 40, 60)
    pose = {name: {f: q[f - 1] for f in shown} for name, (_, q) in shapes.items() if name != OWN_TABLE}
    return Fig3(figures, {f: reference[f - 1].astype(np.float64) for f in shown}, pose)


def first_maximum(sway_m: Floats) -> int:
    """Frame, counted from 1, of the first maximum of the sway (frames,)."""
    falls = np.flatnonzero(np.diff(sway_m) < 0)
    return int(falls[0]) + 1 if len(falls) else len(sway_m)


def _hausdorff(source: Source, modes: Subspace, q: Floats, reference_m: Floats) -> float:
    """Hausdorff distance, m, between the pose q (r,) and the reference displacement (n, 3)."""
    shown = modes.expand(q[None])[0]
    return hausdorff(source.rest_m + shown, source.rest_m + reference_m)


def own_table(plan: Plan, table: Table, source: Source) -> tuple[Table, Subspace]:
    """The table of the paper's Sec. 6.1, six winds in one direction, and its modes on the wood."""
    samples = samples_of(table, source.model, source.mesh, plan.cache_dir, plan.workers)
    chosen = [
        run
        for run, task in zip(recorded_runs(samples, plan.workers), samples.paper, strict=True)
        if task.wind.name.startswith("cosine") and task.wind.direction_deg == TARGET_DIRECTION_DEG
    ]
    mass_kg = source.model.mass_kg[: source.model.vertex_count]
    own = small_table(table, source, chosen)
    return own, output_modes(_training(source, chosen), mass_kg)[1]


def _training(source: Source, runs: Sequence[SampledRun]) -> ModalTraining:
    return ModalTraining(oscillators_of(source.model), source.model.settings, runs)


def small_table(table: Table, source: Source, runs: Sequence[SampledRun]) -> Table:
    """Build a table of the same tree from other runs."""
    mass_kg = source.model.mass_kg[: source.model.vertex_count]
    axis = axis_of_tets(source.mesh, extract_skeleton(source.mesh))
    surface = render_mesh(source.tree, source.binding, axis)
    of = TableContext(mass_kg, surface, dict(table.metadata), TableSettings())
    return assemble_table(runs, (), _training(source, runs), of)


def paper_directions(plan: Plan, table: Table, source: Source) -> Fig5:
    """Fig. 5: the strongest cosine wind from six directions, at frame 20."""
    metadata = table.metadata
    winds = sample_winds(
        float(metadata["design_speed_m_s"]), float(metadata["dt_s"]), table.streamlined_exponent,
        DIRECTION_FRAME,
    )  # fmt: skip
    strongest = [wind for wind in winds if wind.name.startswith("cosine-5")]
    tasks = [ReferenceTask(source.model_path, wind.pressure_pa) for wind in strongest]
    paths = run_references(tasks, plan.cache_dir, lambda done: None, plan.workers)
    references = [read_reference_run(path).displacement_m[-1].astype(np.float64) for path in paths]
    height_m, figures, shown = float(metadata["height_m"]), {}, []
    for direction, wind, reference in zip(DIRECTIONS_DEG, strongest, references, strict=True):
        poses = {name: play_pressures(table, wind.pressure_pa, make)[0][-1] for name, make in METHODS.items()}
        shown.append(poses["modal"])
        figures[f"{direction:.0f}"] = {
            "sway": float(np.linalg.norm(reference, axis=1).max() / height_m),
            "hausdorff": {
                name: _hausdorff(source, source.subspace, q, reference) / height_m
                for name, q in poses.items()
            },
        }
    return Fig5(figures, references, shown)
