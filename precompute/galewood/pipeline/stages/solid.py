"""The first stages of a build: from a mesh file to the wood as a finite-element mesh with its foliage."""

from __future__ import annotations

from dataclasses import dataclass

from galewood.pipeline.pictures import skeleton_png, tetrahedra_png
from galewood.pipeline.stages.artefacts import RENDER_MESH_FILE
from galewood.pipeline.stages.context import BuildContext, runs_as
from galewood.pipeline.stages.stage import Stage
from galewood.pipeline.tables import (
    RenderMesh,
    TableStage,
    beam_table,
    encoded_unless_torn,
    render_mesh,
)
from galewood.solid.fem import FemModel
from galewood.solid.model import LumpedMasses, TreeModel, bind_foliage, in_added_wood
from galewood.solid.skeleton import Skeleton, extract_skeleton, sampled_elements, with_corrected_radii
from galewood.solid.skinning import axis_of_tets, render_embedding
from galewood.solid.tets import TetMesh, cached_tetrahedra_path, tetrahedralise
from galewood.tree import TreeMesh, import_mesh_sandboxed
from galewood.util import Array
from galewood.wood import Wood


@dataclass(frozen=True)
class ImportedTree:
    """A tree as it was read, and the mesh that its table animates."""

    tree: TreeMesh
    render_glb: bytes
    moving: bool = False
    """Whether a first table of it is already there."""


@dataclass(frozen=True)
class MeshFile:
    """A mesh file of a tree: its bytes, or what they were read as before."""

    content: bytes | ImportedTree
    name: str


@dataclass(frozen=True)
class MeshedTree:
    """A tree whose wood is tetrahedra."""

    imported: ImportedTree
    wood: Wood
    mesh: TetMesh


@dataclass(frozen=True)
class SolidTree:
    """A tree's wood as a finite-element mesh, with what hangs on it."""

    imported: ImportedTree
    wood: Wood
    mesh: TetMesh
    skeleton: Skeleton
    lumped: LumpedMasses
    surface: RenderMesh
    points: Array
    """Vertices at which the paper's states are recorded."""

    @property
    def tree(self) -> TreeMesh:
        """The tree as it was read."""
        return self.imported.tree

    def with_model(self, model: FemModel) -> TreeModel:
        """A model that was built from it, with what it was made from."""
        return TreeModel(self.wood, self.mesh, self.skeleton, self.lumped, model)


@runs_as(Stage.IMPORT)
def import_tree(file: MeshFile, context: BuildContext) -> ImportedTree:
    """Read the mesh file, unless that is done; publish the mesh to draw, and start computing a first table.

    Raises MeshError.
    """
    imported = file.content
    if isinstance(imported, bytes):
        imported = ImportedTree(*import_mesh_sandboxed(imported, file.name, context.options))
    tree, render_glb = imported.tree, imported.render_glb
    context.on_import(tree)
    context.artefacts.publish(RENDER_MESH_FILE, lambda: render_glb)
    if not imported.moving:
        context.artefacts.compute(
            TableStage.BEAMS.file,
            lambda: encoded_unless_torn(beam_table(tree, context.options, render_glb)),
        )
    return imported


@runs_as(Stage.MESHING)
def mesh_wood(imported: ImportedTree, context: BuildContext) -> MeshedTree:
    """Mesh the wood with tetrahedra; publish them and a picture. Raises MeshError."""
    tree, target, folder = imported.tree, context.options.target_tets, context.cache_dir / "tets"
    wood = context.options.wood_of(tree.species)
    mesh = tetrahedralise(tree, target, folder)
    kept = cached_tetrahedra_path(tree, target, folder)
    context.artefacts.publish(kept.name, kept.read_bytes)
    context.artefacts.draw("tetrahedra.png", tetrahedra_png, mesh)
    return MeshedTree(imported, wood, mesh)


@runs_as(Stage.SKELETON)
def attach_foliage(meshed: MeshedTree, context: BuildContext) -> SolidTree:
    """Extract the skeleton, correct the radii, attach the foliage and the drawn mesh; publish a picture."""
    tree, options = meshed.imported.tree, context.options
    skeleton = extract_skeleton(meshed.mesh)
    mesh = with_corrected_radii(tree, meshed.mesh, skeleton)
    elements = sampled_elements(mesh, skeleton, options.sampled_elements)
    context.artefacts.draw(
        "skeleton.png", skeleton_png, mesh, skeleton, elements, in_added_wood(tree, skeleton.points_m)
    )
    lumped = bind_foliage(tree, mesh, meshed.wood, leaves=options.foliage == "leaf")
    surface = render_mesh(tree, render_embedding(tree, mesh), axis_of_tets(mesh, skeleton))
    return SolidTree(meshed.imported, meshed.wood, mesh, skeleton, lumped, surface, mesh.tets[elements])
