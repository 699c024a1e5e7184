"""A tree file as a finite-element model, in leaf or bare, with its size."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from galewood.constants import BREAST_HEIGHT_M
from galewood.formats import mesh_with_companions
from galewood.options import BuildRequest
from galewood.solid.fem import FemModel, FemSettings
from galewood.solid.model import tree_model
from galewood.tree import TreeMesh, import_mesh_sandboxed
from galewood.util import Floats, Ints


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


def diameter_cm(vertices_m: Floats, faces: Ints, height_m: float) -> float | None:
    """Diameter of the circle with the area of the wood's section at a height, cm; None: no wood there.

    The area is summed over the segments in which the faces cut the plane (Green's theorem).
    """
    corner = vertices_m[faces]
    above = corner[:, :, 1] > height_m
    cut = corner[above.any(axis=1) & ~above.all(axis=1)]
    if not len(cut):
        return None
    high = cut[:, :, 1] > height_m
    # Turn each face so that its single corner on one side comes first.
    lone = np.where(high.sum(axis=1) == 1, high.argmax(axis=1), (~high).argmax(axis=1))
    cut = np.take_along_axis(cut, ((lone[:, None] + np.arange(3)) % 3)[:, :, None], axis=1)
    ends: list[Floats] = []
    for other in (1, 2):
        share = (height_m - cut[:, 0, 1]) / (cut[:, other, 1] - cut[:, 0, 1])
        ends.append(cut[:, 0] + share[:, None] * (cut[:, other] - cut[:, 0]))
    sign = np.where(cut[:, 0, 1] > height_m, 1.0, -1.0)
    cross = ends[0][:, 0] * ends[1][:, 2] - ends[0][:, 2] * ends[1][:, 0]
    area = abs(float((sign * cross).sum())) / 2
    return 100 * float(np.sqrt(4 * area / np.pi)) if area > 0 else None
