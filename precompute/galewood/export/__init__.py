"""Exports the motion of a tree for other programs: engines, modellers, renderers."""

from galewood.export.bundle import FORMATS, KINDS, REVISION, ExportKind, ExportOptions, archive, write_export
from galewood.export.errors import ExportError
from galewood.export.glb import animated_glb, blown, sampled
from galewood.export.limited import export_limited
from galewood.export.textures import TextureFormat

__all__ = [
    "FORMATS",
    "KINDS",
    "REVISION",
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
