"""The build pipeline: from a mesh file to a table, stage by stage."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from galewood.fem import FemModel, Simulator
from galewood.mesh import TreeMesh, import_mesh_sandboxed
from galewood.model import (
    LumpedMassesLike,
    MeshLike,
    SkeletonLike,
    bind_foliage,
    build_model,
    compare_with_reference,
    render_binding,
)
from galewood.pictures import skeleton_png, tetrahedra_png
from galewood.pipeline.artefacts import ArtefactPublisher, Publish
from galewood.pipeline.options import FURTHER, BuildOptions, BuildResult, Progress, Stages
from galewood.pipeline.report import build_report, render_mesh
from galewood.pipeline.table_builder import TableBuilder
from galewood.sampling import TrajectoryRunner, design_wind, planned, run_in_processes, simulate
from galewood.skeleton import extract_skeleton, sampled_elements, with_corrected_radii
from galewood.table import encode
from galewood.tets import kept_tetrahedra, tetrahedralise
from galewood.util import WorkerPool
from galewood.wood import Wood, wood_of_species

WARM_MODULES = ("galewood.model.comparison", "galewood.sampling.runner")
"""Modules that the worker processes import during meshing, so that compiled kernels load early."""


def build_table(
    source: bytes,
    filename: str,
    options: BuildOptions,
    runner: TrajectoryRunner | None = None,
    progress: Callable[[Progress], None] = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
    publish: Publish | None = None,
) -> BuildResult:
    """Build the table of a tree mesh. Raises MeshError, and whatever ``progress`` raises (Cancelled).

    ``publish`` receives "render.glb", "tets-….npz" (the file in the cache), "tetrahedra.png", "skeleton.png"
    and "preliminary.table" as soon as they exist. ``runner`` simulates the training runs, by default in
    worker processes on this machine.
    """
    stages = Stages(progress)
    stages.enter("import")
    tree, render_glb = import_mesh_sandboxed(source, filename, options.mesh_import)
    return _build(tree, render_glb, options, stages, runner, cache_dir, publish)


def build_tree(
    tree: TreeMesh,
    render_glb: bytes,
    options: BuildOptions,
    progress: Callable[[Progress], None] = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
) -> BuildResult:
    """Build the table of an imported tree; otherwise like ``build_table``."""
    return _build(tree, render_glb, options, Stages(progress), None, cache_dir, None)


def _build(
    tree: TreeMesh,
    render_glb: bytes,
    options: BuildOptions,
    stages: Stages,
    runner: TrajectoryRunner | None,
    cache_dir: Path,
    publish: Publish | None,
) -> BuildResult:
    wood = options.wood or wood_of_species(tree.species or "default")
    with WorkerPool(1 if runner else None, warm=WARM_MODULES) as pool:
        artefacts = ArtefactPublisher(pool, publish)
        artefacts.publish("render.glb", lambda: render_glb)
        stages.enter("meshing")
        mesh = tetrahedralise(tree, options.target_tets, cache_dir / "tets")
        kept = kept_tetrahedra(tree, options.target_tets, cache_dir / "tets")
        artefacts.publish(kept.name, kept.read_bytes)
        artefacts.draw("tetrahedra.png", tetrahedra_png, mesh)
        stages.enter("skeleton")
        skeleton = extract_skeleton(mesh)
        mesh = with_corrected_radii(tree, mesh, skeleton)
        elements = sampled_elements(mesh, skeleton, options.sampled_elements)
        artefacts.draw("skeleton.png", skeleton_png, mesh, skeleton, elements)
        lumped = bind_foliage(tree, mesh, wood)
        surface = render_mesh(tree, render_binding(tree, mesh))
        stages.enter("model")
        model = build_model(mesh, skeleton, wood, lumped, options.fem)
        reference = _start_comparison(pool, model, mesh, skeleton, wood, lumped, options.reference_frames)
        wind = design_wind(Simulator(model), options.design_speed_m_s, tree.height_m, options.fem.dt_s)
        stages.enter("sampling")
        samples = planned(
            model, wind.speed_m_s, mesh.tets[elements], cache_dir, frames=options.frames, seed=options.seed
        )
        builder = TableBuilder(tree, model, wind, surface, options, render_glb)
        preliminary = partial(
            artefacts.publish, "preliminary.table", lambda: encode(builder.preliminary(samples))
        )
        run = runner or partial(run_in_processes, pool=pool)
        simulate(samples, run, stages.report, preliminary)
        stages.enter("table")
        further = partial(samples.further_runs, run, lambda share: stages.report(0.15 * share, FURTHER))
        table = builder.build(samples, stages.report, further)
        stages.enter("done")
        report = build_report(tree, mesh, skeleton, lumped, model, wind, table, reference(), stages)
        return BuildResult(encode(table), render_glb, report)


def _start_comparison(
    pool: WorkerPool,
    fast: FemModel,
    mesh: MeshLike,
    skeleton: SkeletonLike,
    wood: Wood,
    lumped: LumpedMassesLike,
    frames: int,
) -> Callable[[], dict[str, Any] | None]:
    """Start the comparison with the reference model; the returned function waits for the result.

    The result is None if ``frames`` is 0, or if the model is the reference itself.
    """
    if fast.settings.element != "fitted" or not frames:
        return lambda: None
    return pool.start(compare_with_reference, fast, mesh, skeleton, wood, lumped, frames).result
