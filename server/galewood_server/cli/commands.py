"""`galewood serve`, beside the commands of precompute/galewood/cli/commands.py."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer
from galewood.cli import JsonOut, app, console, write_figures

from galewood_server.cli.extras import needs_extras
from galewood_server.cli.operations import doctor, key, upload

for command in (upload, doctor, key):
    app.command()(command)


@app.command()
def serve(
    host: Annotated[str | None, typer.Option(help="Address to listen on (HOST).")] = None,
    port: Annotated[int | None, typer.Option(help="Port to listen on (PORT).")] = None,
    data_dir: Annotated[Path | None, typer.Option(help="Folder of all state (GALEWOOD_DATA_DIR).")] = None,
) -> None:
    """Serve the page, the REST interface and the streams; compute the built-in species in the background."""
    given = {"GALEWOOD_HOST": host, "GALEWOOD_PORT": port, "GALEWOOD_DATA_DIR": data_dir}
    # children read the same settings from the environment
    os.environ.update({name: str(value) for name, value in given.items() if value is not None})
    with needs_extras():
        from galewood_server.app import create_app, run
        from galewood_server.settings import Settings

        settings = Settings()
        if settings.database.startswith("postgres"):
            import_module("psycopg")  # SQLAlchemy would look for its driver only once the server runs
    run(create_app(settings), settings)


@app.command("bench-serve")
def bench_serve(
    clients: Annotated[int, typer.Option(help="Clients that read.")] = 200,
    trees: Annotated[int, typer.Option(help="Trees of each forest.")] = 1000,
    forests: Annotated[int, typer.Option(help="Forests that they share; 0 gives each its own.")] = 1,
    stalled: Annotated[int, typer.Option(help="Further clients that never read, in a second phase.")] = 20,
    seconds: Annotated[float, typer.Option(help="Length of the first phase.")] = 20.0,
    paper: Annotated[
        bool, typer.Option(help="The paper's search in place of the drift-free method.")
    ] = False,
    server_core: Annotated[int, typer.Option(help="Core of the server; −1 for any.")] = 0,
    client_core: Annotated[int, typer.Option(help="Core of the clients; −1 for any.")] = 1,
    table: Annotated[list[Path] | None, typer.Option(exists=True, help="Tables of the trees.")] = None,
    data_dir: Annotated[Path, typer.Option(help="Where to look for tables.")] = Path("data"),
    json_out: JsonOut = None,
) -> None:
    """Measure what one server process on one core carries: frame rate, age of frames, memory."""
    with needs_extras():
        from galewood_server.cli.bench_load import Load, run_load, table_files

    load = Load(
        clients=clients,
        trees=trees,
        forests=forests,
        stalled=stalled,
        seconds=seconds,
        method="paper" if paper else "modal",
        server_core=None if server_core < 0 else server_core,
        client_core=None if client_core < 0 else client_core,
    )
    figures = run_load(table or table_files(data_dir), load)
    write_figures(json_out, figures)
    console.print_json(data=figures)
