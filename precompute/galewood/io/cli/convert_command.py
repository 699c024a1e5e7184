"""`galewood convert`: from the file of an inventory or of an anemometer to the JSON that the page plays."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from galewood.io.cli.tools import JsonOut, print_error, print_report, write_figures


def convert(
    file: Annotated[
        Path,
        typer.Argument(
            exists=True, dir_okay=False, help="Stems (CSV, GeoJSON), or an anemometer's recording (CSV)."
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(help="File to write; default: FILE with .forest.json or .wind.json."),
    ] = None,
    start_s: Annotated[
        float,
        typer.Option("--from", min=0.0, help="First second of a recording to use, from its first sample."),
    ] = 0.0,
    columns: Annotated[
        list[str] | None,
        typer.Option(
            metavar="WHAT=NAME",
            help="A column of an inventory that is not recognised by its name, such as x=Ost or dbh=D13.",
        ),
    ] = None,
    json_out: JsonOut = None,
) -> None:
    """Convert an inventory of stems, or an anemometer's recording, to JSON for the page and the player.

    Stems become an inventory document, a recording becomes a wind document. Prints how it was interpreted.
    """
    from galewood.measurements import Inventory, read_data_file

    try:
        found = read_data_file(file.read_bytes(), start_s=start_s, columns=_chosen(columns or []))
    except ValueError as error:  # of an inventory, of a measurement, or of neither
        print_error(f"{file} could not be read.", str(error))
        raise typer.Exit(1) from None
    if isinstance(found, Inventory):
        kind, ending, text = "inventory document", ".forest.json", json.dumps(found.document())
    else:
        kind, ending, text = "wind document", ".wind.json", json.dumps(found.wind.document(), indent=2)
    target = out or file.with_suffix(ending)
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(text + "\n", encoding="utf-8")
    write_figures(json_out, found.report.document())
    print_report(found.report.figures, found.report.notes)
    print(f"{target}: {kind}")


def _chosen(columns: list[str]) -> dict[str, str]:
    """Names of columns by what they hold. Raises typer.BadParameter."""
    pairs = [one.partition("=") for one in columns]
    if wrong := next((what for what, equals, name in pairs if not (what and equals and name)), None):
        raise typer.BadParameter(f"expected WHAT=NAME, such as x=Ost, not {wrong!r}", param_hint="--columns")
    return {what: name for what, _, name in pairs}


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(convert)
