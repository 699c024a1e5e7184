"""The build pipeline: from a mesh file to a table, stage by stage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from galewood.pipeline.results import BuildResult
from galewood.pipeline.sampling import TrajectoryRunner, run_in_processes
from galewood.pipeline.stages.after_table import (
    BareTable,
    RecordedTree,
    build_bare_table,
    compute_records,
    wants_bare_table,
)
from galewood.pipeline.stages.artefacts import ArtefactPublisher, Publish
from galewood.pipeline.stages.context import BuildContext, OnImport, OnTable, runs_as
from galewood.pipeline.stages.motion import build_fem, fem_of, fit_table, simulate_runs
from galewood.pipeline.stages.solid import ImportedTree, MeshFile, attach_foliage, import_tree, mesh_wood
from galewood.pipeline.stages.stage import Progress, Stage, StageProgress
from galewood.pipeline.tables import BuildOptions
from galewood.solid.fem import FemModel
from galewood.threads import single_threaded
from galewood.tree import TreeMesh
from galewood.util import WorkerPool
from galewood.wood import Wood

WARM_MODULES = ("galewood.solid.model.comparison", "galewood.pipeline.sampling.runner")
"""Modules that the worker processes import when they start, so that compiled kernels load early."""
OnProgress = Callable[[Progress], None]


@single_threaded
def build_table(
    source: bytes | ImportedTree,
    filename: str,
    options: BuildOptions,
    runner: TrajectoryRunner | None = None,
    progress: OnProgress = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
    publish: Publish | None = None,
    on_table: OnTable = lambda result: None,
    on_import: OnImport = lambda tree: None,
) -> BuildResult:
    """Build the table of a tree mesh. Raises MeshError, and whatever ``progress`` raises (Cancelled).

    ``source`` is the file, or the tree that it was read as with these options.
    ``publish`` receives "render.glb", "beams.table", "tets-….npz" (the file in the cache), "tetrahedra.png",
    "skeleton.png" and "bare.table" as soon as they exist; ``on_table`` the complete table of
    the default method, before the paper's records are computed, and ``on_import`` the tree as soon as it is
    read. ``runner`` simulates the training runs, by default in worker processes on this machine.
    """
    with _workers(runner) as pool:
        context = BuildContext(
            options,
            StageProgress(progress),
            cache_dir,
            pool,
            runner or partial(run_in_processes, pool=pool),
            ArtefactPublisher(pool, publish),
            on_import,
            on_table,
        )
        return _build(import_tree(MeshFile(source, filename), context), context)


@single_threaded
def build_tree(
    tree: TreeMesh,
    render_glb: bytes,
    options: BuildOptions,
    progress: OnProgress = lambda progress: None,
    cache_dir: Path = Path("data/cache"),
) -> BuildResult:
    """Build the table of an imported tree; otherwise like ``build_table``."""
    with _workers(None) as pool:
        return _build(ImportedTree(tree, render_glb), _quiet(options, cache_dir, pool, progress))


@single_threaded
def model_of(
    source: bytes, filename: str, options: BuildOptions, cache_dir: Path, wood: Wood | None = None
) -> FemModel:
    """The finite-element model of a tree mesh, as in a build, or of a given wood. Raises MeshError.

    The tetrahedra come from ``cache_dir`` if it has them; meshing again gives a slightly different model.
    """
    with WorkerPool(1) as pool:
        context = _quiet(options, cache_dir, pool)
        imported = import_tree(MeshFile(source, filename), context)
        solid = attach_foliage(mesh_wood(imported, context), context)
    return fem_of(solid if wood is None else replace(solid, wood=wood), options)[0]


def _workers(runner: TrajectoryRunner | None) -> WorkerPool:
    """Worker processes: one per core, or a single one if the training runs are simulated elsewhere."""
    return WorkerPool(1) if runner else WorkerPool(warm=WARM_MODULES)


def _quiet(
    options: BuildOptions, cache_dir: Path, pool: WorkerPool, progress: OnProgress = lambda progress: None
) -> BuildContext:
    """The context of a build that publishes nothing on the way."""
    return BuildContext(
        options,
        StageProgress(progress),
        cache_dir,
        pool,
        partial(run_in_processes, pool=pool),
        ArtefactPublisher(pool, None),
        lambda tree: None,
        lambda result: None,
    )


def _build(imported: ImportedTree, context: BuildContext) -> BuildResult:
    """All stages after the import."""
    meshed = mesh_wood(imported, context)
    solid = attach_foliage(meshed, context)
    modelled = build_fem(solid, context)
    simulated = simulate_runs(modelled, context)
    fitted = fit_table(simulated, context)
    recorded = compute_records(fitted, context)
    bare = build_bare_table(recorded, context) if wants_bare_table(recorded, context) else None
    return collect(Tables(recorded, bare), context)


@dataclass(frozen=True)
class Tables:
    """All that was computed of a tree."""

    recorded: RecordedTree
    bare: BareTable | None
    """None: not wanted, or no leaves."""


@runs_as(Stage.DONE)
def collect(tables: Tables, context: BuildContext) -> BuildResult:
    """The result of a build."""
    result = tables.recorded.result(context)
    if tables.bare is None:
        return result
    report = result.report | {"bare_table": tables.bare.report}
    return replace(result, bare_table=tables.bare.table, report=report)
