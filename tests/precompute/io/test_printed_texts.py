"""Texts are printed as they are: square brackets are markup to Rich, and commands stay in one line."""

from __future__ import annotations

import io
from collections.abc import Callable
from typing import Any

import pytest
import typer
from galewood.io.cli import tools
from galewood.io.cli.request_options import validated, with_options_of
from galewood_server.cli.extras import end_with, needs_extras
from pydantic import BaseModel, Field, field_validator
from rich.console import Console
from typer.testing import CliRunner

COMMAND = "pip install 'galewood[usd]' [red]" + " and more" * 12


class Wordy(BaseModel):
    """A request whose help and whose error have brackets."""

    mesh: str = Field(default="tree.glb", description="Needs galewood[usd].")

    @field_validator("mesh")
    @classmethod
    def _refused(cls, value: str) -> str:
        raise ValueError(COMMAND)


def _bar() -> None:
    with tools.progress_bar() as bar:
        tools.progress_reporter(bar)(0.5, "oak[red].glb")


def _ends() -> None:
    with pytest.raises(typer.Exit):
        end_with(COMMAND)


def _lacks() -> None:
    with pytest.raises(typer.Exit), needs_extras():
        raise ModuleNotFoundError(name="psycopg")


def _refuses() -> None:
    with pytest.raises(typer.Exit):
        validated(Wordy, {"mesh": "oak"})


@pytest.mark.parametrize(
    ("prints", "expected"),
    [
        (lambda: tools.print_error(COMMAND), COMMAND),
        (lambda: tools.print_error("Wrong:", COMMAND), COMMAND),
        (lambda: tools.print_warning(COMMAND), COMMAND),
        (lambda: tools.print_doubts({"warnings": [COMMAND], "questions": []}), COMMAND),
        (_refuses, COMMAND),
        (_ends, COMMAND),
        (_lacks, "pip install 'galewood[server,distributed]'"),
        (_bar, "oak[red].glb"),
    ],
)
def test_square_brackets_are_printed_in_one_line(
    prints: Callable[[], Any], expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    stream = io.StringIO()
    own = tools.console
    monkeypatch.setattr(own, "_file", stream)
    monkeypatch.setattr(own, "_width", 80)
    assert isinstance(own, Console)
    prints()
    assert expected in stream.getvalue()


def test_help_keeps_the_square_brackets_of_options() -> None:
    program = typer.Typer(add_completion=False)

    @program.command()
    @with_options_of(Wordy)
    def run(**chosen: Any) -> None:
        """Runs."""

    assert "galewood[usd]" in CliRunner().invoke(program, ["--help"]).output


def test_usage_errors_keep_square_brackets() -> None:
    program = typer.Typer(add_completion=False)

    @program.command()
    def run() -> None:
        """Ends."""
        raise typer.BadParameter("pip install 'galewood[usd]'")

    assert "galewood[usd]" in CliRunner().invoke(program, []).output
