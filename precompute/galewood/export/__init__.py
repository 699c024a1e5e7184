"""Exports the motion of a tree for other programs: engines, modellers, renderers.

Options and errors are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.export.errors import ExportError
from galewood.export.options import EXPORT_REVISION, KINDS, ExportKind, ExportOptions, TextureFormat
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.export.bundle import archive, write_export
    from galewood.export.glb import animated_glb, blown, sampled
    from galewood.export.limited import export_limited

__getattr__ = lazily(
    __name__,
    {
        "animated_glb": "galewood.export.glb",
        "archive": "galewood.export.bundle",
        "blown": "galewood.export.glb",
        "export_limited": "galewood.export.limited",
        "sampled": "galewood.export.glb",
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
    "blown",
    "export_limited",
    "sampled",
    "write_export",
]
