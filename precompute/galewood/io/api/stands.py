"""The stems of a stand in wind."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import get_args

from galewood.check.field import diameter_cm
from galewood.check.stand import StandOptions, StandReport, TreeForm, form_name, form_of_rods, stand_report
from galewood.constants import BREAST_HEIGHT_M
from galewood.io.api.trees import read
from galewood.measurements import Inventory, read_inventory
from galewood.packaged import species_folder
from galewood.pipeline.stages import builtin_meshes
from galewood.solid.model import beam_model
from galewood.solid.strain import wind_rods
from galewood.table import Foliage
from galewood.wood import wood_of_species


def stand_risk(
    inventory: str | Path | Inventory,
    *,
    foliage: Foliage = "leaf",
    options: StandOptions | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> StandReport:
    """Which stems of a stand break first, and how far each sways.

    A calculation for sound wood, no substitute for an inspection: not validated for decay, root damage or
    included bark. Its assumptions are listed in the report.

    Args:
        inventory: CSV or GeoJSON of stems: place, species, height, diameter.
        foliage: "bare" leaves out the mass and the wind area of the leaves.
        options: Wind, shelter, knots, and how the uncertainty is sampled.
        on_progress: Receives the fraction done; whatever it raises ends the calculation.

    Raises:
        InventoryError: The inventory cannot be read (a ValueError).
        ValueError: The foliage is neither "leaf" nor "bare".
    """
    if foliage not in get_args(Foliage):
        raise ValueError(f"foliage must be one of {', '.join(get_args(Foliage))}, not {foliage!r}")
    stems = inventory if isinstance(inventory, Inventory) else read_inventory(inventory)
    used = {form_name(stem) for stem in stems.stems}
    forms: dict[str, TreeForm] = {}
    for name in sorted(used):
        forms[name] = builtin_form(name, foliage)
        if on_progress:
            on_progress(len(forms) / (len(used) + 1))
    return stand_report(stems, forms, options)


def builtin_form(name: str, foliage: Foliage = "leaf") -> TreeForm:
    """A built-in tree, bent in winds of all speeds. KeyError if there is none of this name."""
    mesh = {mesh.name: mesh for mesh in builtin_meshes(species_folder())}[name]
    tree = read(mesh.path, species=str(mesh.options["species"]), accept=True)
    wood, leaves = wood_of_species(tree.species or "default"), foliage == "leaf"
    dbh_cm = diameter_cm(tree.wood_vertices_m, tree.wood_faces, BREAST_HEIGHT_M)
    if dbh_cm is None:
        raise ValueError(f"{name} is lower than 1.3 m")
    frequency_hz = float(beam_model(tree.mesh, wood, leaves=leaves).frequencies_hz.min())
    return form_of_rods(name, wind_rods(tree.mesh, wood, leaves=leaves), dbh_cm / 100, frequency_hz)
