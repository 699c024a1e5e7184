"""Mesh import; in: the bytes of a file; out: a TreeMesh (metres, wood and foliage separated) and a render
GLB.

The types are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.mesh.types import KINDS, Material, RawPart, RenderPrimitive, TreeMesh
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.mesh.arms import arms_of
    from galewood.mesh.beside import mesh_with_companions
    from galewood.mesh.gltf import read_glb
    from galewood.mesh.gltf_material import alpha_coverage, base_image
    from galewood.mesh.repair import (
        Surface,
        compact,
        face_components,
        signed_volumes,
        unique_edges,
        volume,
        weld_keeping_faces,
    )
    from galewood.mesh.sandboxed import import_mesh_sandboxed, pieces_sandboxed

__getattr__ = lazily(
    __name__,
    {
        "arms_of": "galewood.mesh.arms",
        "mesh_with_companions": "galewood.mesh.beside",
        "weld_keeping_faces": "galewood.mesh.repair",
        "read_glb": "galewood.mesh.gltf",
        "alpha_coverage": "galewood.mesh.gltf_material",
        "base_image": "galewood.mesh.gltf_material",
        "Surface": "galewood.mesh.repair",
        "compact": "galewood.mesh.repair",
        "face_components": "galewood.mesh.repair",
        "signed_volumes": "galewood.mesh.repair",
        "unique_edges": "galewood.mesh.repair",
        "volume": "galewood.mesh.repair",
        "import_mesh_sandboxed": "galewood.mesh.sandboxed",
        "pieces_sandboxed": "galewood.mesh.sandboxed",
    },
)
__all__ = [
    "KINDS",
    "Material",
    "RawPart",
    "RenderPrimitive",
    "Surface",
    "TreeMesh",
    "alpha_coverage",
    "arms_of",
    "base_image",
    "compact",
    "face_components",
    "import_mesh_sandboxed",
    "mesh_with_companions",
    "pieces_sandboxed",
    "read_glb",
    "signed_volumes",
    "unique_edges",
    "volume",
    "weld_keeping_faces",
]
