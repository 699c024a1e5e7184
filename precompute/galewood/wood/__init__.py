"""Elastic constants, strength, density and damping of green wood, by species or from a user's document."""

from galewood.wood.document import WoodDocument, WoodError, read_wood_document
from galewood.wood.species import BARE_EXPONENT, LEAF_EXPONENT, SPECIES, Wood, is_evergreen, wood_of_species

__all__ = [
    "BARE_EXPONENT",
    "LEAF_EXPONENT",
    "SPECIES",
    "Wood",
    "WoodDocument",
    "WoodError",
    "is_evergreen",
    "read_wood_document",
    "wood_of_species",
]
