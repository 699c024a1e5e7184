"""What the reader of an inventory assumed, in sentences. Twin: web/player/src/core/inventory/notes.ts."""

from __future__ import annotations

from galewood.inventory.columns import Columns
from galewood.inventory.species import match_species


def notes_of(
    columns: Columns, units: dict[str, str], estimated: int, formless: int, stems: int
) -> tuple[str, ...]:
    """The sentences."""
    notes: list[str] = []
    if columns.geographic:
        notes.append("Longitudes and latitudes (WGS 84) were projected to metres.")
    for what, name in (("dbh", "diameters"), ("girth", "circumferences")):
        if what in columns.index and not columns.units[what]:
            notes.append(f"No unit of the {name} was found: {units[what]} fits them.")
    if "height" in columns.index and not columns.units["height"]:
        notes.append("No unit of the heights was found: m is assumed.")
    if estimated:
        notes.append(f"{estimated} of {stems} heights were missing and estimated from the diameter.")
    if formless:
        notes.append(
            f"{formless} of {stems} trees lack a height or a diameter, which decide between the open-grown "
            "and the slender form: the density of the plot decides."
        )
    if "species" not in columns.index and "genus" not in columns.index:
        notes.append("There is no column of species: trees below 8 m are apricots, the others maples.")
    return tuple(notes)


def substitutes_of(stems: list[tuple[str, float]]) -> tuple[dict[str, object], ...]:
    """Names (with heights) that have no tree of their genus, the most frequent first."""
    counts: dict[tuple[str, str, str], int] = {}
    for name, height_m in stems:
        match = match_species(name, height_m)
        if not match.same:
            key = (name, match.builtin, match.genus)
            counts[key] = counts.get(key, 0) + 1
    ordered = sorted(counts.items(), key=lambda item: -item[1])
    return tuple(
        {"name": name, "builtin": builtin, "genus": genus, "stems": count}
        for (name, builtin, genus), count in ordered
    )
