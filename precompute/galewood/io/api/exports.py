"""Exports of a motion table for engines and other programs."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy.typing as npt

from galewood.io.api.expected import expect
from galewood.io.api.keywords import with_keywords_of
from galewood.io.api.tables import MotionTable
from galewood.io.export import ExportKind, ExportOptions, air_at_bodies, file_name, write_export
from galewood.motion.wind import Wind
from galewood.util import Floats


class ExportCall(ExportOptions):
    """Everything that can be chosen about an export in a program."""

    to: ExportKind
    out: str | Path
    on_progress: Callable[[float, str], None] | None = None


@with_keywords_of(ExportCall)
def export_tree(table: MotionTable, options: ExportCall) -> dict[str, Any]:
    """Write a tree that sways, for an engine or another program; by default in a loop of 8 s.

    Args:
        table: The table, with its mesh.
        options: As keywords. ``to``: what to write, "vat" (vertex animation textures), "bones" (a rigged
            GLB), "pivots" (for Unreal), "usd", "glb" (morph targets), "live" (morph
            targets that the file itself moves, in any wind), "impostor" (pictures from all sides, to be drawn
            far away), "mjcf" (rigid bodies for MuJoCo) or "urdf" (for robot simulators); the last three
            ignore wind and loop. ``out``: folder to write, created if
            needed. ``name``: name of the files and of what is in them, by default that of the table's file.
            ``wind``: by default one of 8 m/s. ``winds``: several by name, {"calm":
            galewood.PRESETS["breeze"], …}: a clip for each, of "bones" and "pivots". ``seconds``: length of
            the motion, rounded to steps of the table. ``loop``: whether its end meets its beginning, in the
            wind made periodic. ``fps``: frames per second. ``format``: textures of "vat", "exr" or "png".
            ``bones``: most bones of a skeleton, or bodies. ``assembly``: of "usd", leaves as instances of
            a few, for Unreal. ``pixels``: along each side of the pictures of
            "impostor".
            ``levels``: levels of detail of "vat", "bones" and "pivots", 1 to 5. ``on_progress``: receives the
            fraction done and a message.

    Returns:
        The description that is also written as JSON; ``measured`` holds error and seam, in % of the height
        ("mjcf", "urdf": errors of frequencies, damping and deflection, %; "impostor": none).

    Raises:
        ExportError: A package or a file is missing, or the mesh is another tree's (a ValueError).
        pydantic.ValidationError: An option is unknown or out of range (a ValueError).
        TypeError: ``table`` is something else.
        ValueError: The table has no mesh.
    """
    expect("table", table, MotionTable)
    if table.render_glb is None:
        raise ValueError("this table has no mesh: load it with galewood.load(path, mesh=...)")
    return write_export(
        table.table,
        table.render_glb,
        options.to,
        Path(options.out),
        options.name or file_name(table.name),
        options,
        options.on_progress,
        table.compliance,
    )


def body_winds(table: MotionTable, wind: Wind, places_m: npt.ArrayLike, times_s: npt.ArrayLike) -> Floats:
    """The air at the bodies of a tree exported as "mjcf" or "urdf", in the gusts of a wind.

    It is slower than the wind, as the crown shelters itself, and differs from body to body by the gusts
    within the crown. The force on a body is ½ ``air_kg_m3`` ``area_m2`` |r| r, with r this velocity minus
    that of the body; area and density are in the description of the export.

    Args:
        table: The table that was exported.
        wind: The wind.
        places_m: (b, 3) places of the bodies at rest, m, z up, the foot of the tree at the origin.
        times_s: (T,) times of the wind, s.

    Returns:
        (T, b, 3) velocities, m/s, z up.

    Raises:
        TypeError: ``table`` is something else.
    """
    expect("table", table, MotionTable)
    return air_at_bodies(table.table, wind, places_m, times_s)
