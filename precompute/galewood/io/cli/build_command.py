"""`galewood build`: its options follow from the fields of ``galewood.pipeline.tables.BuildOptions``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from galewood.io.cli.request_options import Mesh, WoodFile, validated, with_options_of, wood_document
from galewood.io.cli.tools import (
    CacheDir,
    JsonOut,
    console,
    file_writer,
    print_doubts,
    print_error,
    print_warning,
    progress_bar,
    progress_reporter,
    write_figures,
)
from galewood.pipeline.tables import BuildOptions

if TYPE_CHECKING:
    from galewood.util import MeshError

Out = Annotated[
    Path, typer.Option(help="Table file to write; its mesh and its compliance file are written beside it.")
]
Artefacts = Annotated[
    Path | None,
    typer.Option(
        "--artefacts",
        file_okay=False,
        help="Folder for the pictures and the preliminary tables, written as soon as they exist.",
    ),
]


AllTrees = Annotated[
    bool,
    typer.Option(
        "--all-trees",
        help="Build every tree of a file with several: OUT-1.gwt, ... A failure does not stop the rest.",
    ),
]
TO_ANSWER = (
    "Choose with --wood-parts, --leaves, --drop, --up-axis or --height-m; `galewood check FILE --preview PNG`"
    " shows the tree. To accept it as it is: --accept."
)


@with_options_of(BuildOptions, without=("wood",))
def build(
    mesh: Mesh,
    out: Out,
    all_trees: AllTrees = False,
    wood_properties: WoodFile = None,
    artefacts: Artefacts = None,
    cache_dir: CacheDir = Path("data/cache"),
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Simulate a tree mesh and write its motion table, and the mesh that the table moves."""
    from galewood.util import MeshError

    options = validated(BuildOptions, {**chosen, "wood": wood_document(wood_properties)})
    jobs = [(options, out, artefacts, json_out)]
    try:
        if all_trees:
            jobs = _job_per_tree(mesh, options, out, artefacts, json_out)
    except MeshError as error:
        _fail(error)
    failed = 0
    for one, to, pictures, figures in jobs:
        try:
            _build_one(mesh, one, to, pictures, cache_dir, figures)
        except MeshError as error:
            failed += 1
            _fail(error, stop=len(jobs) == 1)
    if failed:
        print_error(f"{failed} of {len(jobs)} trees failed.")
        raise typer.Exit(1)


def _fail(error: MeshError, stop: bool = True) -> None:
    print_error(error.title, error.hint)
    if stop:
        raise typer.Exit(1) from None


def _job_per_tree(
    mesh: Path, options: BuildOptions, out: Path, artefacts: Path | None, json_out: Path | None
) -> list[tuple[BuildOptions, Path, Path | None, Path | None]]:
    """For each tree of the file its options and its files. The unit is that of the first. MeshError."""
    from galewood.formats import mesh_with_companions
    from galewood.tree import import_mesh_sandboxed

    first, _ = import_mesh_sandboxed(mesh_with_companions(mesh), mesh.name, options)
    trees, unit = first.report["trees"], first.report["unit"]["value"]
    console.print(f"{len(trees)} trees in the file")

    def numbered(path: Path | None, number: int) -> Path | None:
        return path and path.with_name(f"{path.stem}-{number}{path.suffix}")

    return [
        (
            options.model_copy(
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
    options: BuildOptions,
    out: Path,
    artefacts: Path | None,
    cache_dir: Path,
    json_out: Path | None,
) -> None:
    """Build one tree. MeshError."""
    from galewood.formats import mesh_with_companions
    from galewood.pipeline.results import bare_path, write_compliance
    from galewood.pipeline.stages import build_table
    from galewood.pipeline.tables import expected_motion, import_lines, motion_lines, tree_lines
    from galewood.solid.skinning import distortion_line
    from galewood.tree import TreeMesh
    from galewood.util import MeshError

    def report_import(tree: TreeMesh) -> None:
        expected = expected_motion(tree, options.own_wood, leaves=options.foliage == "leaf")
        for line in [*import_lines(tree.report), *motion_lines(expected, options.may_soften)]:
            console.print(line)
        print_doubts(tree.report)
        if tree.report["needs_review"]:
            title = "Nothing is computed before this is checked."
            raise MeshError("needs-review", "unsuitable", title, TO_ANSWER)

    with progress_bar() as bar:
        report = progress_reporter(bar)
        result = build_table(
            mesh_with_companions(mesh),
            mesh.name,
            options,
            progress=lambda now: report(now.fraction, now.message),
            cache_dir=cache_dir,
            publish=file_writer(artefacts) if artefacts else None,
            on_import=report_import,
        )
    out.parent.mkdir(parents=True, exist_ok=True)
    table = result.whole_table()
    out.write_bytes(table)
    out.with_suffix(".glb").write_bytes(result.render_glb)
    if result.bare_table:
        bare_path(out).write_bytes(result.bare_table)
        bare_path(out).with_suffix(".glb").write_bytes(result.render_glb)
    if result.compliance:
        write_compliance(out, result.compliance)
    write_figures(json_out, {**result.report, "table_bytes": len(table)})
    drawn = result.report["drawn"]
    told = [drawn, *(result.report["model"].get(name, {}) for name in ("rest_pose", "stiffness"))]
    for warning in [one[name] for one in told for name in ("warning", "note") if name in one]:
        print_warning("Warning:", str(warning))
    for line in tree_lines(result.report["tree"]):
        console.print(line)
    if line := distortion_line(drawn):
        console.print(line)
    seconds = sum(result.report["seconds"].values())
    console.print(f"{out}: {len(table) / 1e6:.1f} MB in {seconds:.0f} s")
    if result.bare_table:
        console.print(f"{bare_path(out)}: the same tree without its leaves")


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(build)
