"""Helpers of the commands: progress bar, result files."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator, Iterable, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from galewood.options import METHOD_HELP, Method

JsonOut = Annotated[Path | None, typer.Option("--json", help="Write the figures to this file.")]
CacheDir = Annotated[Path, typer.Option(help="Folder for meshes and training runs, reused by later runs.")]
SpeciesDir = Annotated[
    Path, typer.Option(exists=True, file_okay=False, help="Folder of the built-in trees: poplar.glb, ...")
]
MethodOption = Annotated[Method, typer.Option(help=METHOD_HELP)]
console = Console(stderr=True, markup=False, highlight=False)
"""Prints texts as they are: names and messages may contain square brackets, which are markup to Rich."""


def write_figures(path: Path | None, figures: dict[str, Any]) -> None:
    """Write results as JSON to ``path``; None: nothing."""
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(figures, indent=2, default=float) + "\n")


def write_plot(path: Path, figure: Any) -> None:
    """Write a figure of matplotlib; exits with a sentence if the name has another ending than a picture."""
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        figure.savefig(path, dpi=110)
    except ValueError as error:
        print_error(f"{path.name} was not written: {error}.")
        raise typer.Exit(1) from None


def print_error(what: str, *details: str) -> None:
    """Print what is wrong in red, and what to do after it; not wrapped, so that commands can be copied."""
    console.print(Text(what, "red"), *details, soft_wrap=True)


@contextmanager
def plain_errors() -> Generator[None]:
    """Prints what is wrong with a file, a tree or an option, and exits."""
    from galewood.util import MeshError

    try:
        yield
    except MeshError as error:
        print_error(error.title, error.hint)
    except (ValueError, ArithmeticError) as error:
        print_error(f"{str(error).removesuffix('.')}.")
    else:
        return
    raise typer.Exit(1)


def print_warning(what: str, *details: str) -> None:
    """The same in yellow."""
    console.print(Text(what, "yellow"), *details, soft_wrap=True)


def print_doubts(report: Mapping[str, Any]) -> None:
    """Print the warnings and the questions of an import."""
    for word, texts in (("Warning", report["warnings"]), ("Please check", report["questions"])):
        for text in texts:
            print_warning(f"{word}:", text)


def print_report(figures: Mapping[str, str], notes: Iterable[str]) -> None:
    """Print how a file was interpreted."""
    for line in [*(f"{name}: {value}" for name, value in figures.items()), *notes]:
        print(line)


@contextmanager
def progress_bar() -> Generator[Progress]:
    """A live bar with the stage, the completed share and the remaining time."""
    columns = (
        TextColumn("{task.description:<48}", markup=False),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as bar:
        yield bar
        for task in bar.tasks:
            bar.update(task.id, completed=task.total)


OnProgress = Callable[[float, str], None]


def progress_reporter(bar: Progress) -> OnProgress:
    """A callback that updates a new task of the bar: completed fraction 0..1, and a message."""
    task = bar.add_task("Starting", total=1.0)

    def report(fraction: float, message: str) -> None:
        bar.update(task, completed=fraction, description=message)

    return report


def file_writer(folder: Path) -> Callable[[str, bytes], None]:
    """A callback that writes a file by name into ``folder``, which it creates when needed."""

    def write(name: str, content: bytes) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        folder.joinpath(name).write_bytes(content)

    return write


def without_frames(figures: dict[str, Any]) -> dict[str, Any]:
    """Results without their per-frame lists, short enough for a terminal."""
    return {
        key: without_frames(value) if isinstance(value, dict) else value
        for key, value in figures.items()
        if key != "error_by_frame"
    }
