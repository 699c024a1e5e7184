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
from galewood.io.cli.wind_options import WindOptions, named_wind
from galewood.io.export import LoopOptions
from galewood.motion.wind import PRESETS, Wind

if TYPE_CHECKING:
    from galewood.io.export import ExportOptions
    from galewood.table import Table

TableFile = Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="Table file.")]
Out = Annotated[Path | None, typer.Option(help="Folder to write; default: TABLE-KIND.")]
To = Annotated[
    str,
    typer.Option(
        help="vat (textures), bones (rigged GLB), pivots (Unreal), usd, glb (morphs), "
        "live (morphs that move by themselves), impostor (pictures from all sides, for far away), "
        "mjcf (MuJoCo), or urdf (robot simulators)."
    ),
]
MESH_HELP = "Mesh of the table; default: TABLE with .glb."
Mesh = Annotated[Path | None, typer.Option(exists=True, dir_okay=False, help=MESH_HELP)]
FILE_ENDINGS = (".glb", ".gltf", ".usd", ".usda", ".usdc", ".usdz", ".exr", ".png", ".zip")


class Moving(WindOptions, LoopOptions):
    """How the exported tree moves, and what it is called."""

    winds: str | None = Field(
        default=None,
        description="Presets and files, separated by commas: bones and pivots get a clip for each, named "
        "after it.",
    )

    def several(self) -> dict[str, Wind]:
        """The winds of several clips by their names; empty: one. OSError or ValueError."""
        from galewood.io.export import ExportError, file_name

        if self.winds is None:
            return {}
        if self.wind is not None:
            raise ExportError("--wind chooses one wind, --winds several: give one of the two")
        found = dict[str, Wind]()
        for each in self.winds.split(","):
            name = file_name(each if each in PRESETS else Path(each).stem)
            if name in found:
                raise ExportError(f"two of --winds would be clips of the name {name}: rename a file")
            found[name] = self.changed(named_wind(each, "--winds"))
        return found


@with_options_of(Moving)
def export(
    table: TableFile,
    to: To = "glb",
    out: Out = None,
    mesh: Mesh = None,
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Write a tree that sways in a wind for engines, USD or simulators, or as a GLB."""
    from galewood.io.export import RIGID_KINDS, ExportError, ExportOptions, file_name
    from galewood.motion.wind import WindError
    from galewood.pipeline.results import read_compliance
    from galewood.table import TableError, decode

    moving = validated(Moving, chosen)
    try:
        wind, decoded, glb = moving.chosen(), decode(table.read_bytes()), _mesh_of(table, mesh)
        named = moving.model_dump(include=set(LoopOptions.model_fields))
        named["name"] = moving.name or file_name(table.stem)
        options = ExportOptions(wind=wind, winds=moving.several(), **named)
        folder = _folder(out or table.with_name(f"{table.stem}-{to}"))
        compliance = read_compliance(table) if to in RIGID_KINDS else None
        _write(decoded, glb, to, folder, options, json_out, compliance)
    except (ExportError, TableError, WindError, OSError, ValueError) as error:
        print_error(str(error))
        raise typer.Exit(1) from None


def _folder(out: Path) -> Path:
    from galewood.io.export import ExportError

    if out.is_file() or out.suffix in FILE_ENDINGS:
        raise ExportError(f"--out is a folder: use --out {out.with_suffix('')} --name {out.stem}")
    return out


def _mesh_of(table: Path, mesh: Path | None) -> bytes:
    from galewood.io.export import ExportError

    beside = mesh or table.with_suffix(".glb")
    if not beside.is_file():
        raise ExportError(f"there is no mesh {beside}: name the GLB of the table's build with --mesh")
    return beside.read_bytes()


def _write(
    table: Table,
    glb: bytes,
    to: str,
    out: Path,
    options: ExportOptions,
    json_out: Path | None,
    compliance: bytes | None,
) -> None:
    from galewood.io.export import RIGID_KINDS, write_export

    name = options.name or "tree"
    with progress_bar() as bar:
        figures = write_export(table, glb, to, out, name, options, progress_reporter(bar), compliance)
    write_figures(json_out, figures)
    size = sum(path.stat().st_size for path in out.iterdir() if path.name.startswith(name))
    console.print(f"{out}: {size / 1e6:.1f} MB")
    if to in RIGID_KINDS:
        _tell_fit(figures)
        return
    measured = figures.get("measured") or figures.get("rigged", {}).get("measured", {})
    for measure, percent in measured.items():
        said = measure.removesuffix("_percent_of_height").replace("_", " ")
        console.print(f"  {said}: {percent:.3g} % of height")


def _tell_fit(figures: dict[str, Any]) -> None:
    measured = figures["measured"]
    console.print(f"  {figures['bodies']} bodies, {figures['mass_kg']:.0f} kg")
    for told in ("frequency", "damping"):
        worst = max(abs(percent) for percent in measured[f"{told}_error_percent"])
        console.print(f"  {told} of the first modes: within {worst:.2g} % of the table")
    off = measured["deflection_error_percent"]["median"]
    console.print(f"  deflection under point forces: {off:.2g} % off (median)")


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(export)
