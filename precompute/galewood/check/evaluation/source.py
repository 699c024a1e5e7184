"""Recovers what a table was built from: its finite-element model, its modes on the wood, its render vertices.

The table file does not contain them. The model is in the cache of the build, under the hash in the table's
provenance; the mesh is beside the table or given by the user; the modes are computed again from the training
runs of the build. Each is checked against the table.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import scipy.sparse

from galewood.options import BuildRequest, ImportRequest
from galewood.pipeline.reduction import Subspace, output_modes
from galewood.pipeline.sampling import (
    ALL_COSINES,
    COSINE_PREFIX,
    SampledRun,
    Samples,
    content_hash,
    run_in_processes,
    simulate,
)
from galewood.pipeline.stages import TrainingModel
from galewood.pipeline.tables import TableSettings, TableStage
from galewood.solid.fem import FemModel, load_model
from galewood.solid.skeleton import extract_skeleton, sampled_elements
from galewood.solid.skinning import points_embedding, render_embedding
from galewood.solid.tets import TetMesh
from galewood.table import Metadata, Table
from galewood.tree import TreeMesh, import_mesh_sandboxed
from galewood.util import Floats, Int64s, write_atomically

OnProgress = Callable[[float, str], None]
USUAL_OPTIONS = BuildRequest()
TOLD_OPTIONS = ("seed", "sampled_elements")
"""Options of a build that the metadata of its table names."""


class SourceError(ValueError):
    """The model or the mesh of a table is missing or belongs to another table."""


@dataclass(frozen=True)
class RenderedVertices:
    """The j joints that hold the render vertices."""

    binding: scipy.sparse.csr_matrix  # (j, n) weights of the joints on the tet vertices
    count: Int64s  # (j,) render vertices that each of them holds


@dataclass(frozen=True)
class Source:
    """The finite-element model of a table and the table's modes on its vertices."""

    model: FemModel
    model_path: Path
    mesh: TetMesh
    tree: TreeMesh
    binding: scipy.sparse.csr_matrix  # (v, n) weights of the render vertices on the tet vertices
    subspace: Subspace
    rendered: RenderedVertices

    @property
    def rest_m(self) -> Floats:
        """(n, 3) vertices of the wood at gravity rest, m."""
        return self.model.nodes_m[: self.model.vertex_count]


def source_of(
    table: Table,
    mesh: Path,
    cache_dir: Path,
    on_progress: OnProgress = lambda fraction, message: None,
    *,
    model: Path | None = None,
    workers: int = 2,
) -> Source:
    """Recover the source of a table from its mesh and the cache of its build.

    ``model`` is the model file if the cache lacks it. Raises SourceError if something is missing or does not
    match the table, and MeshError for an unreadable mesh.
    """
    on_progress(0.0, "Finding the model")
    metadata = table.metadata
    model_path = kept_model(model, metadata, cache_dir) if model else find_model(metadata, cache_dir)
    fem = load_model(model_path)
    tets = tets_of(fem)
    on_progress(0.1, "Reading the mesh")
    tree = read_mesh(table, mesh)
    binding = render_embedding(tree, tets)
    on_progress(0.3, "Reading the simulated runs")
    subspace = table_modes(table, fem, tets, cache_dir, workers)
    check_basis(table, tets, subspace)
    on_progress(1.0, "Done")
    return Source(fem, model_path, tets, tree, binding, subspace, _rendered(table, tets))


def _same_joints(table: Table, tree: TreeMesh) -> bool:
    """Whether the bark is near to the joints that hold it: on average by a fraction of the height."""
    positions_m = np.concatenate([primitive.positions_m for primitive in tree.primitives])
    wood = np.repeat(
        [primitive.kind == "wood" for primitive in tree.primitives],
        [len(primitive.positions_m) for primitive in tree.primitives],
    )
    arm = np.linalg.norm(positions_m - table.joint_rest_m[table.vertex_joint.astype(np.int64)], axis=1)
    return float(arm[wood].mean()) < 0.02 * float(table.metadata["height_m"])


def find_model(metadata: Metadata, cache_dir: Path) -> Path:
    """Model file of a table in the cache of its build. Raises SourceError."""
    path = cache_dir / "models" / f"{_model_sha256(metadata)}.npz"
    if path.exists():
        return path
    raise SourceError(
        f"{cache_dir} does not contain the model of this table: give the cache of its build (--cache-dir) or "
        "the model file (--model), or build the table again"
    )


def kept_model(path: Path, metadata: Metadata, cache_dir: Path) -> Path:
    """Copy a model file into the cache under its hash. Raises SourceError if it is not the table's model."""
    sha256 = content_hash(load_model(path))
    if sha256 != _model_sha256(metadata):
        raise SourceError(
            f"{path} is the model of another table: give the model of this one or build the table again"
        )
    kept = cache_dir / "models" / f"{sha256}.npz"
    if not kept.exists():
        write_atomically(kept, path.read_bytes())
    return kept


def _model_sha256(metadata: Metadata) -> str:
    sha256 = metadata["provenance"].get("model_sha256")
    if metadata["provenance"].get("stage") == TableStage.BEAMS:
        raise SourceError("this preliminary table was made from beams: evaluate the complete table instead")
    if not isinstance(sha256, str):
        raise SourceError("this table does not name its model: build it again")
    return sha256


def tets_of(model: FemModel) -> TetMesh:
    """The tetrahedra of a model as a mesh (the radius correction is already part of the stiffness)."""
    n = model.vertex_count
    tets = np.ascontiguousarray(model.elements[:, :4])
    return TetMesh(model.nodes_m[:n], tets, np.ones(len(tets)), {})


def read_mesh(table: Table, mesh: Path) -> TreeMesh:
    """Read the tree of a table. Raises SourceError for another mesh, MeshError for an unreadable one."""
    metadata, data = table.metadata, mesh.read_bytes()
    options = ImportRequest(species=metadata.get("species"), height_m=float(metadata["height_m"]))
    tree, render_glb = import_mesh_sandboxed(data, mesh.name, options)
    counts = [len(primitive.positions_m) for primitive in tree.primitives]
    if counts != [int(primitive["vertices"]) for primitive in metadata["primitives"]]:
        raise SourceError(
            f"{mesh} has different vertices from the mesh of the table: give the mesh that it was built from"
        )
    known = {hashlib.sha256(data).hexdigest(), hashlib.sha256(render_glb).hexdigest()}
    if metadata.get("mesh_sha256") not in known and not _same_joints(table, tree):
        raise SourceError(f"{mesh} is not the mesh of the table: give the mesh that it was built from")
    return tree


def samples_of(table: Table, model: FemModel, mesh: TetMesh, cache_dir: Path, workers: int = 2) -> Samples:
    """The runs that a table was built from; those of the default method are simulated if they are missing."""
    return _simulated(table, _training_model(table, model, mesh), cache_dir, workers)


def _training_model(table: Table, model: FemModel, mesh: TetMesh) -> TrainingModel:
    elements = sampled_elements(mesh, extract_skeleton(mesh), options_of(table).sampled_elements)
    return TrainingModel(model, float(table.metadata["height_m"]), mesh.tets[elements])


def _simulated(table: Table, model: TrainingModel, cache_dir: Path, workers: int) -> Samples:
    """The runs of a table; those that it was fitted to exist."""
    samples = model.plan(float(table.metadata["design_speed_m_s"]), options_of(table), cache_dir)
    run = partial(run_in_processes, workers=workers)
    simulate(stage_of(table).samples(samples), run, lambda done: None, lambda: None)
    return samples


def options_of(table: Table) -> BuildRequest:
    """The options of a table's build that determine its runs; what the table does not tell is the default."""
    provenance = table.metadata["provenance"]
    paper = table.paper.metadata if table.paper else provenance
    by_name = zip(paper["winds"], paper["frames"], strict=True)
    cosines = [int(count) for name, count in by_name if name.startswith(COSINE_PREFIX)]
    known = {name: int(value) for name, value in {**provenance, **paper}.items() if name in TOLD_OPTIONS}
    frames = {"frames": cosines[0]} if cosines else {}
    return USUAL_OPTIONS.model_copy(
        update={**known, **frames, "all_cosine_winds": len(cosines) == ALL_COSINES}
    )


def stage_of(table: Table) -> TableStage:
    """How complete a table is. Raises SourceError for a stage that no build makes."""
    name = table.metadata["provenance"].get("stage", TableStage.COMPLETE)
    try:
        return TableStage(name)
    except ValueError:
        raise SourceError(f"this table has an unknown stage, {name!r}: build it again") from None


def recorded_runs(samples: Samples, workers: int = 2) -> list[SampledRun]:
    """The runs of the paper's records, simulated now if they are missing."""
    run_in_processes(samples.paper, lambda done: None, workers)
    return samples.paper_runs()


def table_modes(table: Table, model: FemModel, mesh: TetMesh, cache_dir: Path, workers: int) -> Subspace:
    """The table's modes on the vertices of the wood, computed as in the build. Raises SourceError."""
    own = _training_model(table, model, mesh)
    samples = stage_of(table).samples(_simulated(table, own, cache_dir, workers))
    settings = TableSettings(**table.metadata["provenance"]["table_settings"])
    training = own.training(samples.default_runs(), settings.modes)
    return output_modes(training, own.mass_kg)[1]


def _rendered(table: Table, mesh: TetMesh) -> RenderedVertices:
    joint = table.vertex_joint.astype(np.int64)
    count = np.bincount(joint, minlength=len(table.joint_share)).astype(np.int64)
    return RenderedVertices(points_embedding(table.joint_rest_m, mesh), count)


def check_basis(table: Table, mesh: TetMesh, subspace: Subspace) -> None:
    """Raise SourceError unless the nodes move as the modes do where the nodes are."""
    nodes = points_embedding(table.node_rest_m, mesh)
    n, _, r = subspace.basis.shape
    if r != table.modes:
        raise SourceError(
            "the modes computed from the simulated runs are not those of the table: build the table again"
        )
    rows = np.asarray(nodes @ subspace.basis.reshape(n, 3 * r))
    gap = np.abs(rows - table.node_basis.reshape(len(rows), -1)).max()
    if gap > 2e-3:
        raise SourceError(
            f"the computed modes differ from those of the table by {gap:.1g}: build the table again"
        )
