"""The build pipeline: from a mesh file to a table, stage by stage."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from galewood.pipeline.pictures import skeleton_png, tetrahedra_png
from galewood.pipeline.sampling import (
    Samples,
    TrajectoryRunner,
    design_wind,
    plan_samples,
    run_in_processes,
    simulate,
)
from galewood.pipeline.stages.artefacts import ArtefactPublisher, Publish
from galewood.pipeline.stages.assemble import DefaultPart
from galewood.pipeline.stages.compliance_file import compliance_file
from galewood.pipeline.stages.from_beams import beam_table
from galewood.pipeline.stages.options import FURTHER_RUNS_MESSAGE, BuildOptions, BuildResult, Progress, Stages
from galewood.pipeline.stages.report import build_report, has_leaves
from galewood.pipeline.stages.stiffness import goal_of, scaled_to
from galewood.pipeline.stages.surface import RenderMesh, render_mesh
from galewood.pipeline.stages.table_builder import TableBuilder
from galewood.solid.fem import FemModel, Simulator
from galewood.solid.model import (
    LumpedMasses,
    TreeModel,
    bind_foliage,
    build_model,
    compare_with_reference,
    in_added_wood,
)
from galewood.solid.skeleton import Skeleton, extract_skeleton, sampled_elements, with_corrected_radii
from galewood.solid.skinning import axis_of_tets, render_embedding
from galewood.solid.tets import TetMesh, cached_tetrahedra_path, tetrahedralise
from galewood.table import Records, encode, encode_records
from galewood.tree import TreeMesh, import_mesh_sandboxed
from galewood.util import Array, WorkerPool
from galewood.wood import Wood

WARM_MODULES = ("galewood.solid.model.comparison", "galewood.pipeline.sampling.runner")
"""Modules that the worker processes import during the import, so that compiled kernels load early."""
BARE_REPORT_KEYS = ("foliage", "model", "design_wind", "table", "drawn")
"""Parts of the report that differ for the tree without its leaves."""
OnTable = Callable[[BuildResult], None]
"""Receives the complete table of the default method, before the paper's records are computed; and again with
them if the table of the bare tree follows."""


@dataclass(frozen=True)
class Environment:
    """Where a build runs and whom it tells."""

    stages: Stages
    cache_dir: Path
    runner: TrajectoryRunner | None = None
    publish: Publish | None = None
    on_table: OnTable | None = None


def build_table(
    source: bytes,
    filename: str,
    options: BuildOptions,
    runner: TrajectoryRunner | None = None,
    progress: Callable[[Progress], None] = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
    publish: Publish | None = None,
    on_table: OnTable | None = None,
    on_import: Callable[[TreeMesh], None] | None = None,
) -> BuildResult:
    """Build the table of a tree mesh. Raises MeshError, and whatever ``progress`` raises (Cancelled).

    ``publish`` receives "render.glb", "beams.table", "tets-….npz" (the file in the cache), "tetrahedra.png",
    "skeleton.png", "first.table", "early.table" and "bare.table" as soon as they exist; ``on_table`` the
    complete table of the default method, before the paper's records are computed, and ``on_import`` the tree
    as soon as it is read. ``runner`` simulates the training runs, by default in worker processes on this
    machine.
    """
    on = Environment(Stages(progress), cache_dir, runner, publish, on_table)
    on.stages.enter("import")
    with _workers(runner) as pool:
        tree, render_glb = import_mesh_sandboxed(source, filename, options)
        if on_import:
            on_import(tree)
        return _build(tree, render_glb, options, on, pool)


def build_tree(
    tree: TreeMesh,
    render_glb: bytes,
    options: BuildOptions,
    progress: Callable[[Progress], None] = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
) -> BuildResult:
    """Build the table of an imported tree; otherwise like ``build_table``."""
    with _workers(None) as pool:
        return _build(tree, render_glb, options, Environment(Stages(progress), cache_dir), pool)


def model_of(source: bytes, filename: str, options: BuildOptions, cache_dir: Path) -> FemModel:
    """The finite-element model of a tree mesh, as in a build. Raises MeshError.

    The tetrahedra come from ``cache_dir`` if it has them; meshing again gives a slightly different model.
    """
    stages = Stages(lambda progress: None)
    tree, _ = import_mesh_sandboxed(source, filename, options)
    with WorkerPool(1) as pool:
        solid = _solid(tree, options, Environment(stages, cache_dir), ArtefactPublisher(pool, None))
    return _model_of(solid, options)[0]


@dataclass(frozen=True)
class Solid:
    """A tree's wood as a finite-element mesh, with what hangs on it."""

    tree: TreeMesh
    mesh: TetMesh
    skeleton: Skeleton
    lumped: LumpedMasses
    wood: Wood
    surface: RenderMesh
    points: Array
    """Vertices at which the paper's states are recorded."""

    def with_model(self, model: FemModel) -> TreeModel:
        """A model that was built from it, with what it was made from."""
        return TreeModel(self.wood, self.mesh, self.skeleton, self.lumped, model)


def _workers(runner: TrajectoryRunner | None) -> WorkerPool:
    """Worker processes: one per core, or a single one if the training runs are simulated elsewhere."""
    return WorkerPool(1 if runner else None, warm=WARM_MODULES)


def _build(
    tree: TreeMesh, render_glb: bytes, options: BuildOptions, on: Environment, pool: WorkerPool
) -> BuildResult:
    stages = on.stages
    artefacts = ArtefactPublisher(pool, on.publish)
    artefacts.publish("render.glb", lambda: render_glb)
    beams = artefacts.compute("beams.table", lambda: beam_table(tree, options, render_glb))
    solid = _solid(tree, options, on, artefacts)
    stages.enter("model")
    model, solid = _model_of(solid, options)
    wind = design_wind(Simulator(model), options.design_speed_m_s, tree.height_m, options.fem.dt_s)
    builder = TableBuilder(tree, model, wind, solid.surface, options, render_glb)
    samples = _planned(builder, solid, on)
    beams()
    artefacts.publish("first.table", lambda: encode(builder.first(samples)))
    run = on.runner or partial(run_in_processes, pool=pool)
    default = _default(builder, samples, run, artefacts, stages)
    report = partial(build_report, tree, solid.with_model(model), wind, default.table)
    result = BuildResult(
        encode(default.table),
        None,
        render_glb,
        report(None, None, stages),
        compliance=_compliance(solid, model, render_glb),
    )
    more: dict[str, Any] = {}
    if on.on_table:
        on.on_table(result)
    stages.enter("records")
    reference = _start_comparison(pool, model, solid, options.reference_frames)
    records = _records(builder, default, samples, run, stages) if options.paper else None
    compared = reference()
    if records:
        sha256 = hashlib.sha256(result.table).hexdigest()
        result = replace(result, records=encode_records(records, sha256))
    if options.bare_table and has_leaves(tree, options):
        if on.on_table and records:
            on.on_table(replace(result, report=report(records, compared, stages)))
        stages.enter("bare")
        bare = _bare_table(builder, solid, run, on)
        artefacts.publish("bare.table", lambda: bare.table)
        result = replace(result, bare_table=bare.table)
        more = {"bare_table": bare.report}
    stages.enter("done")
    return replace(result, report=report(records, compared, stages) | more)


def _compliance(solid: Solid, model: FemModel, render_glb: bytes) -> bytes | None:
    return compliance_file(model, solid.surface.embedding, hashlib.sha256(render_glb).hexdigest())


def _solid(tree: TreeMesh, options: BuildOptions, on: Environment, artefacts: ArtefactPublisher) -> Solid:
    """Mesh the wood, extract its skeleton and attach the foliage; publish pictures of both."""
    on.stages.enter("meshing")
    wood = options.wood_of(tree.species)
    mesh = tetrahedralise(tree, options.target_tets, on.cache_dir / "tets")
    kept = cached_tetrahedra_path(tree, options.target_tets, on.cache_dir / "tets")
    artefacts.publish(kept.name, kept.read_bytes)
    artefacts.draw("tetrahedra.png", tetrahedra_png, mesh)
    on.stages.enter("skeleton")
    skeleton = extract_skeleton(mesh)
    mesh = with_corrected_radii(tree, mesh, skeleton)
    elements = sampled_elements(mesh, skeleton, options.sampled_elements)
    artefacts.draw(
        "skeleton.png", skeleton_png, mesh, skeleton, elements, in_added_wood(tree, skeleton.points_m)
    )
    lumped = bind_foliage(tree, mesh, wood, leaves=options.foliage == "leaf")
    surface = render_mesh(tree, render_embedding(tree, mesh), axis_of_tets(mesh, skeleton))
    return Solid(tree, mesh, skeleton, lumped, wood, surface, mesh.tets[elements])


def _model_of(solid: Solid, options: BuildOptions) -> tuple[FemModel, Solid]:
    """The model of a tree, and the tree with the wood of that model, which may be softer or stiffer."""

    def build(wood: Wood) -> FemModel:
        return build_model(solid.mesh, solid.skeleton, wood, solid.lumped, options.fem)

    goal = goal_of(solid.tree, solid.wood, options)
    if goal is None:
        return build(solid.wood), solid
    model, wood = scaled_to(goal, solid.wood, build)
    return model, replace(solid, wood=wood)


def _planned(builder: TableBuilder, solid: Solid, on: Environment) -> Samples:
    """The runs of a tree's model, simulated or not."""
    options = builder.options
    return plan_samples(
        builder.model, builder.wind.speed_m_s, solid.points, on.cache_dir, builder.training_winds,
        frames=options.frames, all_winds=options.all_cosine_winds,
    )  # fmt: skip


def _default(
    builder: TableBuilder,
    samples: Samples,
    run: TrajectoryRunner,
    artefacts: ArtefactPublisher,
    stages: Stages,
) -> DefaultPart:
    """Simulate the training runs and fit the default method to them; publish an early table on the way."""
    stages.enter("sampling")
    early = partial(artefacts.publish, "early.table", lambda: encode(builder.early(samples)))
    simulate(samples, run, stages.report, early)
    stages.enter("table")
    further = partial(
        samples.further_runs, run, lambda share: stages.report(0.8 * share, FURTHER_RUNS_MESSAGE)
    )
    return builder.default(samples, further)


def _records(
    builder: TableBuilder, default: DefaultPart, samples: Samples, run: TrajectoryRunner, stages: Stages
) -> Records:
    """Simulate the paper's recorded runs and compute their candidate lists."""
    count = max(len(samples.paper), 1)
    run(samples.paper, lambda number: stages.report(0.6 * number / count))
    return builder.records(default, samples, lambda share: stages.report(0.6 + 0.4 * share))


@dataclass(frozen=True)
class BareTable:
    """The table of a tree without its leaves, which has no records, and what the report says of it."""

    table: bytes
    report: dict[str, Any]


def _bare_table(builder: TableBuilder, solid: Solid, run: TrajectoryRunner, on: Environment) -> BareTable:
    """Build the table of the same tree and the same vertices without its leaves."""
    options = builder.options.model_copy(update={"foliage": "bare", "paper": False})
    lumped = bind_foliage(solid.tree, solid.mesh, solid.wood, leaves=False)
    model = build_model(solid.mesh, solid.skeleton, solid.wood, lumped, options.fem)
    wind = design_wind(Simulator(model), options.design_speed_m_s, solid.tree.height_m, options.fem.dt_s)
    bare = replace(builder, model=model, wind=wind, options=options)
    samples = _planned(bare, solid, on)
    simulate(samples, run, lambda share: on.stages.report(0.7 * share), lambda: None)
    further = partial(
        samples.further_runs, run, lambda share: on.stages.report(0.7 + 0.2 * share, FURTHER_RUNS_MESSAGE)
    )
    table = bare.default(samples, further).table
    made = replace(solid, lumped=lumped).with_model(model)
    report = build_report(solid.tree, made, wind, table, None, None, on.stages)
    return BareTable(encode(table), {name: report[name] for name in BARE_REPORT_KEYS})


def _start_comparison(
    pool: WorkerPool, fast: FemModel, solid: Solid, frames: int
) -> Callable[[], dict[str, Any] | None]:
    """Start the comparison with the reference model; the returned function waits for the result.

    The result is None if ``frames`` is 0, or if the model is the reference itself.
    """
    if fast.settings.element != "fitted" or not frames:
        return lambda: None
    return pool.start(
        compare_with_reference, fast, solid.mesh, solid.skeleton, solid.wood, solid.lumped, frames
    ).result
