"""The report of `galewood forest`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer
from galewood.cli import console, write_figures

if TYPE_CHECKING:  # loaded only when the command runs
    from galewood.inventory import Report

MOST_LISTED = 10


def report_inventory(inventory: Path, json_out: Path | None) -> None:
    """Read an inventory and print what was understood; exit with 1 if it has no trees."""
    from galewood.inventory import InventoryError, read_inventory

    try:
        found = read_inventory(inventory)
    except InventoryError as error:
        console.print(f"[red]{inventory} could not be read.[/red] {error}", highlight=False)
        raise typer.Exit(1) from None
    write_figures(json_out, found.report.document())
    for line in lines_of(found.report):
        print(line)


def lines_of(report: Report) -> list[str]:
    """The report as lines of text."""
    skipped = [f"  row {one.line}: {one.reason}" for one in report.first_skipped[:MOST_LISTED]]
    substitutes = [
        f"  {one['name'] or 'no species'}: {one['stems']} shown as {one['builtin']}"
        + ("" if one["genus"] or not one["name"] else " (unknown name)")
        for one in report.substitutes
    ]
    return [
        *(f"{what}: column {column}" for what, column in report.columns.items()),
        f"{report.stems} trees of {report.rows} rows on {report.width_m:.0f} × {report.depth_m:.0f} m "
        f"({report.per_ha:.0f} per hectare), {report.lowest_m:.1f} to {report.highest_m:.1f} m high",
        *report.notes,
        *(["Substitutes:", *substitutes] if substitutes else []),
        *([f"{report.skipped} rows were skipped:", *skipped] if report.skipped else []),
    ]
