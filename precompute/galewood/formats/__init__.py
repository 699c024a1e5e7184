"""Readers of files; in: the bytes of a mesh or of a scanned tree; out: its parts, as the file draws them.

The types are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.formats.limits import MAX_BYTES, check_faces
from galewood.formats.types import Material, RawPart
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.formats.beside import mesh_with_companions
    from galewood.formats.bounded_image import IMAGE_ERRORS
    from galewood.formats.gltf.material import (
        SLOTS,
        alpha_coverage,
        base_image,
        pack_material,
        unpack_material,
    )
    from galewood.formats.gltf.reading import read_glb
    from galewood.formats.qsm import Line, tube
    from galewood.formats.reading import FileContent, read_parts

_MATERIALS = ("SLOTS", "alpha_coverage", "base_image", "pack_material", "unpack_material")
__getattr__ = lazily(
    __name__,
    {
        "IMAGE_ERRORS": "galewood.formats.bounded_image",
        "mesh_with_companions": "galewood.formats.beside",
        "read_glb": "galewood.formats.gltf.reading",
        **dict.fromkeys(("FileContent", "read_parts"), "galewood.formats.reading"),
        **dict.fromkeys(("Line", "tube"), "galewood.formats.qsm"),
        **dict.fromkeys(_MATERIALS, "galewood.formats.gltf.material"),
    },
)
__all__ = [
    "IMAGE_ERRORS",
    "MAX_BYTES",
    "SLOTS",
    "FileContent",
    "Line",
    "Material",
    "RawPart",
    "alpha_coverage",
    "base_image",
    "check_faces",
    "mesh_with_companions",
    "pack_material",
    "read_glb",
    "read_parts",
    "tube",
    "unpack_material",
]
