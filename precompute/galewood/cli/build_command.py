"""`galewood build`: its options follow from the fields of ``galewood.options.BuildRequest``."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Annotated, Any

import typer
from pydantic import ValidationError

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

OLD_NAMES = {
    "target_tets": "--tets",
    "sampled_elements": "--elements",
    "design_speed_m_s": "--design-speed",
    "frames": "--wind-frames",
}
"""Options had these names before they followed the REST interface; they are still accepted."""
Mesh = Annotated[
    Path,
    typer.Argument(
        exists=True,
        dir_okay=False,
        help="GLB, OBJ, PLY or STL file, or the cylinders of a scanned tree (MAT, CSV).",
    ),
]
Out = Annotated[Path, typer.Option(help="Table file to write; the mesh it moves is written beside it.")]
WoodFile = Annotated[
    Path | None,
    typer.Option(exists=True, dir_okay=False, help="Constants of a wood of your own (docs/physics.md)."),
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
    from galewood.pipeline import bare_path, build_options, build_table, drawn_words, tree_lines
    from galewood.util import MeshError

    options = build_options(_request(chosen, wood))
    options = replace(
        options,
        reference_frames=reference_frames,
        fem=FemSettings(element="quadratic" if reference else "fitted"),
    )
    try:
        with progress_bar() as bar:
            report = progress_reporter(bar)
            result = build_table(
                mesh.read_bytes(),
                mesh.name,
                options,
                progress=lambda now: report(now.fraction, now.message),
                cache_dir=cache_dir,
                publish=file_writer(artefacts) if artefacts else None,
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
    of_model = [rest_pose[name] for name in ("warning", "note") if name in rest_pose]
    for warning in [*result.report["import"].get("warnings", []), *of_model]:
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

    given = {name: value for name, value in chosen.items() if value not in (None, [])}
    try:
        if wood is not None:
            given["wood"] = read_wood_document(wood.read_bytes())
        return BuildRequest.model_validate(given)
    except WoodError as error:
        problems = [f"{name}: {what}" for name, what in error.problems]
        console.print(f"[red]{wood} does not describe a wood.[/red]", *problems)
    except ValidationError as error:
        for item in error.errors():
            name = "--" + str(item["loc"][0]).replace("_", "-")
            console.print(f"[red]{name}[/red]: {item['msg']}")
    raise typer.Exit(1)


def _parameter(name: str, annotation: Any, default: Any = inspect.Parameter.empty) -> inspect.Parameter:
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation)


def _request_parameters() -> list[inspect.Parameter]:
    """An option for every field of the request, of the same name, with the same description and bounds."""
    found: list[inspect.Parameter] = []
    for name, field in BuildRequest.model_fields.items():
        if name == "wood":
            continue
        flag = name.replace("_", "-")
        switch = field.annotation == (bool | None)
        names = [f"--{flag}/--no-{flag}" if switch else f"--{flag}"]
        names += [OLD_NAMES[name]] if name in OLD_NAMES else []
        kind = list[str] | None if name == "wood_materials" else field.annotation
        option = typer.Option(*names, help=field.description)
        found.append(_parameter(name, Annotated[kind, option], None))
    return found


def register(app: typer.Typer) -> None:
    """Add the command to the program; typer reads its options from the signature made here."""
    parameters = [
        _parameter("mesh", Mesh),
        _parameter("out", Out),
        *_request_parameters(),
        _parameter("wood", WoodFile, None),
        _parameter("reference", Reference, False),
        _parameter("reference_frames", ReferenceFrames, 60),
        _parameter("artefacts", Artefacts, None),
        _parameter("cache_dir", CacheDir, Path("data/cache")),
        _parameter("json_out", JsonOut, None),
    ]
    build.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    build.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    app.command()(build)
