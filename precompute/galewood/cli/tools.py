"""What the commands have in common: a bar that shows how far they are, figures, files."""

from __future__ import annotations

import json
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

console = Console(stderr=True)


def write_figures(path: Path | None, figures: dict[str, Any]) -> None:
    """Figures as JSON: to a file, if one was asked for."""
    if path is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(figures, indent=2, default=float) + "\n")


@contextmanager
def progress_bar() -> Generator[Progress]:
    """A live bar with the stage, the share done and the time left."""
    columns = (
        TextColumn("{task.description:<48}"),
        BarColumn(),
        TextColumn("{task.percentage:>3.0f} %"),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console) as bar:
        yield bar


OnProgress = Callable[[float, str], None]


def progress_reporter(bar: Progress) -> OnProgress:
    """A function that moves a new task of the bar: fraction done, and what is being done."""
    task = bar.add_task("Starting", total=1.0)

    def report(fraction: float, message: str) -> None:
        bar.update(task, completed=fraction, description=message)

    return report


def file_writer(folder: Path) -> Callable[[str, bytes], None]:
    """A function that writes files of a folder."""

    def write(name: str, content: bytes) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        folder.joinpath(name).write_bytes(content)

    return write


def without_frames(figures: dict[str, Any]) -> dict[str, Any]:
    """Figures without their long lists, for a screen."""
    return {
        key: without_frames(value) if isinstance(value, dict) else value
        for key, value in figures.items()
        if key != "error_by_frame"
    }
