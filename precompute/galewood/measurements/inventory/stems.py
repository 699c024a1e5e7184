"""The trees of an inventory, and their limits."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from galewood.constants import INVENTORY_VERSION
from galewood.measurements.inventory.report import InventoryReport

MOST_STEMS = 20_000
FARTHEST_M = 1000.0
"""Stems farther than this from the middle are left out."""
LOWEST_M, HIGHEST_M = 0.5, 120.0
THICKEST_M = 12.0


@dataclass(frozen=True)
class Stem:
    """A tree of the inventory, placed relative to the middle of the plot."""

    line: int
    """Of the file; the number of the feature in a GeoJSON file."""
    east_m: float
    north_m: float
    species: str
    """As in the file."""
    builtin: str
    """The built-in species that stands for it."""
    height_m: float
    slender: bool
    """Whether it has grown in a stand."""
    dbh_cm: float | None = None
    """Diameter at 1.3 m; None: not measured."""
    height_estimated: bool = False
    """By a curve, from the diameter."""


@dataclass(frozen=True)
class Inventory:
    """The trees of an inventory, and how its file was interpreted."""

    stems: tuple[Stem, ...]
    report: InventoryReport
    lon_lat_deg: tuple[tuple[float, float] | None, ...]
    """Of the stems, in their order; None: the file has metres, or is a document, which has none."""

    def document(self) -> dict[str, object]:
        """The inventory document, which page and player read (spec/formats/inventory.md)."""
        stems = [asdict(stem) for stem in self.stems]
        return {"version": INVENTORY_VERSION, "stems": stems, "report": self.report.document()}
