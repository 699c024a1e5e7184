"""`galewood strain`, `galewood critical-wind` and `galewood stand`: what trees bear in wind."""

from __future__ import annotations

import csv
from collections.abc import Callable, Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from galewood.io.cli.request_options import Mesh, WoodFile, validated, with_options_of, wood_document
from galewood.io.cli.tools import (
    JsonOut,
    console,
    plain_errors,
    print_warning,
    progress_bar,
    progress_reporter,
    write_figures,
)
from galewood.options import BuildRequest

if TYPE_CHECKING:  # loaded only by the commands that need it
    from galewood.io.api import Tree
    from galewood.solid.strain import CriticalWind, TreeStrain

OF_TREE = ("species", "height_m", "dbh_cm", "min_radius_mm", "up_axis")
FIRST_STEMS = 5
"""Stems that are printed; the report has all."""
UNCHANGED_WEIGHT = 0.95
"""Share of the weight below which a warning says that it was changed, as in the report of a build."""
PART_NAMES: dict[Literal["stem", "boughs"], str] = {"stem": "stem", "boughs": "boughs of 4 cm and more"}
FOLIAGE_NAMES = {"leaf": "in leaf", "bare": "bare"}
CSV_COLUMNS = ("height_m", "x_m", "z_m", "branch", "part", "diameter_cm", "moment_nm", "strain", "stress_mpa")
Heading = Annotated[
    float, typer.Option("--direction", help="Direction the wind blows towards, degrees (0: x, 90: z).")
]


WorstDirection = Annotated[
    float | None,
    typer.Option(help="Direction the wind blows towards, degrees; default: the worst of eight."),
]
KnotFactor = Annotated[
    float, typer.Option(min=0.05, max=1.0, help="Share of the strength of clear wood that knots leave.")
]
SampleCount = Annotated[int, typer.Option(min=0, max=10_000, help="Possible trees, for the uncertainty.")]
Seed = Annotated[int, typer.Option(help="Seed of the possible trees.")]


@with_options_of(BuildRequest, only=(*OF_TREE, "foliage"))
def strain(
    tree: Mesh,
    speed: Annotated[
        float, typer.Option(min=0.0, max=150.0, help="Wind at the top of the tree, m/s.")
    ] = 15.0,
    direction: Heading = 0.0,
    csv_out: Annotated[
        Path | None, typer.Option("--csv", dir_okay=False, help="Write all sections to this table.")
    ] = None,
    wood_properties: WoodFile = None,
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Report bending strain and stress of a tree in a steady wind: at 1.3 m, and where they are largest.

    For sound wood only, and no substitute for an inspection: not validated for decay, root damage or included
    bark.
    """
    from galewood.io.api import strain as strain_of
    from galewood.solid.strain import CAUTION_TEXT

    options = validated(BuildRequest, {**chosen, "wood": wood_document(wood_properties)})
    with plain_errors(), console.status(f"Bending {tree.stem}"):
        found = strain_of(
            _read(tree, options),
            wind_m_s=speed,
            direction_deg=direction,
            foliage=options.foliage,
            wood=options.own_wood,
        )
    write_figures(json_out, found.figures())
    if csv_out is not None:
        _write_sections(csv_out, found)
    console.print(f"{tree.stem} {FOLIAGE_NAMES[options.foliage]}, wind of {speed:g} m/s:")
    breast = found.breast_height_strain
    console.print(f"strain at 1.3 m: {'the tree is lower' if breast is None else f'{breast:.5f}'}")
    for part, name in PART_NAMES.items():
        if largest := found.largest(part):
            console.print(
                f"largest strain, {name}: {largest.strain:.5f} ({largest.stress_mpa:.1f} MPa), "
                f"{largest.height_m:.1f} m up, diameter {largest.diameter_cm:.1f} cm"
            )
    console.print(
        f"moment at the ground: {found.base_moment_nm / 1000:.3g} kN·m; the top moves by "
        f"{found.top_displacement_m:.2f} m"
    )
    _print_weight(found)
    print_warning(CAUTION_TEXT)


@with_options_of(BuildRequest, only=OF_TREE)
def critical_wind(
    tree: Mesh,
    direction: WorstDirection = None,
    knot_factor: KnotFactor = 1.0,
    root_strength_knm: Annotated[
        float | None,
        typer.Option(min=0.001, help="Largest moment the roots resist, kN·m; default: not assessed."),
    ] = None,
    samples: SampleCount = 200,
    seed: Seed = 1,
    wood_properties: WoodFile = None,
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Report the gust speed that breaks a tree, in leaf and bare, with its uncertainty.

    For sound wood only, and no substitute for an inspection: not validated for decay, root damage or included
    bark.
    """
    from galewood.io.api import critical_wind as critical_wind_of
    from galewood.solid.strain import CAUTION_TEXT, CriticalOptions

    options = validated(BuildRequest, {**chosen, "wood": wood_document(wood_properties)})
    figures: dict[str, Any] = {}
    with plain_errors():
        asked = CriticalOptions(
            direction_deg=direction,
            knot_factor=knot_factor,
            root_strength_knm=root_strength_knm,
            sample_count=samples,
            seed=seed,
        )
        read = _read(tree, options)
        leafy = any(part.kind == "leaves" for part in read.mesh.primitives)
        for foliage in ("leaf", "bare") if leafy else ("bare",):
            with _progress(f"{tree.stem} {FOLIAGE_NAMES[foliage]}") as report:
                found = critical_wind_of(
                    read, foliage=foliage, wood=options.own_wood, options=asked, on_progress=report
                )
            figures[foliage] = found.figures()
            _print_critical(tree.stem, foliage, found)
    write_figures(json_out, figures)
    print_warning(CAUTION_TEXT)


def stand(
    inventory: Annotated[Path, typer.Argument(exists=True, dir_okay=False, help="CSV or GeoJSON of stems.")],
    out: Annotated[
        Path, typer.Option(dir_okay=False, help="Report to write: .csv, .html (to print), .geojson or .json.")
    ] = Path("stand-report.html"),
    speed: Annotated[
        float, typer.Option(min=0.1, max=100.0, help="Gust in which sway and strain are reported, m/s.")
    ] = 20.0,
    direction: WorstDirection = None,
    foliage: Annotated[Literal["leaf", "bare"], typer.Option(help="In leaf, or bare as in winter.")] = "leaf",
    sheltered: Annotated[
        bool, typer.Option(help="Whether stems shelter each other; otherwise each stands in the open.")
    ] = True,
    knot_factor: KnotFactor = 1.0,
    samples: SampleCount = 100,
    seed: Seed = 1,
) -> None:
    """Report which stems of an inventory break first in wind, and how far each sways.

    For sound wood only, and no substitute for an inspection: not validated for decay, root damage or included
    bark.
    """
    from galewood.check.stand import StandOptions, check_writable, write_report
    from galewood.io.api import stand_risk
    from galewood.measurements import read_inventory
    from galewood.solid.strain import CAUTION_TEXT

    options = StandOptions(
        wind_m_s=speed,
        direction_deg=direction,
        sheltered=sheltered,
        knot_factor=knot_factor,
        sample_count=samples,
        seed=seed,
    )
    with plain_errors():
        stems = read_inventory(inventory)
        check_writable(stems, out)
        with _progress("Bending the built-in trees") as report:
            found = stand_risk(stems, foliage=foliage, options=options, on_progress=report)
        write_report(found, out)
    for stem in found.stems[:FIRST_STEMS]:
        gust = f"{stem.critical_m_s:.1f}" if stem.critical_m_s < float("inf") else "over 100"
        console.print(
            f"{stem.rank}. line {stem.line}, {stem.species or 'unknown species'}, {stem.height_m:.1f} m, "
            f"{stem.dbh_cm:.3g} cm, "
            f"{stem.edge_distance_m:.0f} m from the edge: breaks at {gust} m/s",
            soft_wrap=True,
        )
    console.print(f"{out}: {len(found.stems)} {'stem' if len(found.stems) == 1 else 'stems'}")
    for text in (*found.assumptions, CAUTION_TEXT):
        print_warning(text)


@contextmanager
def _progress(what: str) -> Generator[Callable[[float], None]]:
    with progress_bar() as bar:
        report = progress_reporter(bar)
        report(0.0, what)
        yield lambda share: report(share, what)


def _read(path: Path, options: BuildRequest) -> Tree:
    from galewood.io.api import read

    given = {name: getattr(options, name) for name in OF_TREE}
    return read(path, **given)


def _write_sections(path: Path, found: TreeStrain) -> None:
    from galewood.solid.strain import CAUTION_TEXT

    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        file.write(f"# {CAUTION_TEXT}\n")
        table = csv.writer(file)
        table.writerow(CSV_COLUMNS)
        for k, (x, y, z) in enumerate(found.place_m):
            part = "stem" if found.stem[k] else "bough" if found.bough[k] else "thin"
            row = (100 * found.diameter_m[k], found.moment_nm[k], found.strain[k], found.stress_pa[k] / 1e6)
            named = [f"{v:.4g}" for v in (y, x, z)] + [str(found.branch[k]), part]
            table.writerow(named + [f"{v:.5g}" for v in row])


def _print_critical(name: str, foliage: str, found: CriticalWind) -> None:
    def speed(value: float | None) -> str:
        if value is None:
            return "not assessed"
        return f"{value:.1f} m/s" if value < float("inf") else "over 100 m/s"

    console.print(
        f"{name} {FOLIAGE_NAMES[foliage]}, wind towards {found.direction_deg:g}°: breaks at "
        f"{speed(found.gust_m_s)}"
    )
    if quantiles := found.quantiles_m_s:
        low, median, high = quantiles
        console.print(f"  median {speed(median)}; 10 to 90 %: {speed(low)} to {speed(high)}")
    if section := found.section:
        console.print(
            f"  there the strain of {section.strain:.4f} is reached {section.height_m:.1f} m up, where the "
            f"stem is {section.diameter_cm:.1f} cm thick"
        )
    if found.breast_height_m_s is not None:
        console.print(
            f"  the same strain at 1.3 m: {speed(found.breast_height_m_s)}; with a U² from 5 to 15 m/s: "
            f"{speed(found.extrapolated_m_s)}"
        )
    console.print(f"  overturning: {speed(found.overturning_m_s)}")
    _print_weight(found)


def _print_weight(found: CriticalWind | TreeStrain) -> None:
    if found.weight_share < UNCHANGED_WEIGHT:
        print_warning(
            f"The tree bears {found.load_factor:.0%} of its buckling load; few real trees bear more than a "
            f"third. So only {found.weight_share:.0%} of its weight acts. Check radii, height and leaves."
        )


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command()(strain)
    app.command("critical-wind")(critical_wind)
    app.command()(stand)
