"""`galewood export`: a moving tree as files for engines and other programs."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from pydantic import Field

from galewood.io.cli.request_options import validated, with_options_of
from galewood.io.cli.tools import (
    JsonOut,
    console,
    print_error,
    progress_bar,
    progress_reporter,
    write_figures,
)
from galewood.io.cli.wind_options import WindOptions
from galewood.io.export import LoopOptions

if TYPE_CHECKING:
    from galewood.io.export import ExportOptions
    from galewood.motion.wind import Wind
    from galewood.table import Table

TableFile = Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="Table file.")]
Out = Annotated[Path | None, typer.Option(help="Folder to write (--to glb: file); default: TABLE-KIND.")]
To = Annotated[
    str,
    typer.Option(help="vat (textures), bones (rigged GLB), pivots (Unreal), usd, or glb (morph targets)."),
]
MESH_HELP = "Mesh of the table; default: TABLE with .glb."
Mesh = Annotated[Path | None, typer.Option(exists=True, dir_okay=False, help=MESH_HELP)]


LoopLength = Annotated[
    float | None, typer.Option(help=f"Length of the loop, s (default {LoopOptions().loop_s:g}).")
]


class Moving(WindOptions, LoopOptions):
    """How the exported tree moves."""

    seconds: float = Field(default=10.0, ge=0.1, le=600.0, description="--to glb: length without a loop, s.")
    loop: bool = Field(default=False, description="--to glb: repeat after --seconds.")
    run: str | None = Field(default=None, description="--to glb: export this sampled run instead of a wind.")


@with_options_of(Moving, without=("loop_s",))
def export(
    table: TableFile,
    to: To = "glb",
    out: Out = None,
    mesh: Mesh = None,
    loop_s: LoopLength = None,
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Write a tree that sways in a wind for engines (vat, bones, pivots), USD, or as an animated GLB."""
    from galewood.io.export import ExportError, ExportOptions
    from galewood.motion.wind import WindError
    from galewood.table import TableError, decode

    moving = validated(Moving, {**chosen, "loop_s": loop_s})
    try:
        wind, decoded, glb = moving.chosen(), decode(table.read_bytes()), _mesh_of(table, mesh)
        if to == "glb" and loop_s is None:
            _write_glb(decoded, glb, out or table.with_suffix(".sway.glb"), wind, moving)
            return
        loop = moving.model_dump(include=set(LoopOptions.model_fields))
        options = ExportOptions(wind=wind, **loop)
        _write(decoded, glb, to, out or table.with_name(f"{table.stem}-{to}"), options, json_out)
    except (ExportError, TableError, WindError, KeyError, OSError, ValueError) as error:
        print_error(str(error.args[0] if isinstance(error, KeyError) else error))
        raise typer.Exit(1) from None


def _mesh_of(table: Path, mesh: Path | None) -> bytes:
    from galewood.io.export import ExportError

    beside = mesh or table.with_suffix(".glb")
    if not beside.is_file():
        raise ExportError(f"there is no mesh {beside}: name the GLB of the table's build with --mesh")
    return beside.read_bytes()


def _write_glb(table: Table, mesh: bytes, out: Path, wind: Wind, moving: Moving) -> None:
    from galewood.io.export import animated_glb, coordinates_in_wind, recorded_coordinates

    run, seconds = moving.run, moving.seconds
    q = (
        recorded_coordinates(table, run)
        if run
        else coordinates_in_wind(table, wind, seconds, loop=moving.loop)
    )
    glb = animated_glb(table, mesh, q)
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(glb)
    console.print(f"{out}: {len(glb) / 1e6:.1f} MB, {len(q)} frames")


def _write(
    table: Table, glb: bytes, to: str, out: Path, options: ExportOptions, json_out: Path | None
) -> None:
    from galewood.io.export import write_export

    folder, name = (out.parent, out.stem) if out.suffix == ".glb" else (out, "tree")
    with progress_bar() as bar:
        figures = write_export(table, glb, to, folder, name, options, progress_reporter(bar))
    write_figures(json_out, figures)
    size = sum(path.stat().st_size for path in folder.iterdir() if path.name.startswith(name))
    console.print(f"{folder}: {size / 1e6:.1f} MB")
    measured = figures.get("measured") or figures.get("rigged", {}).get("measured", {})
    for measure, percent in measured.items():
        said = measure.removesuffix("_percent_of_height").replace("_", " ")
        console.print(f"  {said}: {percent:.3g} % of height")


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(export)
