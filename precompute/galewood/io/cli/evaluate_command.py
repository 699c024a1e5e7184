"""`galewood evaluate`: its options follow from the fields of ``galewood.options.EvaluationOptions``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import typer

from galewood.io.cli.request_options import validated, with_options_of
from galewood.io.cli.tools import (
    CacheDir,
    JsonOut,
    console,
    print_error,
    progress_bar,
    progress_reporter,
    without_frames,
    write_figures,
)
from galewood.options import EvaluationOptions
from galewood.packaged import species_folder


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(evaluate)


@with_options_of(EvaluationOptions, defaults={"converged": True})
def evaluate(
    table: Annotated[str, typer.Argument(help="Table file, or the name of a built-in tree.")],
    mesh: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Mesh of the table; default: TABLE with .glb."),
    ] = None,
    model: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            dir_okay=False,
            help="Model file (.npz); default: found in the cache, or built again.",
        ),
    ] = None,
    plot: Annotated[Path | None, typer.Option(help="Plot of the errors over time to write.")] = None,
    cache_dir: CacheDir = Path("data/cache"),
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Compare a table with the finite-element model it was made from: in gusts, then in uniform winds."""
    from galewood.check.evaluation import SourceError, run_evaluation, sentences
    from galewood.util import MeshError

    options = validated(EvaluationOptions, chosen)
    try:
        files = _files(table, cache_dir)
        with progress_bar() as bar:
            report = progress_reporter(bar)
            figures = run_evaluation(
                files.table, mesh or files.mesh, model, options, cache_dir, report, plot=plot
            )
    except (MeshError, SourceError, FileNotFoundError) as error:
        print_error(str(error))
        raise typer.Exit(1) from None
    write_figures(json_out, figures)
    for sentence in sentences(figures):
        console.print(sentence, soft_wrap=True)
    console.print_json(data=without_frames(figures))


@dataclass(frozen=True)
class _Files:
    table: Path
    mesh: Path | None
    """None: beside the table."""


def _files(name: str, cache_dir: Path) -> _Files:
    """A table file, or that of a built-in tree with its mesh. Raises FileNotFoundError."""
    if Path(name).is_file():
        return _Files(Path(name), None)
    from galewood.pipeline.stages import builtin_meshes, unpacked

    folder = species_folder()
    meshes = {mesh.name: mesh for mesh in builtin_meshes(folder)}
    if name not in meshes:
        raise FileNotFoundError(f"{name} is neither a file nor a built-in tree ({', '.join(meshes)})")
    return _Files(unpacked(meshes[name], folder, cache_dir), meshes[name].path)
