"""`galewood wind read`: from the file of an anemometer's logger to a wind document."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from galewood.cli.tools import JsonOut, console, write_figures

if TYPE_CHECKING:  # loaded only when a command runs
    from galewood.wind import Measurement, Wind

wind = typer.Typer(no_args_is_help=True, help="Winds from measurements.")


@wind.command()
def read(
    file: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="CSV of a logger.")],
    out: Annotated[
        Path | None, typer.Option(help="Wind document to write; default: FILE with .wind.json.")
    ] = None,
    start_s: Annotated[
        float, typer.Option("--from", min=0.0, help="First second to use, from the first sample.")
    ] = 0.0,
    json_out: JsonOut = None,
) -> None:
    """Read the time, speed and direction of an anemometer; report them, and write them as a wind document."""
    from galewood.wind import MeasurementError, read_measurement

    try:
        found = read_measurement(file, start_s=start_s)
    except MeasurementError as error:
        console.print(f"[red]{file} could not be read.[/red] {error}", highlight=False)
        raise typer.Exit(1) from None
    target = out or file.with_suffix(".wind.json")
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(found.wind.document(), indent=2) + "\n")
    write_figures(json_out, found.report.document())
    for line in [*_lines(found), f"{target}: wind document"]:
        print(line)


def read_wind_document(path: Path) -> Wind:
    """The wind of a JSON document; prints what is wrong with it and exits."""
    from galewood.wind import parse_wind

    try:
        return parse_wind(json.loads(path.read_bytes()))
    except ValueError as error:  # not JSON, or no wind
        console.print(f"[red]{path} is no wind document.[/red] {error}", highlight=False)
        raise typer.Exit(1) from None


def _lines(found: Measurement) -> list[str]:
    report = found.report
    gaps = f"{report.gaps}, the longest {report.longest_gap_s:.1f} s" if report.gaps else "none"
    return [
        *(f"{what}: column {column}" for what, column in report.columns.items()),
        f"samples: {report.rows} in {report.duration_s:.1f} s, {report.rate_hz:.3g} Hz",
        f"mean wind: {report.mean_speed_m_s:.1f} m/s from {report.from_deg:.0f}°",
        f"strongest sample: {report.max_speed_m_s:.1f} m/s",
        f"turbulence intensity: {100 * report.intensity:.0f} %",
        f"gaps: {gaps}",
        *report.notes,
    ]


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.add_typer(wind, name="wind")
