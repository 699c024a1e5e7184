"""Exports the motion of a tree as an animated GLB."""

from galewood.export.glb import ExportError, animated_glb, blown, sampled

__all__ = ["ExportError", "animated_glb", "blown", "sampled"]
