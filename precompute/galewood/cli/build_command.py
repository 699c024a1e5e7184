"""`galewood build`: its options follow from the fields of ``galewood.options.BuildRequest``."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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

if TYPE_CHECKING:
    from galewood.util import MeshError

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


AllTrees = Annotated[
    bool,
    typer.Option(
        "--all-trees",
        help="Build every tree of a file with several: OUT-1.gwt, OUT-2.gwt, ... A failure stops no other.",
    ),
]


def build(
    mesh: Path,
    out: Path,
    all_trees: bool,
    wood: Path | None,
    reference: bool,
    reference_frames: int,
    artefacts: Path | None,
    cache_dir: Path,
    json_out: Path | None,
    **chosen: Any,
) -> None:
    """Simulate a tree mesh and write its motion table, and the mesh that the table moves."""
    from galewood.util import MeshError

    request = _request(chosen, wood)
    jobs = [(request, out, artefacts, json_out)]
    try:
        if all_trees:
            jobs = _job_per_tree(mesh, request, out, artefacts, json_out)
    except MeshError as error:
        _fail(error)
    failed = 0
    for one, to, pictures, figures in jobs:
        try:
            _build_one(mesh, one, to, reference, reference_frames, pictures, cache_dir, figures)
        except MeshError as error:
            failed += 1
            _fail(error, stop=len(jobs) == 1)
    if failed:
        console.print(f"[red]{failed} of {len(jobs)} trees failed.[/red]")
        raise typer.Exit(1)


def _fail(error: MeshError, stop: bool = True) -> None:
    console.print(f"[red]{error.title}[/red] {error.hint}")
    if stop:
        raise typer.Exit(1) from None


def _job_per_tree(
    mesh: Path, request: BuildRequest, out: Path, artefacts: Path | None, json_out: Path | None
) -> list[tuple[BuildRequest, Path, Path | None, Path | None]]:
    """For each tree of the file its request and its files. The unit is that of the first. MeshError."""
    from galewood.mesh import import_mesh_sandboxed, mesh_with_companions
    from galewood.options import import_options

    first, _ = import_mesh_sandboxed(mesh_with_companions(mesh), mesh.name, import_options(request))
    trees, unit = first.report["trees"], first.report["unit"]["value"]
    console.print(f"{len(trees)} trees in the file")

    def numbered(path: Path | None, number: int) -> Path | None:
        return path and path.with_name(f"{path.stem}-{number}{path.suffix}")

    return [
        (
            request.model_copy(
                update={"tree": t["number"]}
                | ({"height_m": t["height_m"]} if unit in ("given", "unknown") else {})
            ),
            out.with_name(f"{out.stem}-{t['number']}{out.suffix}"),
            numbered(artefacts, t["number"]),
            numbered(json_out, t["number"]),
        )
        for t in trees
    ]


def _build_one(
    mesh: Path,
    request: BuildRequest,
    out: Path,
    reference: bool,
    reference_frames: int,
    artefacts: Path | None,
    cache_dir: Path,
    json_out: Path | None,
) -> None:
    """Build one tree. MeshError."""
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

    options = build_options(request)
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
        named_parameter("all_trees", AllTrees, False),
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
