"""`galewood grow` and `galewood regrow`: individuals of the built-in species."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from galewood.io.cli.request_options import validated, with_options_of
from galewood.io.cli.tools import console, plain_errors
from galewood.options import IndividualRequest

if TYPE_CHECKING:
    from galewood.io.api import Individual

Out = Annotated[Path, typer.Option(dir_okay=False, help="Mesh to write (GLB).")]
TableOut = Annotated[
    Path | None,
    typer.Option(
        "--table",
        dir_okay=False,
        help="Its motion table as well, in seconds, from its own beams and the fitted motion of its species; "
        "the mesh that it moves is written beside it.",
    ),
]


@with_options_of(IndividualRequest)
def grow(
    species: Annotated[str, typer.Argument(help="A built-in species: oak, spruce, ...")],
    out: Out,
    table: TableOut = None,
    document: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False, help="Some hundred bytes (JSON) from which `galewood regrow` makes both again."
        ),
    ] = None,
    **chosen: Any,
) -> None:
    """Grow a tree of a species: size as asked, branches from the seed. Needs Node 20 or newer."""
    from galewood.io.api import grow as grow_individual

    request = validated(IndividualRequest, chosen)
    with plain_errors():
        individual = grow_individual(species, **request.model_dump())
        _write(individual, out, table)
    if document is not None:
        document.parent.mkdir(parents=True, exist_ok=True)
        document.write_bytes(individual.document())


def regrow(
    document: Annotated[
        Path, typer.Argument(exists=True, dir_okay=False, help="What `galewood grow --document` wrote.")
    ],
    out: Out,
    table: TableOut = None,
) -> None:
    """Grow an individual again from its document: the same mesh and table. Needs Node 20 or newer."""
    from galewood.io.api import regrow as regrow_individual

    with plain_errors():
        _write(regrow_individual(document.read_bytes()), out, table)


def _write(individual: Individual, out: Path, table: Path | None) -> None:
    if table is not None and table.with_suffix(".glb") == out:
        raise ValueError("the mesh beside the table would replace the grown one: choose another name for one")
    out.parent.mkdir(parents=True, exist_ok=True)
    individual.save(out)
    branches = int(individual.skeleton.branch.max()) + 1
    console.print(f"{out}: {individual.name}, {branches} branches, {len(individual.glb) / 1e6:.2f} MB")
    if table is not None:
        made = individual.table()
        table.parent.mkdir(parents=True, exist_ok=True)
        made.save(table)
        console.print(
            f"{table}: first frequency {made.frequencies_hz[0]:.2f} Hz, {len(made.data) / 1e6:.2f} MB"
        )


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command()(grow)
    app.command()(regrow)
