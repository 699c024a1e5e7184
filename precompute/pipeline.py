"""From a mesh file to a table: every stage by its name."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from precompute.build_types import BuildOptions, BuildResult, Cancelled, Progress, Stages
from precompute.design_wind import design_wind
from precompute.drawn_wood import as_drawn
from precompute.dynamics import Simulator, build_model
from precompute.foliage import bind_foliage, render_binding
from precompute.intake_process import run_intake
from precompute.pipeline_report import build_report, describe, render_mesh
from precompute.runner import TrajectoryRunner, run_in_processes, sample_tasks
from precompute.sampling import read_trajectory, sample_winds
from precompute.skeleton import extract_skeleton, sampled_elements
from precompute.table import encode
from precompute.tabulate import Learning, assemble_table
from precompute.tangent_modes import oscillators_of
from precompute.tangent_winds import training_winds
from precompute.tetrahedra import tetrahedralise
from precompute.wood import species

__all__ = ["BuildOptions", "BuildResult", "Cancelled", "Progress", "TrajectoryRunner", "build_table"]


def build_table(
    source: bytes,
    filename: str,
    options: BuildOptions,
    runner: TrajectoryRunner = run_in_processes,
    progress: Callable[[Progress], None] = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
) -> BuildResult:
    """The table of a tree mesh. Raises IntakeError, and whatever ``progress`` raises (Cancelled)."""
    stages = Stages(progress)
    stages.enter("intake")
    tree, render_glb = run_intake(source, filename, options.intake)
    wood = species(tree.species or "default")
    stages.enter("meshing")
    mesh = tetrahedralise(tree, options.target_tets, cache_dir / "tets")
    stages.enter("skeleton")
    skeleton = extract_skeleton(mesh)
    mesh = as_drawn(tree, mesh, skeleton)
    lumps = bind_foliage(tree, mesh, wood)
    binding = render_mesh(tree, render_binding(tree, mesh))
    points = mesh.tets[sampled_elements(mesh, skeleton, options.sampled_elements)]
    stages.enter("model")
    model = build_model(mesh, skeleton, wood, lumps, options.fem)
    wind = design_wind(Simulator(model), options.design_speed_m_s, tree.height_m, options.fem.dt_s)
    stages.enter("sampling")
    winds = sample_winds(wind.speed_m_s, options.fem.dt_s, options.frames)
    more = training_winds(wind.speed_m_s, options.fem.dt_s)
    tasks = sample_tasks(model, [*winds, *more], points, cache_dir)
    paths = runner(tasks, lambda count: stages.tick(count / len(tasks)))
    stages.enter("reducing")
    runs = [read_trajectory(path) for path in paths]
    learnt = [run for run, wind in zip(runs, [*winds, *more], strict=True) if not wind.fade_frames]
    learning = Learning(oscillators_of(model), options.fem, learnt)
    stages.enter("table")
    description = describe(tree, model, wind, [*winds, *more], options, render_glb)
    mass_kg = model.mass_kg[: model.vertex_count]
    paper = runs[: len(winds)]
    table = assemble_table(paper, mass_kg, binding, description, options.table, learning, stages.tick)
    stages.enter("done")
    report = build_report(tree, mesh, skeleton, lumps, model, wind, table, stages)
    return BuildResult(encode(table), render_glb, report)
