"""Report of an inventory, as numbers for programs and as text for readers."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from galewood.measurements.inventory.columns import Columns
from galewood.measurements.inventory.heights import FEWEST_PAIRS, HeightCurve
from galewood.measurements.inventory.species import match_species

MOST_LISTED = 20
"""Skipped rows, and substitutes, that are listed one by one."""


@dataclass(frozen=True)
class Skipped:
    """A row without a tree."""

    line: int
    reason: str


@dataclass(frozen=True)
class Substitute:
    """A name in the file without a tree of its genus."""

    name: str
    builtin: str
    """The built-in species that stands for it."""
    genus: str
    """Empty: the name is unknown."""
    stems: int


@dataclass(frozen=True)
class InventoryReport:
    """How the file was interpreted."""

    columns: dict[str, str]
    """What each column was taken for: its name, with the unit."""
    rows: int
    stems: int
    skipped: int
    first_skipped: tuple[Skipped, ...]
    substitutes: tuple[Substitute, ...]
    """The most frequent first."""
    width_m: float
    """Extent from west to east."""
    depth_m: float
    """Extent from south to north."""
    lowest_m: float
    highest_m: float
    per_ha: float
    estimated_heights: int
    height_curves: tuple[HeightCurve, ...]
    """Those that missing heights were estimated with, fitted to the file's own pairs."""
    figures: dict[str, str]
    """The main numbers as text, by their names."""
    notes: tuple[str, ...]
    """Substitutes, assumptions and skipped rows, as sentences."""

    def document(self) -> dict[str, object]:
        """The report as JSON."""
        return asdict(self)


def stems_per_ha(count: int, width_m: float, depth_m: float) -> float:
    """Density of a plot; one that is smaller than 100 m² counts as large as that."""
    return count / (max(width_m * depth_m, 100.0) / 10_000.0)


def figures_of(report: InventoryReport) -> dict[str, str]:
    """The main numbers as text."""
    return {
        "Trees": f"{report.stems} of {report.rows} rows",
        "Plot": f"{report.width_m:.0f} × {report.depth_m:.0f} m, {report.per_ha:.0f} per hectare",
        "Heights": f"{report.lowest_m:.1f} to {report.highest_m:.1f} m",
        **{f"Column for {what}": column for what, column in report.columns.items()},
    }


def notes_of(
    report: InventoryReport, columns: Columns, units: dict[str, str], formless: int, counted: str
) -> tuple[str, ...]:
    """The sentences. ``formless``: how many trees lack a height or a diameter; ``counted``: what the file
    numbers, "line" or "feature"."""
    notes: list[str] = []
    if report.substitutes:
        shown = _listed([_shown(one) for one in report.substitutes[:MOST_LISTED]], len(report.substitutes))
        notes.append(f"Substitutes for species without a tree model: {shown}.")
    if columns.geographic:
        notes.append("Longitudes and latitudes (WGS 84) were projected to metres.")
    for what, name in (("dbh", "diameters"), ("girth", "circumferences")):
        if what in columns.index and not columns.units[what]:
            notes.append(f"No unit of the {name} was found: {units[what]} fits them.")
    if "height" in columns.index and not columns.units["height"]:
        notes.append("No unit of the heights was found: m is assumed.")
    if report.estimated_heights:
        notes.append(
            f"{report.estimated_heights} of {report.stems} heights were missing and estimated from the "
            f"diameter, {_estimated_by(report.height_curves)}."
        )
    if formless:
        notes.append(
            f"{formless} of {report.stems} trees lack a height or a diameter, which decide between the "
            "open-grown and the slender form: the density of the plot decides."
        )
    if "species" not in columns.index and "genus" not in columns.index:
        notes.append("There is no column of species: trees below 8 m are apricots, the others maples.")
    if report.skipped:
        first = [f"{counted} {one.line}: {one.reason}" for one in report.first_skipped]
        notes.append(f"Skipped {report.skipped} of {report.rows} rows: {_listed(first, report.skipped)}.")
    return tuple(notes)


def _estimated_by(curves: tuple[HeightCurve, ...]) -> str:
    if not curves:
        return f"by a general curve (fewer than {FEWEST_PAIRS} different trees have both)"
    shown = [
        f"{curve.species or 'all species'} {curve.pairs} pairs, residual {curve.residual_m:.1f} m"
        for curve in curves[:MOST_LISTED]
    ]
    return f"by curves fitted to the measured ones: {_listed(shown, len(curves))}"


def _listed(first: list[str], count: int) -> str:
    """The first of so many things, and how many more there are."""
    return "; ".join([*first, *([f"and {count - len(first)} more"] if count > len(first) else [])])


def _shown(substitute: Substitute) -> str:
    known = substitute.genus or not substitute.name
    who = f"{substitute.name or 'no species'}{'' if known else ' (unknown)'}"
    return f"{who} is shown as {substitute.builtin}: {substitute.stems}"


def substitutes_of(stems: list[tuple[str, float]]) -> tuple[Substitute, ...]:
    """Names (with heights) that have no tree of their genus, the most frequent first."""
    counts: dict[tuple[str, str, str], int] = {}
    for name, height_m in stems:
        match = match_species(name, height_m)
        if not match.same:
            key = (name, match.builtin, match.genus)
            counts[key] = counts.get(key, 0) + 1
    ordered = sorted(counts.items(), key=lambda item: -item[1])
    return tuple(Substitute(*key, count) for key, count in ordered)
