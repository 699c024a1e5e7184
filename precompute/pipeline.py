"""From a mesh file to a table: every stage by its name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

from precompute.build_types import FURTHER, BuildOptions, BuildResult, Progress, Stages
from precompute.cancelled import Cancelled
from precompute.design_wind import design_wind
from precompute.drawn_wood import as_drawn
from precompute.dynamics import Simulator, build_model
from precompute.foliage import bind_foliage, render_binding
from precompute.gallery import Gallery, Publish
from precompute.helpers import Helpers
from precompute.intake_process import run_intake
from precompute.pictures import skeleton_png, tetrahedra_png
from precompute.pipeline_report import build_report, render_mesh
from precompute.reference_check import start_comparison
from precompute.runner import TrajectoryRunner, run_in_processes
from precompute.samples import planned, simulate
from precompute.skeleton import extract_skeleton, sampled_elements
from precompute.table import encode
from precompute.table_maker import TableMaker
from precompute.tetrahedra import kept_tetrahedra, tetrahedralise
from precompute.wood import species

__all__ = ["BuildOptions", "BuildResult", "Cancelled", "Progress", "TrajectoryRunner", "build_table"]


def build_table(
    source: bytes,
    filename: str,
    options: BuildOptions,
    runner: TrajectoryRunner | None = None,
    progress: Callable[[Progress], None] = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
    publish: Publish | None = None,
) -> BuildResult:
    """The table of a tree mesh. Raises IntakeError, and whatever ``progress`` raises (Cancelled).

    ``publish`` is handed "render.glb", "tets-….npz" (as kept in the cache), "tetrahedra.png", "skeleton.png"
    and "early.table" as soon as they exist. ``runner`` simulates the winds; without one, processes of this
    machine do.
    """
    stages = Stages(progress)
    stages.enter("intake")
    tree, render_glb = run_intake(source, filename, options.intake)
    wood = options.wood or species(tree.species or "default")
    with Helpers(1 if runner else None) as helpers:
        gallery = Gallery(helpers, publish)
        gallery.hand_out("render.glb", lambda: render_glb)
        stages.enter("meshing")
        mesh = tetrahedralise(tree, options.target_tets, cache_dir / "tets")
        kept = kept_tetrahedra(tree, options.target_tets, cache_dir / "tets")
        gallery.hand_out(kept.name, kept.read_bytes)
        gallery.draw("tetrahedra.png", tetrahedra_png, mesh)
        stages.enter("skeleton")
        skeleton = extract_skeleton(mesh)
        mesh = as_drawn(tree, mesh, skeleton)
        elements = sampled_elements(mesh, skeleton, options.sampled_elements)
        gallery.draw("skeleton.png", skeleton_png, mesh, skeleton, elements)
        lumps = bind_foliage(tree, mesh, wood)
        surface = render_mesh(tree, render_binding(tree, mesh))
        stages.enter("model")
        model = build_model(mesh, skeleton, wood, lumps, replace(options.fem, reference_frames=0))
        reference = start_comparison(helpers, model, mesh, skeleton, wood, lumps, options.fem)
        wind = design_wind(Simulator(model), options.design_speed_m_s, tree.height_m, options.fem.dt_s)
        stages.enter("sampling")
        samples = planned(model, wind.speed_m_s, mesh.tets[elements], options, cache_dir)
        maker = TableMaker(tree, model, wind, surface, options, render_glb)
        early = partial(gallery.hand_out, "early.table", lambda: encode(maker.early(samples)))
        run = runner or partial(run_in_processes, helpers=helpers)
        simulate(samples, run, stages.tick, early)
        stages.enter("table")
        further = partial(samples.further_runs, run, lambda share: stages.tick(0.15 * share, FURTHER))
        table = maker.make(samples, stages.tick, further)
        stages.enter("done")
        report = build_report(tree, mesh, skeleton, lumps, model, wind, table, reference(), stages)
        return BuildResult(encode(table), render_glb, report)
