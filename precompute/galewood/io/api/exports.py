"""Exports of a motion table for engines and other programs."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from galewood.io.api.keywords import with_keywords_of
from galewood.io.api.tables import MotionTable
from galewood.io.export import ExportKind, ExportOptions, write_export


class ExportCall(ExportOptions):
    """Everything that can be chosen about an export in a program."""

    to: ExportKind
    out: str | Path
    name: str = "tree"
    on_progress: Callable[[float, str], None] | None = None


@with_keywords_of(ExportCall)
def export_tree(table: MotionTable, options: ExportCall) -> dict[str, Any]:
    """Write a tree that sways in a loop, for an engine or another program.

    Args:
        table: The table, with its mesh.
        options: As keywords. ``to``: what to write, "vat" (vertex animation textures), "bones" (a rigged
            GLB), "pivots" (for Unreal), "usd", or "glb" (morph targets). ``out``: folder to write, created
            if needed. ``name``: name of the files, without ending. ``wind``: by default one of 8 m/s; it is
            made periodic. ``loop_s``: length of the loop, rounded to steps of the table. ``fps``: frames per
            second ("glb": always one frame per step of the table). ``format``: textures of "vat", "exr" or
            "png". ``bones``: most bones of a skeleton. ``on_progress``: receives the fraction done and a
            message.

    Returns:
        The description that is also written as JSON; ``measured`` holds error and seam, in % of the height.

    Raises:
        ExportError: A package is missing, or the mesh is another tree's (a ValueError).
        pydantic.ValidationError: An option is unknown or out of range (a ValueError).
        ValueError: The table has no mesh.
    """
    if table.render_glb is None:
        raise ValueError("this table has no mesh: load it with galewood.load(path, mesh=...)")
    return write_export(
        table.table,
        table.render_glb,
        options.to,
        Path(options.out),
        options.name,
        options,
        options.on_progress,
    )
