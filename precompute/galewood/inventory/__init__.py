"""Forests from inventories: rows of stems (CSV, GeoJSON) to trees of known species, places and heights."""

from galewood.inventory.errors import InventoryError
from galewood.inventory.projection import local_m
from galewood.inventory.reading import Inventory, Report, Stem, read_inventory
from galewood.inventory.species import BUILTIN, Match, match_species

__all__ = [
    "BUILTIN",
    "Inventory",
    "InventoryError",
    "Match",
    "Report",
    "Stem",
    "local_m",
    "match_species",
    "read_inventory",
]
