"""Exports of a motion table for engines and other programs."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from galewood.api.tables import MotionTable
from galewood.export import ExportKind, ExportOptions, TextureFormat, write_export
from galewood.wind import Wind


def export_tree(
    table: MotionTable,
    to: ExportKind,
    out: str | Path,
    *,
    name: str = "tree",
    wind: Wind | None = None,
    loop_s: float = 8.0,
    fps: float = 30.0,
    textures: TextureFormat = "exr",
    bones: int = 256,
    on_progress: Callable[[float, str], None] | None = None,
) -> dict[str, Any]:
    """Write a tree that sways in a loop, for an engine or another program.

    Args:
        table: The table, with its mesh.
        to: What to write: "vat" (vertex animation textures), "bones" (a rigged GLB), "pivots" (for Unreal),
            "usd", or "glb" (morph targets).
        out: Folder to write, created if needed.
        name: Name of the files, without ending.
        wind: The wind; by default one of 8 m/s. It is made periodic.
        loop_s: Length of the loop, rounded to steps of the table.
        fps: Frames per second ("glb": always one frame per step of the table).
        textures: Format of the textures of "vat".
        bones: Most bones of a skeleton.
        on_progress: Receives the fraction done and a message.

    Returns:
        The description that is also written as JSON; ``measured`` holds error and seam, in % of the height.

    Raises:
        ExportError: An option is out of range, or a package is missing (a ValueError).
        ValueError: The table has no mesh.
    """
    if table.render_glb is None:
        raise ValueError("this table has no mesh: load it with galewood.load(path, mesh=...)")
    options = ExportOptions(wind or Wind(), loop_s, fps, textures, bones)
    return write_export(table.table, table.render_glb, to, Path(out), name, options, on_progress)
