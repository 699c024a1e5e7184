"""What can be exported, and how: cheap to import."""

from __future__ import annotations

import re
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, ConfigDict, Field, InstanceOf

from galewood.constants import LEVEL_SHARES
from galewood.motion.wind import Wind

ExportKind = Literal["vat", "bones", "pivots", "usd", "glb", "live", "impostor", "mjcf", "urdf"]
KINDS: tuple[ExportKind, ...] = get_args(ExportKind)
TextureFormat = Literal["exr", "png"]
EXPORT_REVISION = 4
"""Increased when the files of the same options change: services keep exports by it."""
MOST_BONES = 256
"""Of one skin: what Unity, Unreal and Godot take without changing their settings."""
MOST_LETTERS = 64
"""Of a name."""
MOST_WINDS = 8
"""Of one file."""
NAME_PATTERN = r"^[\w-]+$"
RIGID_KINDS: tuple[ExportKind, ...] = ("mjcf", "urdf")
"""Kinds without a motion: rigid bodies that are fitted to the compliance file of the tree."""
SEVERAL_WINDS: tuple[ExportKind, ...] = ("bones", "pivots")
"""Kinds whose files hold several clips."""
SEVERAL_LEVELS: tuple[ExportKind, ...] = ("vat", "bones", "pivots")
"""Kinds with levels of detail."""


class LoopOptions(BaseModel):
    """The motion that an exported tree plays, its name, and what single kinds of export need."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    name: str | None = Field(
        default=None,
        pattern=NAME_PATTERN,
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
    assembly: bool = Field(
        default=False,
        description="usd: leaves as instances of a few, on a skeleton, for Unreal's Nanite assemblies.",
    )
    pixels: int = Field(
        default=2048, ge=256, le=4096, description="Of impostor: pixels along each side of its pictures."
    )
    bones: int = Field(default=MOST_BONES, ge=4, description="Most bones; mjcf, urdf: most bodies.")
    levels: int = Field(
        default=1,
        ge=1,
        le=len(LEVEL_SHARES),
        description="Levels of detail of vat, bones and pivots, each in a file of its own: NAME_lod1.glb, … "
        "show a half, a quarter, 13 % and 7 % of the leaves and twigs.",
    )


class ExportOptions(LoopOptions):
    """What to export: a wind and the loop of a tree in it."""

    wind: InstanceOf[Wind] = Field(default_factory=Wind)
    winds: dict[Annotated[str, Field(pattern=NAME_PATTERN, max_length=MOST_LETTERS)], InstanceOf[Wind]] = (
        Field(default_factory=dict, max_length=MOST_WINDS)
    )
    """By name: a clip for each, of bones and pivots, instead of one in ``wind``."""

    def document(self) -> dict[str, Any]:
        """The options as JSON, in a fixed order."""
        winds = {name: wind.document() for name, wind in self.winds.items()}
        chosen = self.model_dump(exclude={"wind", "winds"})
        return {"wind": self.wind.document(), "winds": winds, **chosen}


def file_name(text: str) -> str:
    """The name of a tree as one that ``LoopOptions.name`` takes: everything else becomes "-"."""
    return re.sub(r"[^\w-]+", "-", text)[:MOST_LETTERS].strip("-") or "tree"
