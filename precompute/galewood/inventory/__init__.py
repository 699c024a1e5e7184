"""Forests from inventories: rows of stems (CSV, GeoJSON) to trees of known species, places and heights."""

from galewood.inventory.columns import is_inventory
from galewood.inventory.errors import InventoryError
from galewood.inventory.projection import local_m
from galewood.inventory.reading import Inventory, Stem, read_inventory
from galewood.inventory.report import InventoryReport
from galewood.inventory.species import match_species

__all__ = [
    "Inventory",
    "InventoryError",
    "InventoryReport",
    "Stem",
    "is_inventory",
    "local_m",
    "match_species",
    "read_inventory",
]
