"""Mesh import; in: the bytes of a file; out: a TreeMesh (metres, wood and foliage separated) and a render
GLB.
"""

from galewood.mesh.classification import weld_keeping_faces
from galewood.mesh.gltf import read_glb
from galewood.mesh.gltf_material import alpha_coverage, base_image
from galewood.mesh.repair import Surface, compact, face_components, signed_volumes, volume
from galewood.mesh.sandboxed import import_mesh_sandboxed
from galewood.mesh.types import ImportOptions, Material, RawPart, RenderPrimitive, TreeMesh

__all__ = [
    "ImportOptions",
    "Material",
    "RawPart",
    "RenderPrimitive",
    "Surface",
    "TreeMesh",
    "alpha_coverage",
    "base_image",
    "compact",
    "face_components",
    "import_mesh_sandboxed",
    "read_glb",
    "signed_volumes",
    "volume",
    "weld_keeping_faces",
]
