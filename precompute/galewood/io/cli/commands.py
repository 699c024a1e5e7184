"""The command line of the precomputation: check, build, field, strain, export, evaluate and more."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from galewood.io.cli.build_command import register as register_build
from galewood.io.cli.check_command import register as register_check
from galewood.io.cli.convert_command import register as register_convert
from galewood.io.cli.envelope_command import register as register_envelope
from galewood.io.cli.evaluate_command import register as register_evaluate
from galewood.io.cli.export_command import register as register_export
from galewood.io.cli.field_commands import register as register_field
from galewood.io.cli.grow_command import register as register_grow
from galewood.io.cli.motion_command import register as register_motion
from galewood.io.cli.request_options import validated, with_options_of
from galewood.io.cli.risk.risk_commands import register as register_risk
from galewood.io.cli.risk.strain_command import register as register_strain
from galewood.io.cli.tools import (
    CacheDir,
    JsonOut,
    MethodOption,
    SpeciesDir,
    console,
    print_error,
    progress_bar,
    progress_reporter,
    write_figures,
)
from galewood.io.cli.wind_options import WindOptions

if TYPE_CHECKING:  # loaded only by the commands that need it
    from galewood.pipeline.stages import BuiltinMesh

app = typer.Typer(no_args_is_help=True, add_completion=False, help="Simulate, store and play tree motion.")


register_check(app)
register_build(app)
register_evaluate(app)
register_export(app)
register_field(app)
register_motion(app)
register_strain(app)
register_risk(app)
register_envelope(app)
register_convert(app)
register_grow(app)


@app.command()
@with_options_of(WindOptions)
def simulate(
    table: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="Table file.")],
    seconds: Annotated[float, typer.Option(help="How long to play.")] = 20.0,
    trees: Annotated[int, typer.Option(help="Number of trees, 10 m apart.")] = 16,
    method: MethodOption = "modal",
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Play a table in a wind and report how far its trees sway."""
    from galewood.player import play
    from galewood.table import decode

    try:
        wind = validated(WindOptions, chosen).chosen()
    except (OSError, ValueError) as error:
        print_error("This is not a valid wind.", str(error))
        raise typer.Exit(1) from None
    figures = play(decode(table.read_bytes()), wind, seconds, trees, method)
    write_figures(json_out, figures)
    console.print_json(data=figures)


@app.command()
def paper(
    out: Annotated[
        Path, typer.Option(help="Document to write; its pictures go into a folder of the same name.")
    ] = Path("docs/paper.md"),
    species_dir: SpeciesDir = Path("assets/species"),
    quick: Annotated[bool, typer.Option(help="One small tree and few frames, to try the command.")] = False,
    workers: Annotated[int, typer.Option(help="Processes for the finite-element simulations.")] = 2,
    cache_dir: CacheDir = Path("data/cache"),
    json_out: JsonOut = None,
) -> None:
    """Repeat every experiment of the paper and write the results next to the paper's own figures."""
    from galewood.check.paper import full_plan, quick_plan, run_paper

    plan = full_plan(species_dir, cache_dir, workers)
    if quick:
        plan = quick_plan(plan.meshes[0], cache_dir)
    with progress_bar() as bar:
        figures = run_paper(plan, out, progress_reporter(bar))
    write_figures(json_out, figures)
    console.print(f"Wrote {out} and its pictures")


@app.command()
def bench(
    parts: Annotated[
        list[str] | None,
        typer.Argument(help="fem, samples, upload, build, lookup, modal, wind; default: all."),
    ] = None,
    mesh: Annotated[Path, typer.Option(exists=True, dir_okay=False, help="Tree mesh to use.")] = Path(
        "assets/species/poplar.glb"
    ),
    table: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Table for the part modal; otherwise it builds one."),
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Fewer frames, extrapolated.")] = False,
    json_out: JsonOut = None,
) -> None:
    """Measure FEM steps, samples, an upload, a build by stage, the search, steps of a forest, the wind."""
    from galewood.check.bench import chosen_parts, run_bench, sentences

    try:
        chosen = chosen_parts(parts or ())
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    with progress_bar() as bar:
        figures = run_bench(mesh, chosen, quick=quick, table=table, on_progress=progress_reporter(bar))
    write_figures(json_out, figures)
    for sentence in sentences(figures):
        print(sentence)


@app.command()
def verify(
    quick: Annotated[bool, typer.Option(help="Elements, bars and poles only, no species.")] = False,
    species_dir: SpeciesDir = Path("assets/species"),
    shipped: Annotated[
        bool, typer.Option("--shipped", help="Only the shipped tables: build each again and compare.")
    ] = False,
    docs: Annotated[Path | None, typer.Option(help="Markdown page whose table of checks to rewrite.")] = None,
    cache_dir: CacheDir = Path("data/cache"),
    json_out: JsonOut = None,
) -> None:
    """Check the finite elements against exact solutions, a beam frame, another program and each other."""
    from galewood.check.verify import Scope, insert_table, run_checks

    scope = Scope(
        species_dir=None if quick else species_dir,
        cache_dir=cache_dir,
        shipped=species_dir if shipped else None,
    )
    with console.status("Checking"):
        figures = run_checks(scope, lambda check: console.print(check.line()))
    write_figures(json_out, figures)
    if docs is not None:
        docs.write_text(insert_table(docs.read_text(), figures["markdown"]))
    console.print(f"{'all passed' if figures['passed'] else 'FAILED'} in {figures['seconds']:.0f} s")
    if not figures["passed"]:
        raise typer.Exit(1)


@app.command()
def ship(
    names: Annotated[
        list[str] | None, typer.Argument(help="Built-in trees; none: those out of date.")
    ] = None,
    species_dir: SpeciesDir = Path("assets/species"),
    cache_dir: CacheDir = Path("data/cache"),
) -> None:
    """Build the tables that are distributed with the built-in trees, where they are out of date.

    Then write light copies of their meshes, if any has none, and the bending of the trees (for stands) and
    their motion without dimensions (for individuals), if they are out of date.
    """
    from galewood.check.stand import ship_forms
    from galewood.io.cli.builtin_form import builtin_form
    from galewood.pipeline.individuals import ship_motions
    from galewood.pipeline.results import LIGHT_FOLDER, SHIPPED_FOLDER
    from galewood.pipeline.stages import builtin_meshes, outdated, ship_light

    meshes = {mesh.name: mesh for mesh in builtin_meshes(species_dir)}
    unknown = set(names or ()) - set(meshes)
    if unknown:
        raise typer.BadParameter(f"unknown tree {sorted(unknown)[0]!r}; known: {', '.join(meshes)}")
    chosen = [meshes[name] for name in names] if names else list(outdated(species_dir))
    for mesh in chosen:
        _ship(mesh, species_dir, cache_dir)
        console.print(f"{mesh.name}: written to {species_dir / SHIPPED_FOLDER}")
    if not chosen:
        console.print("All shipped tables are up to date.")
    if ship_light(species_dir):
        console.print(f"light meshes: written to {species_dir / LIGHT_FOLDER}")
    with console.status("Bending the trees"):
        bent = ship_forms(species_dir, builtin_form)
    if bent:
        console.print(f"bending of the trees: written to {species_dir / SHIPPED_FOLDER}")
    with console.status("Comparing the trees with beams"):
        moved = ship_motions(species_dir)
    if moved:
        console.print(f"motion without dimensions: written to {species_dir / SHIPPED_FOLDER}")


def _ship(mesh: BuiltinMesh, species_dir: Path, cache_dir: Path) -> None:
    from galewood.pipeline.results import SHIPPED_FOLDER
    from galewood.pipeline.stages import ship as ship_tree

    with progress_bar() as bar:
        report = progress_reporter(bar)
        folder = species_dir / SHIPPED_FOLDER
        ship_tree(mesh, folder, cache_dir, lambda progress: report(progress.fraction, progress.message))


@app.command("compile")
def compile_command() -> None:
    """Compile the numeric kernels now; otherwise the first build does, which then takes much longer."""
    from galewood.pipeline.stages import compile_kernels

    with progress_bar() as bar:
        report = progress_reporter(bar)
        compile_kernels(lambda fraction: report(fraction, "Compiling the numeric kernels"))
