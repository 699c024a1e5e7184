"""A tree file as a finite-element model, in leaf or bare, with its size."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from galewood.check.field.stem_section import diameter_cm
from galewood.constants import BREAST_HEIGHT_M
from galewood.formats import mesh_with_companions
from galewood.options import BuildRequest
from galewood.solid.fem import FemModel, FemSettings
from galewood.solid.model import tree_model
from galewood.tree import TreeMesh, import_mesh_sandboxed


@dataclass(frozen=True)
class SimulatedTree:
    """A tree's model and its size. ``dbh_cm`` is None if the tree is lower than 1.3 m."""

    fem: FemModel
    height_m: float
    dbh_cm: float | None
    warnings: list[str]


def mesh_of_file(path: Path, options: BuildRequest) -> TreeMesh:
    """The tree of a mesh or scan. Raises MeshError."""
    return import_mesh_sandboxed(mesh_with_companions(path), path.name, options)[0]


def tree_of_file(path: Path, options: BuildRequest, cache_dir: Path = Path("data/cache")) -> SimulatedTree:
    """The model of a mesh or scan. A bare tree is the same tree without its leaves. Raises MeshError."""
    return simulated_tree(mesh_of_file(path, options), options, cache_dir)


def simulated_tree(mesh: TreeMesh, options: BuildRequest, cache_dir: Path) -> SimulatedTree:
    """The model of a tree that was read. Raises MeshError."""
    settings = FemSettings(root_stiffness_nm_rad=options.root_stiffness_nm_rad)
    leaves = options.foliage == "leaf"
    made = tree_model(mesh, options.own_wood, options.target_tets, cache_dir, settings, leaves)
    warnings = list(mesh.report.get("warnings", []))
    if "warning" in made.fem.report["rest_pose"]:
        warnings.append(made.fem.report["rest_pose"]["warning"])
    return SimulatedTree(made.fem, mesh.height_m, dbh_cm_of(mesh), warnings)


def dbh_cm_of(mesh: TreeMesh) -> float | None:
    """Diameter at 1.3 m, cm, as scanned or as the mesh has it; None: the tree is lower."""
    scanned = mesh.report.get("qsm", {}).get("dbh_cm")
    return float(scanned) if scanned else diameter_cm(mesh.wood_vertices_m, mesh.wood_faces, BREAST_HEIGHT_M)
