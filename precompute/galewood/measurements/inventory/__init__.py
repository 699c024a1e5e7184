"""Forests from inventories: rows of stems (CSV, GeoJSON) to trees of known species, places and heights."""

from galewood.measurements.inventory.columns import is_inventory, recognised_columns
from galewood.measurements.inventory.errors import InventoryError
from galewood.measurements.inventory.geojson import is_projected
from galewood.measurements.inventory.projection import local_m
from galewood.measurements.inventory.reading import read_inventory
from galewood.measurements.inventory.report import InventoryReport
from galewood.measurements.inventory.species import match_species, wood_species_of
from galewood.measurements.inventory.stems import Inventory, Stem

__all__ = [
    "Inventory",
    "InventoryError",
    "InventoryReport",
    "Stem",
    "is_inventory",
    "is_projected",
    "local_m",
    "match_species",
    "read_inventory",
    "recognised_columns",
    "wood_species_of",
]
