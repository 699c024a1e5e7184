"""Commands of the service say in a sentence what is missing: packages, or correct settings."""

from __future__ import annotations

from collections.abc import Generator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NoReturn

import typer
from galewood.io.cli import console

if TYPE_CHECKING:  # loaded only by the commands that need it
    from galewood_server.settings import Settings

OWN_PACKAGES = ("galewood", "galewood_server")
EXTRA_OF = {"psycopg": "distributed"}
"""Modules of another extra than `server`."""


@contextmanager
def needs_extras() -> Generator[None]:
    """Around the imports of a command of the service: a missing package ends it with what to install."""
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing in OWN_PACKAGES:
            raise
        extras = ",".join(("server", EXTRA_OF[missing]) if missing in EXTRA_OF else ("server",))
        end_with(
            f"This command needs {missing}: install galewood[{extras}], for instance with "
            f"pip install 'galewood[{extras}]'."
        )


def read_settings() -> Settings:
    """The settings from the environment. Ends the command with a sentence for each that is wrong."""
    from pydantic import ValidationError
    from pydantic_settings import SettingsError

    from galewood_server.settings import Settings

    try:
        return Settings()
    except ValidationError as error:
        end_with("\n".join(f"{_variable(one['loc'][0])}: {one['msg']}." for one in error.errors()))
    except SettingsError as error:
        end_with(f"A setting cannot be read: {error}. Lists are JSON, such as '[\"https://example.org\"]'.")


def end_with(sentence: str) -> NoReturn:
    """End a command with exit status 1 and a sentence that says why."""
    console.print(sentence, soft_wrap=True)
    raise typer.Exit(1) from None


def _variable(name: int | str) -> str:
    """The environment variable of a setting."""
    return str(name) if str(name).isupper() else f"GALEWOOD_{name}".upper()
