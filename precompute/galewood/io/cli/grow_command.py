"""`galewood grow`: an individual of a built-in species."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from galewood.io.cli.request_options import validated, with_options_of
from galewood.io.cli.tools import console, plain_errors
from galewood.options import IndividualRequest


@with_options_of(IndividualRequest)
def grow(
    species: Annotated[str, typer.Argument(help="A built-in species: oak, spruce, ...")],
    out: Annotated[Path, typer.Option(dir_okay=False, help="Mesh to write (GLB).")],
    **chosen: Any,
) -> None:
    """Grow a tree of a species: size as asked, branches from the seed. Needs Node 20 or newer."""
    from galewood.io.api import grow as grow_individual

    request = validated(IndividualRequest, chosen)
    with plain_errors():
        individual = grow_individual(species, **request.model_dump())
        out.parent.mkdir(parents=True, exist_ok=True)
        individual.save(out)
    branches = int(individual.skeleton.branch.max()) + 1
    console.print(f"{out}: {individual.name}, {branches} branches, {len(individual.glb) / 1e6:.2f} MB")


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(grow)
