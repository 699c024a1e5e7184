"""What a table was built from: its finite-element model, its modes on the wood, its rendered vertices.

The table file does not hold them. The model is in the build's cache under the hash that the table's
provenance names, the mesh is beside the table or where the user says, and the modes follow from the same
training runs as in the build. Each of them is checked against the table.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse

from galewood.fem import FemModel, load_model
from galewood.mesh import ImportOptions, TreeMesh, import_mesh_sandboxed
from galewood.model import render_binding
from galewood.pipeline import BuildOptions, TableSettings
from galewood.reduction import ModalTraining, Subspace, oscillators_of, render_basis, size_of, sizes_for
from galewood.reduction import shown_modes as reduction_modes
from galewood.sampling import Samples, content_hash, planned, run_in_processes, simulate
from galewood.skeleton import extract_skeleton, sampled_elements
from galewood.table import Metadata, Table
from galewood.tets import TetMesh
from galewood.util import Floats, Int64s, write_whole

OnProgress = Callable[[float, str], None]


class SourceError(ValueError):
    """The model or the mesh of a table is not to be found, or is not the table's."""


@dataclass(frozen=True)
class RenderedVertices:
    """The render vertices, those that move alike taken once: s distinct ones stand for v."""

    binding: scipy.sparse.csr_matrix  # (s, n) on the tet vertices
    node: Int64s  # (s,)
    count: Int64s  # (s,) render vertices that each stands for


@dataclass(frozen=True)
class Source:
    """The finite-element model of a table and the table's modes on it."""

    model: FemModel
    model_path: Path
    mesh: TetMesh
    tree: TreeMesh
    binding: scipy.sparse.csr_matrix  # (v, n) render vertices on the wood's
    subspace: Subspace
    rendered: RenderedVertices

    @property
    def rest_m(self) -> Floats:
        """(n, 3) the wood's vertices at gravity rest."""
        n = self.model.vertex_count
        return self.model.nodes_m[:n] + self.model.u_rest[:n]


def source_of(
    table: Table,
    mesh: Path,
    cache_dir: Path,
    on_progress: OnProgress = lambda fraction, message: None,
    *,
    model: Path | None = None,
    workers: int = 2,
) -> Source:
    """Find everything again. Raises SourceError with what to do, MeshError for a mesh that cannot be
    read.
    """
    on_progress(0.0, "Finding the model")
    metadata = table.metadata
    model_path = kept_model(model, metadata, cache_dir) if model else find_model(metadata, cache_dir)
    fem = load_model(model_path)
    tets = tets_of(fem)
    on_progress(0.1, "Reading the mesh")
    tree = read_mesh(table, mesh)
    binding = render_binding(tree, tets)
    on_progress(0.3, "Reading the sampled motion")
    subspace = shown_modes(table, fem, tets, cache_dir, workers)
    check_basis(table, binding, subspace)
    on_progress(1.0, "Found the model")
    rendered = distinct(binding, table.vertex_node.astype(np.int64))
    return Source(fem, model_path, tets, tree, binding, subspace, rendered)


def find_model(metadata: Metadata, cache_dir: Path) -> Path:
    """The table's model in the cache of its build. Raises SourceError."""
    path = cache_dir / "models" / f"{_model_sha256(metadata)}.npz"
    if path.exists():
        return path
    raise SourceError(
        f"{cache_dir} does not hold this table's model: name the folder it was built with (--cache-dir), "
        "the model's own file (--model), or build the table again"
    )


def kept_model(path: Path, metadata: Metadata, cache_dir: Path) -> Path:
    """The model in a file, put into the cache under its hash; SourceError if it is another table's."""
    sha256 = content_hash(load_model(path))
    if sha256 != _model_sha256(metadata):
        raise SourceError(f"{path} is the model of another table")
    kept = cache_dir / "models" / f"{sha256}.npz"
    if not kept.exists():
        write_whole(kept, path.read_bytes())
    return kept


def _model_sha256(metadata: Metadata) -> str:
    sha256 = metadata["provenance"].get("model_sha256")
    if not isinstance(sha256, str):
        raise SourceError(
            "this table was built by an older version, which did not note its model: build it again"
        )
    return sha256


def tets_of(model: FemModel) -> TetMesh:
    """The tetrahedra of a model as a mesh again (what it was thickened by has gone into the stiffness)."""
    n = model.vertex_count
    tets = np.ascontiguousarray(model.elements[:, :4])
    return TetMesh(model.nodes_m[:n], tets, np.ones(len(tets)), {})


def read_mesh(table: Table, mesh: Path) -> TreeMesh:
    """The tree in a mesh file, which must have the table's render vertices."""
    metadata, data = table.metadata, mesh.read_bytes()
    options = ImportOptions(species=metadata.get("species"), height_m=float(metadata["height_m"]))
    tree, render_glb = import_mesh_sandboxed(data, mesh.name, options)
    counts = [len(primitive.positions_m) for primitive in tree.primitives]
    if counts != [int(primitive["vertices"]) for primitive in metadata["primitives"]]:
        raise SourceError(f"{mesh} has other vertices than the mesh of the table")
    known = {hashlib.sha256(data).hexdigest(), hashlib.sha256(render_glb).hexdigest()}
    if metadata.get("mesh_sha256") not in known and not _same_nodes(table, tree):
        raise SourceError(f"{mesh} is not the mesh of the table")
    return tree


def _same_nodes(table: Table, tree: TreeMesh) -> bool:
    """Whether every node rests in the middle of its vertices."""
    positions = np.concatenate([primitive.positions_m for primitive in tree.primitives])
    label = table.vertex_node.astype(np.int64)
    total = np.zeros((len(table.node_rest_m), 3))
    np.add.at(total, label, positions)
    middle = total / np.maximum(np.bincount(label, minlength=len(total)), 1)[:, None]
    return bool(np.abs(middle - table.node_rest_m).max() < 1e-3 * float(table.metadata["height_m"]))


def samples_of(table: Table, model: FemModel, mesh: TetMesh, cache_dir: Path, workers: int = 2) -> Samples:
    """The runs that a table was made from, in the cache or simulated again."""
    provenance = table.metadata["provenance"]
    by_name = zip(provenance["winds"], provenance["frames"], strict=True)
    frames = next((count for name, count in by_name if name.startswith("cosine")), BuildOptions.frames)
    elements = sampled_elements(mesh, extract_skeleton(mesh), int(table.metadata["sampled_elements"]))
    speed_m_s = float(table.metadata["design_speed_m_s"])
    samples = planned(
        model, speed_m_s, mesh.tets[elements], cache_dir,
        frames=int(frames), seed=int(provenance.get("seed", BuildOptions.seed)),
    )  # fmt: skip
    simulate(samples, partial(run_in_processes, workers=workers), lambda done: None, lambda: None)
    return samples


def shown_modes(table: Table, model: FemModel, mesh: TetMesh, cache_dir: Path, workers: int) -> Subspace:
    """The table's modes on the wood's vertices, fitted as the build fits them."""
    samples = samples_of(table, model, mesh, cache_dir, workers)
    settings = TableSettings(**table.metadata["provenance"]["table_settings"])
    training = ModalTraining(
        oscillators_of(model), model.settings, samples.training_runs(), sizes_for(settings.modes)
    )
    tolerance_m = settings.truncation_share * float(table.metadata["height_m"])
    mass_kg = model.mass_kg[: model.vertex_count]
    try:
        size = size_of(training, len(table.modal_step))
    except ValueError as error:
        raise SourceError(str(error)) from error
    return reduction_modes(samples.recorded_runs(), mass_kg, tolerance_m, training, size)[1]


def check_basis(table: Table, binding: Any, subspace: Subspace) -> None:
    """A node's row of the basis is the mean of its vertices' rows, or these modes are not the table's."""
    rows = render_basis(binding, subspace.basis).reshape(len(table.vertex_node), -1)
    if rows.shape[1] != table.node_basis[0].size:
        raise SourceError("the modes of the sampled motion are not the table's: build the table again")
    label = table.vertex_node.astype(np.int64)
    count = np.bincount(label, minlength=len(table.node_basis))
    entries = (np.ones(len(label)), (label, np.arange(len(label))))
    gather = scipy.sparse.csr_matrix(entries, shape=(len(count), len(label)))
    mean = np.asarray(gather @ rows) / np.maximum(count, 1)[:, None]
    gap = np.abs(mean - table.node_basis.reshape(len(count), -1))[count > 0].max()
    if gap > 2e-3:
        raise SourceError(f"the modes differ from the table's by {gap:.1g}: build the table again")


def distinct(binding: Any, node: Int64s) -> RenderedVertices:
    """Render vertices that hang alike and have the same node, once each."""
    matrix = scipy.sparse.csr_matrix(binding)
    matrix.sort_indices()
    keys: dict[bytes, int] = {}
    first: list[int] = []
    count: list[int] = []
    bounds: list[int] = np.asarray(matrix.indptr).tolist()
    for v in range(len(node)):
        row = slice(bounds[v], bounds[v + 1])
        key = matrix.indices[row].tobytes() + np.round(matrix.data[row], 6).tobytes() + node[v].tobytes()
        at = keys.setdefault(key, len(first))
        if at == len(first):
            first.append(v)
            count.append(0)
        count[at] += 1
    chosen = np.array(first, np.int64)
    return RenderedVertices(scipy.sparse.csr_matrix(matrix[chosen]), node[chosen], np.array(count, np.int64))
