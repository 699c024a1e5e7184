"""Recovers what a table was built from: its modes on the wood and its render vertices, besides its model.

The table file does not contain them. The mesh is beside the table or given by the user; the modes are
computed again from the training runs of the build. Each is checked against the table.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import scipy.sparse

from galewood.check.evaluation.model_file import ModelSource, SourceError, model_file, options_of
from galewood.options import ImportRequest
from galewood.pipeline.reduction import Subspace, output_modes
from galewood.pipeline.sampling import (
    SampledRun,
    Samples,
    run_in_processes,
    simulate,
)
from galewood.pipeline.stages import TrainingModel
from galewood.pipeline.tables import TableSettings
from galewood.solid.fem import FemModel
from galewood.solid.skeleton import extract_skeleton, sampled_elements
from galewood.solid.skinning import points_embedding, render_embedding
from galewood.solid.tets import TetMesh
from galewood.table import Table
from galewood.tree import TreeMesh, import_mesh_sandboxed
from galewood.util import Floats, Int64s

OnProgress = Callable[[float, str], None]


@dataclass(frozen=True)
class RenderedVertices:
    """The j joints that hold the render vertices."""

    binding: scipy.sparse.csr_matrix  # (j, n) weights of the joints on the tet vertices
    count: Int64s  # (j,) render vertices that each of them holds


@dataclass(frozen=True)
class Source(ModelSource):
    """The finite-element model of a table and the table's modes on its vertices."""

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

    ``model`` is the model file if the cache lacks it; without both it is built again. Raises SourceError if
    something is missing or does not match the table, and MeshError for an unreadable mesh.
    """
    on_progress(0.0, "Finding the model")
    own = model_file(table, mesh, cache_dir, model)
    on_progress(0.1, "Reading the mesh")
    tree = read_mesh(table, mesh)
    binding = render_embedding(tree, own.mesh)
    on_progress(0.3, "Reading the simulated runs")
    subspace = table_modes(table, own.model, own.mesh, cache_dir, workers)
    check_basis(table, own.mesh, subspace)
    on_progress(1.0, "Done")
    rendered = _rendered(table, own.mesh)
    return Source(own.model, own.model_path, own.mesh, tree, binding, subspace, rendered)


def _same_joints(table: Table, tree: TreeMesh) -> bool:
    """Whether the bark is near to the joints that hold it: on average by a fraction of the height."""
    positions_m = np.concatenate([primitive.positions_m for primitive in tree.primitives])
    wood = np.repeat(
        [primitive.kind == "wood" for primitive in tree.primitives],
        [len(primitive.positions_m) for primitive in tree.primitives],
    )
    arm = np.linalg.norm(positions_m - table.joint_rest_m[table.vertex_joint.astype(np.int64)], axis=1)
    return float(arm[wood].mean()) < 0.02 * float(table.metadata["height_m"])


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
    """The runs of a table; those of the default method exist."""
    samples = model.plan(float(table.metadata["design_speed_m_s"]), options_of(table), cache_dir)
    run = partial(run_in_processes, workers=workers)
    simulate(samples, run, lambda done: None)
    return samples


def recorded_runs(samples: Samples, workers: int = 2) -> list[SampledRun]:
    """The runs of the paper's records, simulated now if they are missing."""
    run_in_processes(samples.paper, lambda done: None, workers)
    return samples.paper_runs()


def table_modes(table: Table, model: FemModel, mesh: TetMesh, cache_dir: Path, workers: int) -> Subspace:
    """The table's modes on the vertices of the wood, computed as in the build. Raises SourceError."""
    own = _training_model(table, model, mesh)
    samples = _simulated(table, own, cache_dir, workers)
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
