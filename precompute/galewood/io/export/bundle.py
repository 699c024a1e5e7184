"""One export of a tree, of any kind, as files in a folder."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from galewood.io.export.errors import ExportError
from galewood.io.export.glb import export_glb
from galewood.io.export.impostor.export import export_impostor
from galewood.io.export.live.export import export_live
from galewood.io.export.looped import Loop, looped
from galewood.io.export.mjcf.export import export_mjcf
from galewood.io.export.options import KINDS, RIGID_KINDS, SEVERAL_LEVELS, SEVERAL_WINDS, ExportOptions
from galewood.io.export.packages import check_packages
from galewood.io.export.pivots import export_pivots
from galewood.io.export.skeletal.bones import export_bones
from galewood.io.export.urdf.export import export_urdf
from galewood.io.export.usd.stage import export_usd
from galewood.io.export.vat import export_vat
from galewood.motion.wind import parse_wind
from galewood.table import Table

OnProgress = Callable[[float, str], None]
ONE_WIND = "sway"
"""Name of the clip where one wind is chosen."""


def write_export(
    table: Table,
    glb: bytes,
    kind: str,
    folder: Path,
    name: str,
    options: ExportOptions | None = None,
    on_progress: OnProgress | None = None,
    compliance: bytes | None = None,
) -> dict[str, Any]:
    """Write an export of a tree to ``folder``, which is created; return its description.

    Args:
        table: The table.
        glb: The mesh that the table moves.
        kind: One of KINDS.
        folder: Where to write.
        name: Name of the files, without ending.
        options: What to export.
        on_progress: Receives the completed fraction and a message.
        compliance: The compliance file of the tree, which RIGID_KINDS need.

    Raises:
        ExportError: There is no such kind, the mesh is another tree's, or a package or a file is missing.
    """
    chosen, report = options or ExportOptions(), on_progress or _no_progress
    if kind not in KINDS:
        raise ExportError(f"there is no export {kind!r}; choose one of {', '.join(KINDS)}")
    _check_files(kind, chosen)
    check_packages(kind, chosen)
    if kind in RIGID_KINDS:
        report(0.0, "Fitting rigid bodies to the tree")
        export_rigid = export_mjcf if kind == "mjcf" else export_urdf
        description = export_rigid(table, glb, compliance, folder, name, chosen.bones)
        report(1.0, "Done")
        return description
    if kind == "impostor":
        report(0.0, "Drawing the tree from all sides")
        description = export_impostor(table, glb, folder, name, chosen)
        report(1.0, "Done")
        return description
    report(0.0, "Playing the wind")
    winds = chosen.winds or {ONE_WIND: chosen.wind}
    loops = {
        each: looped(table, wind, chosen.seconds, chosen.fps, closed=chosen.loop)
        for each, wind in winds.items()
    }
    folder.mkdir(parents=True, exist_ok=True)
    report(0.4, "Writing and measuring the files")
    description = _write(table, glb, kind, folder, name, chosen, loops)
    report(1.0, "Done")
    return description


def _check_files(kind: str, options: ExportOptions) -> None:
    """Raise ExportError for several winds or levels of a kind that has one, or an assembly of another."""
    if options.winds and kind not in SEVERAL_WINDS:
        several = " and ".join(SEVERAL_WINDS)
        raise ExportError(f"{kind} plays one wind: choose it with wind; {several} take several winds")
    if options.assembly and kind != "usd":
        raise ExportError("assembly is an option of usd: leave it out, or export usd")
    if options.levels > 1 and kind not in SEVERAL_LEVELS:
        raise ExportError(f"{kind} has one level of detail; {', '.join(SEVERAL_LEVELS)} have several")


def _write(
    table: Table,
    glb: bytes,
    kind: str,
    folder: Path,
    name: str,
    options: ExportOptions,
    loops: Mapping[str, Loop],
) -> dict[str, Any]:
    if kind == "bones":
        return export_bones(table, glb, loops, folder, name, options)
    if kind == "pivots":
        return export_pivots(table, glb, loops, folder, name, options)
    (loop,) = loops.values()
    if kind == "vat":
        return export_vat(table, glb, loop, folder, name, options)
    if kind == "usd":
        return export_usd(table, glb, loop, folder, name, options)
    if kind == "live":
        return export_live(table, glb, loop, folder, name)
    return export_glb(table, glb, loop, folder, name)


def archive(folder: Path) -> bytes:
    """The files of a folder as a ZIP archive; the same bytes for the same files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as packed:
        for path in sorted(folder.iterdir()):
            about = zipfile.ZipInfo(path.name, (1980, 1, 1, 0, 0, 0))
            compressed = path.suffix in (".exr", ".png", ".jpg")
            about.compress_type = zipfile.ZIP_STORED if compressed else zipfile.ZIP_DEFLATED
            packed.writestr(about, path.read_bytes())
    return stream.getvalue()


def options_of(document: str) -> ExportOptions:
    """The options of a JSON text that ``ExportOptions.document`` made. Raises WindError."""
    fields: dict[str, Any] = json.loads(document)
    fields["wind"] = parse_wind(fields["wind"])
    fields["winds"] = {name: parse_wind(wind) for name, wind in fields["winds"].items()}
    return ExportOptions(**fields)


def _no_progress(fraction: float, message: str) -> None:
    pass
