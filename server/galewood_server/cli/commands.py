"""`galewood serve`, beside the commands of precompute/galewood/io/cli/commands.py."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from galewood.interrupts import ended_by_interrupts
from galewood.io.cli import (
    JsonOut,
    app,
    console,
    print_report,
    validated,
    with_options_of,
    write_figures,
)

from galewood_server.cli.extras import end_with, needs_extras, read_settings
from galewood_server.cli.load import Load
from galewood_server.cli.operations import doctor, key, upload

for command in (upload, doctor, key):
    app.command()(command)


@app.command()
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on (HOST).")] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on (PORT).")] = None,
    data_dir: Annotated[Path | None, typer.Option(help="Data folder (GALEWOOD_DATA_DIR).")] = None,
) -> None:
    """Serve the web page, the REST API and the streams; compute the built-in trees in the background."""
    given = {"GALEWOOD_HOST": host, "GALEWOOD_PORT": port, "GALEWOOD_DATA_DIR": data_dir}
    # children read the same settings from the environment
    os.environ.update({name: str(value) for name, value in given.items() if value is not None})
    with needs_extras(), ended_by_interrupts(even_if_ignored=True):
        from galewood_server.app import create_app, run

        settings = read_settings()
        if settings.database.startswith("postgres"):
            import_module("psycopg")  # SQLAlchemy would look for its driver only once the server runs
    run(create_app(settings), settings)


@app.command()
def forest(
    inventory: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="CSV or GeoJSON of stems.")],
    host: Annotated[str | None, typer.Option(help="Address to listen on (HOST).")] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on (PORT).")] = None,
    data_dir: Annotated[Path | None, typer.Option(help="Data folder (GALEWOOD_DATA_DIR).")] = None,
) -> None:
    """Plant a forest from an inventory of stems (position, species, height, diameter) and serve it."""
    from galewood.measurements import InventoryError, read_inventory

    try:
        report = read_inventory(inventory).report
    except InventoryError as error:
        end_with(f"{inventory} could not be read: {error}.")
    print_report(report.figures, report.notes)
    os.environ["GALEWOOD_INVENTORY"] = str(inventory.resolve())
    given_port = port or os.environ.get("GALEWOOD_PORT") or os.environ.get("PORT") or "8000"
    given_host = host or os.environ.get("GALEWOOD_HOST") or os.environ.get("HOST") or "127.0.0.1"
    print(f"Open http://{given_host}:{given_port}/?inventory=api/inventory", flush=True)
    serve(host, port, data_dir)


@app.command("bench-serve")
@with_options_of(Load)
def bench_serve(
    table: Annotated[
        list[Path] | None,
        typer.Option(exists=True, help="Table files; by default the built-in trees."),
    ] = None,
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Benchmark one server process on one core: frame rate, frame age and memory."""
    with needs_extras():
        from galewood.packaged import species_folder
        from galewood.pipeline.results import shipped_tables

        from galewood_server.cli.bench_load import run_load

    builtin = shipped_tables(species_folder())
    figures = run_load(table or list(builtin.values()), validated(Load, chosen))
    write_figures(json_out, figures)
    console.print_json(data=figures)
