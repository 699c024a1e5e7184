"""All steps from an imported tree to its finite-element model."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from galewood.solid.fem import FemModel, FemSettings
from galewood.solid.model.construction import build_model
from galewood.solid.model.foliage import LumpedMasses, bind_foliage
from galewood.solid.skeleton import Skeleton, extract_skeleton, with_corrected_radii
from galewood.solid.tets import TetMesh, tetrahedralise
from galewood.tree import TreeMesh
from galewood.wood import Wood, wood_of_species


@dataclass(frozen=True)
class TreeModel:
    """A finite-element model with what it was made from."""

    wood: Wood
    tets: TetMesh
    skeleton: Skeleton
    lumped: LumpedMasses
    fem: FemModel


def tree_model(
    tree: TreeMesh,
    wood: Wood | None,
    target_tets: int,
    cache_dir: Path,
    settings: FemSettings,
    leaves: bool = True,
) -> TreeModel:
    """Mesh the wood, extract the skeleton, attach the foliage and build the model. Raises MeshError.

    Without ``leaves`` the model has only the mass and wind area of the wood.
    """
    wood = wood or wood_of_species(tree.species or "default")
    tets = tetrahedralise(tree, target_tets, cache_dir / "tets")
    skeleton = extract_skeleton(tets)
    tets = with_corrected_radii(tree, tets, skeleton)
    lumped = bind_foliage(tree, tets, wood, leaves)
    return TreeModel(wood, tets, skeleton, lumped, build_model(tets, skeleton, wood, lumped, settings))
