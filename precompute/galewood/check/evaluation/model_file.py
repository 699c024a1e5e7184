"""Finds the finite-element model that a table was built from, or builds it again.

The table file does not contain it. It is in the cache of the build, under the hash in the table's provenance.
Where a table came without that cache, such as those distributed with the software, the model is built again
from the mesh and the tetrahedra. Rounding differs between builds, so that such a model has another hash; it
is taken for the same if its first frequencies agree.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from galewood.options import BuildRequest
from galewood.pipeline.sampling import ALL_COSINES, COSINE_PREFIX, content_hash
from galewood.pipeline.stages import model_of
from galewood.pipeline.tables import BuildOptions, TableStage
from galewood.solid.fem import FemModel, load_model, save_model
from galewood.solid.tets import TetMesh
from galewood.table import Metadata, Table
from galewood.util import write_atomically
from galewood.wood import Wood, wood_of_species

USUAL_OPTIONS = BuildRequest()
TOLD_OPTIONS = ("seed", "sampled_elements", "target_tets")
"""Options of a build that the metadata of its table names."""
SAME_FREQUENCIES = 5e-4
"""Largest relative deviation of the first frequencies of two builds of one model.

The fit of the linear elements to quadratic ones enlarges rounding: from the same tetrahedra, two processors
give built-in trees whose frequencies deviate by up to 5e-5. Meshed again, they deviate by 1e-2.
"""


class SourceError(ValueError):
    """The model or the mesh of a table is missing or belongs to another table."""


@dataclass(frozen=True)
class ModelSource:
    """The finite-element model of a table."""

    model: FemModel
    model_path: Path
    mesh: TetMesh


def model_file(table: Table, mesh: Path, cache_dir: Path, given: Path | None = None) -> ModelSource:
    """The model of a table: a given file, that in the cache of its build, or one built again from ``mesh``.

    Raises SourceError if it is not that of the table, and MeshError for an unreadable mesh.
    """
    metadata = table.metadata
    path = kept_model(given, metadata, cache_dir) if given else find_model(metadata, cache_dir)
    path = path or built_again(table, mesh, cache_dir)
    model = load_model(path)
    return ModelSource(model, path, tets_of(model))


def find_model(metadata: Metadata, cache_dir: Path) -> Path | None:
    """Model file of a table in the cache of its build, or the one that was built again; None: neither."""
    sha256 = _model_sha256(metadata)
    path, note = cache_dir / "models" / f"{sha256}.npz", _note(sha256, cache_dir)
    if not path.exists() and note.exists():
        path = path.with_name(note.read_text(encoding="utf-8"))
    return path if path.exists() else None


def kept_model(path: Path, metadata: Metadata, cache_dir: Path) -> Path:
    """Copy a model file into the cache under its hash. Raises SourceError if it is not the table's model."""
    model = load_model(path)
    check_model(model, metadata, str(path))
    kept = cache_dir / "models" / f"{content_hash(model)}.npz"
    if not kept.exists():
        write_atomically(kept, path.read_bytes())
    return kept


def built_again(table: Table, mesh: Path, cache_dir: Path) -> Path:
    """Build the model of a table again, from its mesh and the tetrahedra in the cache, and keep it there.

    Raises SourceError if it is not the table's model: then it had other options or tetrahedra.
    """
    wood = wood_of_table(table)
    model = model_of(mesh.read_bytes(), mesh.name, model_options(table), cache_dir, wood)
    check_model(model, table.metadata, f"the model built again from {mesh}")
    path = cache_dir / "models" / f"{content_hash(model)}.npz"
    save_model(model, path)
    write_atomically(_note(_model_sha256(table.metadata), cache_dir), path.name.encode())
    return path


def check_model(model: FemModel, metadata: Metadata, name: str) -> None:
    """Raise SourceError unless a model is that of a table.

    It has the same hash, or the same wood, exponent of the wind, tetrahedra and first frequencies.
    """
    if content_hash(model) == _model_sha256(metadata):
        return
    own, found = (np.array(hz) for hz in (metadata["frequencies_hz"], model.report["frequencies_hz"]))
    hint = "Give the cache of its build (--cache-dir) or its model file (--model), or build the table again"
    if len(own) != len(found) or len(model.elements) != metadata["provenance"]["tetrahedra"]:
        raise SourceError(f"{name} is not the model of this table: it has other tetrahedra. {hint}")
    same_air = model.streamlined_exponent == metadata["streamlined_exponent"]
    if not same_air or model.report["wood"] != metadata["provenance"]["wood"]:  # frequencies do not show it
        raise SourceError(f"{name} is not the model of this table: it has another wood or foliage. {hint}")
    worst = float(np.abs(found / own - 1.0).max())
    if not worst <= SAME_FREQUENCIES:
        raise SourceError(
            f"{name} is not the model of this table: its first frequencies deviate by {worst:.1g} "
            f"(limit {SAME_FREQUENCIES:g}). {hint}"
        )


def model_options(table: Table) -> BuildOptions:
    """The options that a table's model was built with; what the table does not tell is the default."""
    metadata, fem = table.metadata, table.metadata["provenance"]["fem"]
    stiffness_nm_rad = fem.get("root_stiffness_nm_rad")
    return BuildOptions(
        species=metadata.get("species"),
        height_m=float(metadata["height_m"]),
        stiffness="as drawn",
        foliage=table.foliage,
        target_tets=options_of(table).target_tets,
        root_stiffness_knm=None if stiffness_nm_rad is None else stiffness_nm_rad / 1000,
        reference=fem.get("element") == "quadratic",
    )


def wood_of_table(table: Table) -> Wood:
    """The wood of a table's model: that of its species, as stiff as the table tells."""
    wood = wood_of_species(table.metadata.get("species") or "default")
    young_pa = table.metadata["provenance"].get("young_longitudinal_pa", wood.young_longitudinal_pa)
    return wood.scaled(float(young_pa) / wood.young_longitudinal_pa)


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


def tets_of(model: FemModel) -> TetMesh:
    """The tetrahedra of a model as a mesh (the radius correction is already part of the stiffness)."""
    n = model.vertex_count
    tets = np.ascontiguousarray(model.elements[:, :4])
    return TetMesh(model.nodes_m[:n], tets, np.ones(len(tets)), {})


def _note(model_sha256: str, cache_dir: Path) -> Path:
    """The file that names the model which was built again for a table."""
    return cache_dir / "models" / f"{model_sha256}.rebuilt"


def _model_sha256(metadata: Metadata) -> str:
    sha256 = metadata["provenance"].get("model_sha256")
    if metadata["provenance"].get("stage") == TableStage.BEAMS:
        raise SourceError("this preliminary table was made from beams: evaluate the complete table instead")
    if not isinstance(sha256, str):
        raise SourceError("this table does not name its model: build it again")
    return sha256
