"""`galewood envelope`: how far a tree reaches in gusts, and its clearance to lines and façades."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from galewood.io.cli.tools import (
    JsonOut,
    console,
    plain_errors,
    progress_bar,
    progress_reporter,
    write_figures,
    write_plot,
)

if TYPE_CHECKING:  # loaded only by the command that needs it
    from galewood.check.envelope import Clearance, SwayEnvelope


def envelope(
    table: Annotated[
        Path, typer.Argument(exists=True, dir_okay=False, help="Table file, its mesh beside it.")
    ],
    speed: Annotated[
        float | None, typer.Option(min=0.1, max=60.0, help="Mean wind at 10 m, m/s; or give --winds.")
    ] = None,
    direction: Annotated[
        float, typer.Option(help="Direction the wind blows towards, degrees (0: x, 90: z).")
    ] = 0.0,
    winds: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="Table of hourly winds: time, speed, direction."),
    ] = None,
    lines: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="GeoJSON of lines and façades, with height_m."),
    ] = None,
    at: Annotated[
        str, typer.Option(help="Place of the tree in the coordinates of the lines: x,y or lon,lat.")
    ] = "0,0",
    samples: Annotated[int, typer.Option(min=1, max=1000, help="Trees in the gusts of each wind.")] = 16,
    plot: Annotated[Path | None, typer.Option(help="Plot to write (PNG, SVG, PDF).")] = None,
    json_out: JsonOut = None,
) -> None:
    """Report how far a tree reaches in gusts by height and direction, and its clearance to lines."""
    from galewood.check.envelope import clearances, envelope_figure, read_lines
    from galewood.io.api import load, sway_envelope

    with plain_errors():
        found_lines = read_lines(lines, _place(at)) if lines else []
        with progress_bar() as bar:
            report = progress_reporter(bar)
            found = sway_envelope(
                load(table), wind_m_s=speed, direction_deg=direction, winds=winds, sample_count=samples,
                on_progress=lambda share: report(share, "Gusts"),
            )  # fmt: skip
    _print_envelope(found)
    clear = clearances(found, found_lines)
    for one in clear:
        _print_clearance(one)
    if plot is not None:
        write_plot(plot, envelope_figure(found, table.stem))
    write_figures(json_out, {**found.figures(), "clearances": [vars(one) for one in clear]})


def _place(text: str) -> tuple[float, float]:
    """Two numbers with a comma between them. ValueError."""
    try:
        x, y = map(float, text.split(","))
    except ValueError:
        raise ValueError(f"--at {text!r} is not understood: write two numbers such as 8.541,47.376") from None
    return x, y


def _print_envelope(found: SwayEnvelope) -> None:
    median, high = found.quantile_m(0.5), found.quantile_m(0.9)
    for k in reversed(range(len(found.rest_m))):
        below, above = found.height_m[k], found.height_m[k + 1]
        console.print(
            f"{below:.1f} to {above:.1f} m: reaches {found.rest_m[k].max():.2f} m at rest, "
            f"{median[k].max():.2f} m in gusts, {high[k].max():.2f} m in one case of ten; moves out by up to "
            f"{(high[k] - found.rest_m[k]).max():.2f} m",
            soft_wrap=True,
        )


def _print_clearance(one: Clearance) -> None:
    touched = " (touched)" if one.p90_m <= 0 else ""
    console.print(
        f"{one.name}: {one.rest_m:.2f} m clear at rest, {one.median_m:.2f} m in gusts, {one.p90_m:.2f} m in "
        f"one case of ten{touched}; nearest {one.east_m:.1f} m east, {one.north_m:.1f} m north of the tree",
        soft_wrap=True,
    )


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(envelope)
