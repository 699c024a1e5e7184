"""What can be exported, and how: cheap to import."""

from __future__ import annotations

import re
from typing import Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, InstanceOf

from galewood.motion.wind import Wind

ExportKind = Literal["vat", "bones", "pivots", "usd", "glb", "live", "mjcf"]
KINDS: tuple[ExportKind, ...] = get_args(ExportKind)
TextureFormat = Literal["exr", "png"]
EXPORT_REVISION = 2
"""Increased when the files of the same options change: services keep exports by it."""
MOST_BONES = 256
"""Of one skin: what Unity, Unreal and Godot take without changing their settings."""
MOST_LETTERS = 64
"""Of a name."""


class LoopOptions(BaseModel):
    """The motion that an exported tree plays, its name, and what single kinds of export need."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str | None = Field(
        default=None,
        pattern=r"^[\w-]+$",
        max_length=MOST_LETTERS,
        description="Name of the files and of nodes, materials, pictures and the animation in them: "
        "letters, digits, _ and -; default: the tree's.",
    )
    seconds: float = Field(default=8.0, ge=1, le=120, description="Length of the motion, s.")
    loop: bool = Field(
        default=True, description="Whether the end meets the beginning: the wind is made periodic."
    )
    fps: float = Field(default=30.0, ge=5, le=120, description="Frames per second.")
    format: TextureFormat = Field(default="exr", description="Textures of vat: exr or png (16 bits).")
    bones: int = Field(default=MOST_BONES, ge=4, description="Maximum number of bones; mjcf: of bodies.")


class ExportOptions(LoopOptions):
    """What to export: a wind and the loop of a tree in it."""

    wind: InstanceOf[Wind] = Field(default_factory=Wind)

    def document(self) -> dict[str, Any]:
        """The options as JSON, in a fixed order."""
        return {"wind": self.wind.document(), **self.model_dump(exclude={"wind"})}


def file_name(text: str) -> str:
    """The name of a tree as one that ``LoopOptions.name`` takes: everything else becomes "-"."""
    return re.sub(r"[^\w-]+", "-", text)[:MOST_LETTERS].strip("-") or "tree"
