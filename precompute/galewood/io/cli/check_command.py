"""`galewood check`: reads a mesh as a build does and reports what it found, before anything is computed."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from galewood.io.cli.request_options import Mesh, validated, with_options_of
from galewood.io.cli.tools import JsonOut, console, print_doubts, print_error, write_figures
from galewood.options import ImportRequest

WITH_WARNINGS = 3
"""Exit code of --strict if there are warnings."""
Preview = Annotated[
    Path | None,
    typer.Option(
        dir_okay=False,
        help="Draw the imported tree to this PNG file, wood that was added in blue, and beside it what was "
        "detected: wood brown, leaves green, left out red, unsure hatched.",
    ),
]
Strict = Annotated[
    bool, typer.Option("--strict", help=f"Exit with code {WITH_WARNINGS} if there are warnings or questions.")
]
PREVIEW_PX = 768


@with_options_of(ImportRequest)
def check(
    mesh: Mesh, preview: Preview = None, strict: Strict = False, json_out: JsonOut = None, **chosen: Any
) -> None:
    """Inspect a tree mesh: parts, assumptions, warnings, first frequency and expected sway.

    Exit codes: 0 read, 1 cannot be used, 2 wrong options, 3 read with warnings or questions (with --strict).
    """
    from galewood.formats import mesh_with_companions
    from galewood.pipeline.pictures import check_picture, draw_limited
    from galewood.pipeline.tables import EXPECTED_MOTION, import_lines, motion_lines
    from galewood.tree import import_mesh_sandboxed
    from galewood.util import MeshError

    options = validated(ImportRequest, chosen)
    data = mesh_with_companions(mesh)
    try:
        tree, glb = import_mesh_sandboxed(data, mesh.name, options, then=EXPECTED_MOTION)
        if preview is not None:
            preview.parent.mkdir(parents=True, exist_ok=True)
            drawn = draw_limited(glb, PREVIEW_PX, tree.added_wood())
            preview.write_bytes(check_picture(drawn, data, mesh.name, options, PREVIEW_PX))
    except MeshError as error:
        print_error(error.title, error.hint)
        raise typer.Exit(1) from None
    write_figures(json_out, tree.report)
    for line in [*import_lines(tree.report), *motion_lines(tree.report["expected"])]:
        console.print(line)
    print_doubts(tree.report)
    if strict and (tree.report["warnings"] or tree.report["needs_review"]):
        raise typer.Exit(WITH_WARNINGS)


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(check)
