"""Comparison of a folder of trees with measurements."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from galewood.check.field import FieldOptions, run_field
from galewood.io.api.cache import default_cache_dir
from galewood.options import BuildRequest


def field_report(
    folder: str | Path,
    *,
    measurements: str | Path | None = None,
    out: str | Path | None = None,
    workers: int = 1,
    trees: BuildRequest | None = None,
    damping: bool = True,
    sway: float = 0.03,
    on_progress: Callable[[float, str], None] | None = None,
    cache_dir: Path | None = None,
) -> dict[str, Any]:
    """Compare a folder of trees with a table of their measured frequencies and damping.

    Writes report.json, report.html and scatter.png, and returns the report.

    Args:
        folder: Folder of meshes or scans.
        measurements: CSV table; by default the only one in the folder.
        out: Folder to write; by default "field-report" in the folder.
        workers: Processes, each for one tree at a time.
        trees: Options of every tree, such as ``min_radius_mm``, ``target_tets`` and ``root_stiffness_knm``;
            its ``wood`` is that of the trees for which the table names no species.
        damping: Whether to pull and release every tree to find its damping.
        sway: How far to pull, as a share of the height.
        on_progress: Receives the fraction done and a message after every tree; if it raises ``Cancelled``,
            the report holds the trees that are finished.
        cache_dir: Folder for meshes; by default the user's cache folder.

    Raises:
        FieldError: The folder or its table cannot be used (a ValueError).
    """
    options = FieldOptions(
        measurements=Path(measurements) if measurements else None,
        out=Path(out) if out else None,
        workers=workers,
        trees=trees or BuildRequest(),
        damping=damping,
        sway=sway,
        cache_dir=cache_dir or default_cache_dir(),
    )
    return run_field(Path(folder), options, on_progress or (lambda share, message: None))
