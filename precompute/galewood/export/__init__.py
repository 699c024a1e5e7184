"""Exports the motion of a tree for other programs: engines, modellers, renderers.

Options and errors are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.export.errors import ExportError
from galewood.export.options import EXPORT_REVISION, KINDS, ExportKind, ExportOptions, TextureFormat
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.export.bundle import archive, write_export
    from galewood.export.glb import animated_glb, coordinates_in_wind, recorded_coordinates
    from galewood.export.limited import export_limited

__getattr__ = lazily(
    __name__,
    {
        "animated_glb": "galewood.export.glb",
        "archive": "galewood.export.bundle",
        "coordinates_in_wind": "galewood.export.glb",
        "export_limited": "galewood.export.limited",
        "recorded_coordinates": "galewood.export.glb",
        "write_export": "galewood.export.bundle",
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
