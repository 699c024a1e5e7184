"""`galewood build`: its options follow from the fields of ``galewood.options.BuildRequest``."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Annotated, Any

import typer

from galewood.cli.request_options import Mesh, named_parameter, request_parameters, validated
from galewood.cli.tools import (
    CacheDir,
    JsonOut,
    console,
    file_writer,
    progress_bar,
    progress_reporter,
    write_figures,
)
from galewood.options import BuildRequest

Out = Annotated[Path, typer.Option(help="Table file to write; the mesh it moves is written beside it.")]
WoodFile = Annotated[
    Path | None,
    typer.Option(
        "--wood-constants",
        exists=True,
        dir_okay=False,
        help="Constants of a wood of your own (docs/physics.md); `--wood FILE.json` is also accepted.",
    ),
]
Reference = Annotated[
    bool,
    typer.Option("--reference", help="Use the quadratic reference elements: about ten times as slow."),
]
ReferenceFrames = Annotated[
    int,
    typer.Option(
        "--reference-frames",
        "--compared-frames",
        min=0,
        help="Frames of the run that is compared with the reference elements; 0: no comparison.",
    ),
]
Artefacts = Annotated[
    Path | None,
    typer.Option(
        "--artefacts",
        "--pictures",
        file_okay=False,
        help="Folder for the pictures and the preliminary tables, written as soon as they exist.",
    ),
]


def build(
    mesh: Path,
    out: Path,
    wood: Path | None,
    reference: bool,
    reference_frames: int,
    artefacts: Path | None,
    cache_dir: Path,
    json_out: Path | None,
    **chosen: Any,
) -> None:
    """Simulate a tree mesh and write its motion table, and the mesh that the table moves."""
    from dataclasses import replace

    from galewood.fem import FemSettings
    from galewood.mesh import TreeMesh, mesh_with_companions
    from galewood.pipeline import (
        bare_path,
        build_options,
        build_table,
        drawn_words,
        expected_motion,
        import_lines,
        motion_lines,
        tree_lines,
    )
    from galewood.util import MeshError

    options = build_options(_request(chosen, wood))
    options = replace(
        options,
        reference_frames=reference_frames,
        fem=FemSettings(element="quadratic" if reference else "fitted"),
    )

    def tell(tree: TreeMesh) -> None:
        for line in [*import_lines(tree.report), *motion_lines(expected_motion(tree, options.wood))]:
            console.print(line, highlight=False, markup=False)
        for warning in tree.report["warnings"]:
            console.print(f"[yellow]Warning:[/yellow] {warning}")

    try:
        with progress_bar() as bar:
            report = progress_reporter(bar)
            result = build_table(
                mesh_with_companions(mesh),
                mesh.name,
                options,
                progress=lambda now: report(now.fraction, now.message),
                cache_dir=cache_dir,
                publish=file_writer(artefacts) if artefacts else None,
                on_import=tell,
            )
    except MeshError as error:
        console.print(f"[red]{error.title}[/red] {error.hint}")
        raise typer.Exit(1) from None
    out.parent.mkdir(parents=True, exist_ok=True)
    table = result.whole_table()
    out.write_bytes(table)
    out.with_suffix(".glb").write_bytes(result.render_glb)
    if result.bare_table:
        bare_path(out).write_bytes(result.bare_table)
        bare_path(out).with_suffix(".glb").write_bytes(result.render_glb)
    write_figures(json_out, {**result.report, "table_bytes": len(table)})
    rest_pose = result.report["model"]["rest_pose"]
    for warning in [rest_pose[name] for name in ("warning", "note") if name in rest_pose]:
        console.print(f"[yellow]Warning:[/yellow] {warning}")
    for line in tree_lines(result.report["tree"]):
        console.print(line)
    if words := drawn_words(result.report["drawn"]):
        console.print(words)
    seconds = sum(result.report["seconds"].values())
    console.print(f"{out}: {len(table) / 1e6:.1f} MB in {seconds:.0f} s")
    if result.bare_table:
        console.print(f"{bare_path(out)}: the same tree without its leaves")


def _request(chosen: dict[str, Any], wood: Path | None) -> BuildRequest:
    """The validated options; prints what is wrong, field by field, and exits."""
    from galewood.wood import WoodError, read_wood_document

    # --wood once named a file with constants only
    names: list[str] = chosen.get("wood_materials") or []
    files = [name for name in names if name.endswith(".json") and Path(name).is_file()]
    if files and wood is None:
        wood = Path(files[0])
        chosen = {**chosen, "wood_materials": [name for name in names if name not in files]}
    if wood is None:
        return validated(BuildRequest, chosen)
    try:
        return validated(BuildRequest, {**chosen, "wood": read_wood_document(wood.read_bytes())})
    except WoodError as error:
        problems = [f"{name}: {what}" for name, what in error.problems]
        console.print(f"[red]{wood} does not describe a wood.[/red]", *problems)
    raise typer.Exit(1)


def register(app: typer.Typer) -> None:
    """Add the command to the program; typer reads its options from the signature made here."""
    parameters = [
        named_parameter("mesh", Mesh),
        named_parameter("out", Out),
        *request_parameters(BuildRequest, without=("wood",)),
        named_parameter("wood", WoodFile, None),
        named_parameter("reference", Reference, False),
        named_parameter("reference_frames", ReferenceFrames, 60),
        named_parameter("artefacts", Artefacts, None),
        named_parameter("cache_dir", CacheDir, Path("data/cache")),
        named_parameter("json_out", JsonOut, None),
    ]
    build.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    build.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    app.command()(build)
