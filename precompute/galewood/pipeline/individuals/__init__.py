"""Individuals of a species: their motion from their own beams and the fitted table of the species."""

from galewood.pipeline.individuals.law import law_of_table
from galewood.pipeline.individuals.quick_table import individual_table
from galewood.pipeline.individuals.shipped import motion_of_document, ship_motions, shipped_motion
from galewood.pipeline.individuals.species_motion import SpeciesMotion

__all__ = [
    "SpeciesMotion",
    "individual_table",
    "law_of_table",
    "motion_of_document",
    "ship_motions",
    "shipped_motion",
]
