"""Commands that need more than `pip install galewood` brings say so in a sentence."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager

import typer
from galewood.cli import console

OWN = ("galewood", "galewood_server")
EXTRA_OF = {"psycopg": "distributed"}
"""Modules of another extra than `server`."""


@contextmanager
def needs_extras() -> Generator[None]:
    """Around the imports of a command of the service: a missing package ends it with what to install."""
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing in OWN:
            raise
        extras = ",".join(("server", EXTRA_OF[missing]) if missing in EXTRA_OF else ("server",))
        console.print(
            f"This command needs {missing}: install galewood[{extras}], for instance with "
            f"pip install 'galewood[{extras}]'.",
            highlight=False,
            markup=False,
            soft_wrap=True,
        )
        raise typer.Exit(1) from None
