"""Reading trees: a mesh file becomes a ``Tree``."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from galewood.mesh import TreeMesh, import_mesh_sandboxed, mesh_with_companions
from galewood.options import ImportRequest, import_options
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Tree:
    """A tree read from a mesh file: metres, y up, origin at the centre of the trunk's base.

    ``report`` lists what was assumed (axis, unit, parts, repairs) and any warnings.
    """

    mesh: TreeMesh
    render_glb: bytes = field(repr=False)
    """The mesh to draw, as a binary glTF; its vertices are those that a motion table moves."""

    @property
    def height_m(self) -> float:
        """Height of the whole tree, m."""
        return self.mesh.height_m

    @property
    def species(self) -> str | None:
        """Wood species, as given or as the file's names suggest; None: unknown."""
        return self.mesh.species

    @property
    def report(self) -> dict[str, Any]:
        """What mesh import found and assumed; JSON-able."""
        return self.mesh.report

    @property
    def wood_vertices_m(self) -> Floats:
        """(n, 3) vertices of the closed wood surface, m."""
        return self.mesh.wood_vertices_m

    @property
    def wood_faces(self) -> Ints:
        """(m, 3) triangles of the closed wood surface."""
        return self.mesh.wood_faces


def read(
    path: str | Path,
    *,
    species: str | None = None,
    height_m: float | None = None,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    wood_materials: list[str] | None = None,
    leaves: list[str] | None = None,
    drop: list[str] | None = None,
    tree: int | None = None,
    dbh_cm: float | None = None,
    min_radius_mm: float | None = None,
    bare: bool = False,
    complete: bool | None = None,
) -> Tree:
    """Read a tree from a mesh file or a scan (MAT, CSV), in a sandboxed child process.

    Meshes: GLB, glTF, OBJ, PLY, STL, FBX, DAE, 3DS, or a ZIP archive of one of them with its textures. Files
    that a glTF, OBJ or FBX refers to are read if they are in its folder.

    Args:
        path: The mesh file, or the cylinders of a scanned tree.
        species: Wood species (``galewood.SPECIES``); by default guessed from the names in the file.
        height_m: Height of the tree; by default the file's unit is guessed.
        up_axis: Axis that points up; by default guessed from the shape.
        wood_materials: What is wood: names of materials, nodes or meshes (all others are then leaves), or ids
            of pieces from ``report["pieces"]``.
        leaves: What is leaves: names, or ids of pieces.
        drop: What is left out: names, or ids of pieces.
        tree: Which tree of a file with several, from 1; by default the largest.
        dbh_cm: Scanned tree: scale all radii to this diameter of the trunk at 1.3 m.
        min_radius_mm: Scanned tree: drop branches thinner than this; by default 10 mm, or what leaves 200.
        bare: Scanned tree: add no leaves.
        complete: Whether wood is added where foliage has none, such as a trunk inside a closed crown; it
            bends, but is not drawn. By default where the foliage needs it.

    Raises:
        MeshError: The file cannot be read or is not a tree; the error says what to do.
        OSError: The file cannot be opened.
        pydantic.ValidationError: An option is out of range.
    """
    request = ImportRequest(
        species=species,
        height_m=height_m,
        up_axis=up_axis,
        wood_materials=wood_materials,
        leaves=leaves,
        drop=drop,
        tree=tree,
        dbh_cm=dbh_cm,
        min_radius_mm=min_radius_mm,
        bare=bare,
        complete=complete,
    )
    path = Path(path)
    data = mesh_with_companions(path)
    mesh, render_glb = import_mesh_sandboxed(data, path.name, import_options(request))
    return Tree(mesh, render_glb)
