"""What can be exported, and how: cheap to import."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal, get_args

from galewood.motion.wind import Wind

ExportKind = Literal["vat", "bones", "pivots", "usd", "glb"]
KINDS: tuple[ExportKind, ...] = get_args(ExportKind)
TextureFormat = Literal["exr", "png"]
FORMATS: tuple[TextureFormat, ...] = get_args(TextureFormat)
EXPORT_REVISION = 1
"""Increased when the files of the same options change: services keep exports by it."""
MOST_BONES = 256
"""Of one skin: what Unity, Unreal and Godot take without changing their settings."""


@dataclass(frozen=True)
class ExportOptions:
    """What to export: the wind, the length of its loop and the frame rate; and what single kinds need."""

    wind: Wind = field(default_factory=Wind)
    loop_s: float = 8.0
    fps: float = 30.0
    format: TextureFormat = "exr"
    """Of vertex animation textures."""
    bones: int = MOST_BONES
    """Maximum number of bones."""

    def document(self) -> dict[str, Any]:
        """The options as JSON, in a fixed order."""
        return {
            "wind": self.wind.document(),
            "loop_s": self.loop_s,
            "fps": self.fps,
            "format": self.format,
            "bones": self.bones,
        }
