"""`galewood serve`, beside the commands of precompute/cli.py."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Annotated

import typer

from precompute.cli import app


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
    from server.main import create_app, run
    from server.settings import Settings

    settings = Settings()
    run(create_app(settings), settings)


if __name__ == "__main__":
    app()
