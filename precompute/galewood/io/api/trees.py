"""Reading trees: a mesh file becomes a ``Tree``."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from galewood.formats import mesh_with_companions
from galewood.io.api.keywords import with_keywords_of
from galewood.options import ImportRequest
from galewood.tree import TreeMesh, import_mesh_sandboxed
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Tree:
    """A tree read from a mesh file: metres, y up, origin at the centre of the trunk's base.

    ``report`` lists what was assumed (axis, unit, parts, repairs) and any warnings.
    """

    mesh: TreeMesh
    render_glb: bytes = field(repr=False)
    """The mesh to draw, as a binary glTF; its vertices are those that a motion table moves."""
    name: str = "tree"
    """What its file is called."""

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


@with_keywords_of(ImportRequest)
def read(path: str | Path, options: ImportRequest) -> Tree:
    """Read a tree from a mesh file or a scan (MAT, CSV), in a sandboxed child process.

    Meshes: GLB, glTF, OBJ, PLY, STL, FBX, DAE, 3DS, or a ZIP archive of one of them with its textures. Files
    that a glTF, OBJ or FBX refers to are read if they are in its folder.

    Args:
        path: The mesh file, or the cylinders of a scanned tree.
        options: The fields of ``galewood.ImportRequest`` as keywords, such as ``height_m=12``.

    Raises:
        MeshError: The file cannot be read or is not a tree; the error says what to do.
        OSError: The file cannot be opened.
        pydantic.ValidationError: An option is unknown or out of range.
    """
    path = Path(path)
    mesh, render_glb = import_mesh_sandboxed(mesh_with_companions(path), path.name, options)
    return Tree(mesh, render_glb, path.stem)
