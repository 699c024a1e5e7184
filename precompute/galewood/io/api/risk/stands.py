"""The stems of a stand in wind."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from pathlib import Path
from typing import get_args

from galewood.check.stand import StandOptions, StandReport, shipped_forms, stand_report
from galewood.measurements import Inventory, read_inventory
from galewood.table import Foliage


def stand_risk(
    inventory: str | Path | Inventory, *, foliage: Foliage = "leaf", options: StandOptions | None = None
) -> StandReport:
    """Which stems of a stand break first, and how far each sways.

    A calculation for sound wood, no substitute for an inspection: not validated for decay, root damage or
    included bark. Its assumptions are listed in the report.

    Args:
        inventory: CSV or GeoJSON of stems (place, species, height, diameter), or an inventory document.
        foliage: "bare" leaves out the mass and the wind area of the leaves.
        options: Wind, shelter, knots, and how the uncertainty is sampled.

    Raises:
        InventoryError: The inventory cannot be read (a ValueError).
        ValueError: The foliage is neither "leaf" nor "bare".
    """
    if foliage not in get_args(Foliage):
        raise ValueError(f"foliage must be one of {', '.join(get_args(Foliage))}, not {foliage!r}")
    stems = inventory if isinstance(inventory, Inventory) else read_inventory(inventory)
    return stand_report(stems, shipped_forms(foliage), options)
