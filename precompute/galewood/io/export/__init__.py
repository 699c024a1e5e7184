"""Exports the motion of a tree for other programs: engines, modellers, renderers.

Options and errors are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.io.export.errors import ExportError
from galewood.io.export.options import EXPORT_REVISION, KINDS, ExportKind, ExportOptions, TextureFormat
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.io.export.bundle import archive, write_export
    from galewood.io.export.glb import animated_glb, coordinates_in_wind, recorded_coordinates
    from galewood.io.export.limited import export_limited

__getattr__ = lazily(
    __name__,
    {
        "animated_glb": "galewood.io.export.glb",
        "archive": "galewood.io.export.bundle",
        "coordinates_in_wind": "galewood.io.export.glb",
        "export_limited": "galewood.io.export.limited",
        "recorded_coordinates": "galewood.io.export.glb",
        "write_export": "galewood.io.export.bundle",
    },
)
__all__ = [
    "EXPORT_REVISION",
    "KINDS",
    "ExportError",
    "ExportKind",
    "ExportOptions",
    "TextureFormat",
    "animated_glb",
    "archive",
    "coordinates_in_wind",
    "export_limited",
    "recorded_coordinates",
    "write_export",
]
