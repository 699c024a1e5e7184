"""`galewood field` and `galewood release`: models against measurements on real trees."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from galewood.io.cli.request_options import WoodFile, validated, with_options_of, wood_document
from galewood.io.cli.tools import (
    CacheDir,
    JsonOut,
    console,
    plain_errors,
    print_error,
    print_warning,
    progress_bar,
    progress_reporter,
    write_figures,
    write_plot,
)
from galewood.options import BuildRequest

OF_FIELD = ("min_radius_mm", "root_stiffness_knm", "target_tets")
"""Options of a build that apply to every tree of a folder."""
OF_RELEASE = ("species", "height_m", "foliage", *OF_FIELD)
Sway = Annotated[float, typer.Option(min=0.001, max=0.3, help="Sway to pull to, share of the height.")]


@with_options_of(BuildRequest, only=OF_FIELD)
def field(
    folder: Annotated[Path, typer.Argument(exists=True, file_okay=False, help="Folder of tree files.")],
    measurements: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="CSV table; default: the only one in the folder."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(file_okay=False, help="Folder to write; default: FOLDER/field-report.")
    ] = None,
    workers: Annotated[int, typer.Option(min=1, help="Processes, each for one tree at a time.")] = 1,
    damping: Annotated[bool, typer.Option(help="Pull and release every tree to find its damping.")] = True,
    sway: Sway = 0.03,
    wood_properties: WoodFile = None,
    cache_dir: CacheDir = Path("data/cache"),
    **chosen: Any,
) -> None:
    """Compare a folder of trees with a table of measured frequencies, damping, strains or critical winds."""
    from galewood.check.field import FieldError, FieldOptions, run_field

    options = FieldOptions(
        measurements=measurements,
        out=out,
        workers=workers,
        trees=validated(BuildRequest, {**chosen, "wood": wood_document(wood_properties)}),
        damping=damping,
        sway=sway,
        cache_dir=cache_dir,
    )
    try:
        with progress_bar() as bar:
            report = run_field(folder, options, progress_reporter(bar))
    except FieldError as error:
        print_error(str(error))
        raise typer.Exit(1) from None
    _print_report(report, out or folder / "field-report")
    if report["interrupted"]:
        raise typer.Exit(130)


def _print_report(report: dict[str, Any], out: Path) -> None:
    from galewood.solid.strain import CAUTION_TEXT

    for row in report["without_file"]:
        print_warning(f"{row['tree']} (line {row['line']}): {row['why']}")
    for tree in report["failed"]:
        print_error(f"{tree['tree']} failed: {tree['error']}")
    for found in report["frequency"].values():
        r2 = "–" if found["r2"] is None else f"{found['r2']:.2f}"
        console.print(
            f"{found['name']}: {found['trees']} trees, R² {r2}, median ratio {found['median_ratio']:.2f}, "
            f"RMS logarithmic error {found['rms_log_error']:.2f}"
        )
    for name, rows in report["bending"].items():
        for found in rows:
            if found["trees"]:
                r2 = "–" if found["r2"] is None else f"{found['r2']:.2f}"
                console.print(
                    f"{name}, {found['name']}: {found['trees']} trees, R² {r2}, median ratio "
                    f"{found['median_ratio']:.2f}, RMS logarithmic error {found['rms_log_error']:.2f}"
                )
    if report["bending"]:
        print_warning(CAUTION_TEXT)
    if report["damping"]["trees"]:
        found = report["damping"]
        console.print(f"damping ratio: {found['trees']} trees, median ratio {found['median_ratio']:.2f}")
    console.print(f"{out / 'report.html'}: {len(report['trees'])} trees")


@with_options_of(BuildRequest, only=OF_RELEASE)
def release(
    tree: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="Tree mesh or scan.")],
    sway: Sway = 0.03,
    cycles: Annotated[float, typer.Option(min=3, max=200, help="Periods to simulate.")] = 12.0,
    wood_properties: WoodFile = None,
    plot: Annotated[Path | None, typer.Option(help="Plot of the decay to write (PNG, SVG, PDF).")] = None,
    cache_dir: CacheDir = Path("data/cache"),
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Pull a tree at two thirds of its height, release it, and report its frequency and damping."""
    from galewood.check.field import decay_figure, pull_and_release, tree_of_file

    options = validated(BuildRequest, {**chosen, "wood": wood_document(wood_properties)})
    with plain_errors(), progress_bar() as bar:
        report = progress_reporter(bar)
        report(0.0, "Building the model")
        found = tree_of_file(tree, options, cache_dir)
        result = pull_and_release(
            found.fem, sway=sway, cycles=cycles, on_progress=lambda share: report(share, "Free decay")
        )
    if plot is not None:
        title = f"{tree.stem}, {'bare' if options.foliage == 'bare' else 'in leaf'}"
        write_plot(plot, decay_figure(result, title))
    figures = result.figures()
    write_figures(json_out, figures)
    console.print_json(data={name: value for name, value in figures.items() if name != "by_cycle"})


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command()(field)
    app.command()(release)
