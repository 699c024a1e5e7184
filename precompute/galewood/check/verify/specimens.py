"""The generated trees as specimens for the checks, with the skeleton of their generator."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from galewood.options import ImportRequest
from galewood.solid.beams import Frame, joined_frame
from galewood.solid.fem import Element, FemModel, FemSettings
from galewood.solid.model import LumpedMasses, bind_foliage, build_model
from galewood.solid.skeleton import Skeleton, extract_skeleton, with_corrected_radii
from galewood.solid.tets import TetMesh, tetrahedralise
from galewood.tree import TreeMesh, import_mesh_sandboxed
from galewood.util import Floats
from galewood.wood import Wood, wood_of_species

Form = Literal["open", "forest"]
BEAMS_PER_LINK = 4
"""Of the generator's skeleton."""
TARGETS = (3000, 5500, 8000)
Mesher = Callable[[str, TreeMesh, int], TetMesh]
"""Returns the tetrahedra of a tree's wood, given its name, tree and target count."""


@dataclass(frozen=True)
class Specimen:
    """One generated tree on one tetrahedral mesh, with all inputs of its models."""

    name: str
    form: Form
    tree: TreeMesh
    mesh: TetMesh
    skeleton: Skeleton
    lumped: LumpedMasses
    wood: Wood
    generated: dict[str, Any]
    """Columns of the generator's skeleton, relative to the origin of the tree."""
    frame: Frame

    def model(self, element: Element = "fitted", gravity: bool = True, leaves: bool = True) -> FemModel:
        """Build a model of the tree; ``leaves`` False omits that of leaves and twigs."""
        nothing = np.zeros_like(self.lumped.mass_kg)
        lumped = self.lumped if leaves else replace(self.lumped, mass_kg=nothing, leaf_mass_kg=nothing)
        settings = FemSettings(element=element, gravity=gravity)
        return build_model(self.mesh, self.skeleton, self.wood, lumped, settings)

    @cached_property
    def fast(self) -> FemModel:
        """The default model of a build."""
        return self.model()

    @cached_property
    def reference(self) -> FemModel:
        """The quadratic model on the same mesh."""
        return self.model("quadratic")

    def reference_of(self, name: str) -> Floats:
        """Column of the generator's skeleton as an array."""
        return np.array(self.generated[name])


def read_frame(path: Path, beams_per_link: int = BEAMS_PER_LINK) -> Frame:
    """Read the frame from a generator's skeleton file (columns points_m, radius_m, parent, branch)."""
    columns = json.loads(path.read_text())
    points, radius = np.array(columns["points_m"], float), np.array(columns["radius_m"], float)
    parent, branch = np.array(columns["parent"]), np.array(columns["branch"])
    return joined_frame(points, radius, parent, branch, beams_per_link)


def forms_of(folder: Path) -> dict[str, tuple[str, Form]]:
    """Species and form of each generated tree of a folder, by name."""
    listed = json.loads((folder / "species.json").read_bytes())
    return {entry["id"]: (entry["species"], entry["form"]) for entry in listed}


def read_tree(folder: Path, name: str) -> TreeMesh:
    """Import the mesh of a generated tree."""
    path, (species, _) = folder / f"{name}.glb", forms_of(folder)[name]
    tree, _ = import_mesh_sandboxed(path.read_bytes(), path.name, ImportRequest(species=species))
    return tree


def specimen(folder: Path, name: str, tree: TreeMesh, mesh: TetMesh) -> Specimen:
    """Skeleton, radius correction and foliage on a tetrahedral mesh of the tree."""
    skeleton = extract_skeleton(mesh)
    mesh = with_corrected_radii(tree, mesh, skeleton)
    species, form = forms_of(folder)[name]
    wood = wood_of_species(species)
    path = folder / f"{name}.skeleton.json"
    generated, frame = json.loads(path.read_text()), read_frame(path)
    origin = np.array(tree.report["roots"]["origin_in_file"])
    generated["points_m"] = np.array(generated["points_m"]) - origin
    frame = replace(frame, points_m=frame.points_m - origin)
    lumped = bind_foliage(tree, mesh, wood)
    return Specimen(name, form, tree, mesh, skeleton, lumped, wood, generated, frame)


def cached_mesher(cache_dir: Path) -> Mesher:
    """A mesher with the cache of the builds."""
    return lambda name, tree, target: tetrahedralise(tree, target, cache_dir / "tets")
