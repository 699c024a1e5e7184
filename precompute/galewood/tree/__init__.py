"""Mesh import; in: the parts of a file; out: a TreeMesh (metres, wood and foliage separated) and a render
GLB.

The types are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.tree.types import KINDS, RenderPrimitive, TreeMesh
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.tree.missing.arms import arms_of
    from galewood.tree.repair import (
        Surface,
        compact,
        face_components,
        signed_volumes,
        unique_edges,
        volume,
        weld_keeping_faces,
    )
    from galewood.tree.sandboxed import import_mesh_sandboxed, pieces_sandboxed

__getattr__ = lazily(
    __name__,
    {
        "arms_of": "galewood.tree.missing.arms",
        "weld_keeping_faces": "galewood.tree.repair",
        "Surface": "galewood.tree.repair",
        "compact": "galewood.tree.repair",
        "face_components": "galewood.tree.repair",
        "signed_volumes": "galewood.tree.repair",
        "unique_edges": "galewood.tree.repair",
        "volume": "galewood.tree.repair",
        "import_mesh_sandboxed": "galewood.tree.sandboxed",
        "pieces_sandboxed": "galewood.tree.sandboxed",
    },
)
__all__ = [
    "KINDS",
    "RenderPrimitive",
    "Surface",
    "TreeMesh",
    "arms_of",
    "compact",
    "face_components",
    "import_mesh_sandboxed",
    "pieces_sandboxed",
    "signed_volumes",
    "unique_edges",
    "volume",
    "weld_keeping_faces",
]
