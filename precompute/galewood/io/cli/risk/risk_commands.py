"""`galewood critical-wind` and `galewood stand`: the gusts that break trees."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from galewood.io.cli.request_options import Mesh, WoodFile, validated, with_options_of, wood_document
from galewood.io.cli.risk.tree_bending import FOLIAGE_NAMES, OF_TREE, print_weight, progress_of, read_tree
from galewood.io.cli.tools import (
    JsonOut,
    console,
    plain_errors,
    print_warning,
    write_figures,
)
from galewood.options import BuildRequest

if TYPE_CHECKING:  # loaded only by the commands that need it
    from galewood.solid.strain import CriticalWind, Rupture

FIRST_STEMS = 5
"""Stems that are printed; the report has all."""
WorstDirection = Annotated[
    float | None,
    typer.Option(help="Direction the wind blows towards, degrees; default: the worst of eight."),
]
KnotFactor = Annotated[
    float, typer.Option(min=0.05, max=1.0, help="Share of the strength of clear wood that knots leave.")
]
SampleCount = Annotated[int, typer.Option(min=0, max=10_000, help="Possible trees, for the uncertainty.")]
Seed = Annotated[int, typer.Option(help="Seed of the possible trees.")]


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
        read = read_tree(tree, options)
        leafy = any(part.kind == "leaves" for part in read.mesh.primitives)
        for foliage in ("leaf", "bare") if leafy else ("bare",):
            with progress_of(f"{tree.stem} {FOLIAGE_NAMES[foliage]}") as report:
                found = critical_wind_of(
                    read, foliage=foliage, wood=options.own_wood, options=asked, on_progress=report
                )
            figures[foliage] = found.figures()
            _print_critical(tree.stem, foliage, found)
    write_figures(json_out, figures)
    print_warning(CAUTION_TEXT)


def stand(
    inventory: Annotated[
        Path,
        typer.Argument(exists=True, dir_okay=False, help="CSV, GeoJSON, or an inventory document."),
    ],
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
        found = stand_risk(stems, foliage=foliage, options=options)
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


def _print_critical(name: str, foliage: str, found: CriticalWind) -> None:
    from galewood.solid.strain import STRONGEST_M_S

    def speed(value: float | None) -> str:
        if value is None:
            return "not assessed"
        return f"{value:.1f} m/s" if value <= STRONGEST_M_S else f"over {STRONGEST_M_S:g} m/s"

    def rupture(found: Rupture, what: str, indent: str) -> None:
        if quantiles := found.quantiles_m_s:
            low, median, high = quantiles
            console.print(f"{indent}median {speed(median)}; 10 to 90 %: {speed(low)} to {speed(high)}")
        if at := found.section:
            place = f", at x {at.x_m:.1f} m, z {at.z_m:.1f} m" if what == "bough" else ""
            console.print(
                f"{indent}there the strain of {at.strain:.4f} is reached {at.height_m:.1f} m up, where the "
                f"{what} is {at.diameter_cm:.1f} cm thick{place}",
                soft_wrap=True,
            )

    console.print(
        f"{name} {FOLIAGE_NAMES[foliage]}, wind towards {found.stem.direction_deg:g}°: breaks at "
        f"{speed(found.gust_m_s)}"
    )
    rupture(found.stem, "stem", "  ")
    if found.breast_height_m_s is not None:
        console.print(
            f"  the same strain at 1.3 m: {speed(found.breast_height_m_s)}; with a U² from 5 to 15 m/s: "
            f"{speed(found.extrapolated_m_s)}"
        )
    console.print(f"  overturning: {speed(found.overturning_m_s)}")
    if found.boughs is None:
        console.print("  it has no boughs of 4 cm")
    else:
        console.print(
            f"  first bough of 4 cm and more, wind towards {found.boughs.direction_deg:g}°: breaks at "
            f"{speed(found.boughs.gust_m_s)}"
        )
        rupture(found.boughs, "bough", "    ")
    print_weight(found)


def register(app: typer.Typer) -> None:
    """Add the commands to the program."""
    app.command("critical-wind")(critical_wind)
    app.command()(stand)
