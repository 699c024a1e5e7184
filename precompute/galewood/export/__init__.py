"""Animated GLB files for other programs."""

from galewood.export.glb import ExportError, animated_glb, blown, sampled

__all__ = ["ExportError", "animated_glb", "blown", "sampled"]
