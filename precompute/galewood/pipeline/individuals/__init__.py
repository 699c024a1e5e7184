"""Individuals of a species: their motion from their own beams and the fitted table of the species."""

from galewood.pipeline.individuals.document import IndividualDocument, document_of, read_document
from galewood.pipeline.individuals.grown_tree import (
    GrownMesh,
    individual_result,
    quick_motion,
    read_grown,
)
from galewood.pipeline.individuals.law import law_of_table
from galewood.pipeline.individuals.quick_table import individual_table
from galewood.pipeline.individuals.shipped import ship_motions, shipped_motion
from galewood.pipeline.individuals.species_motion import SpeciesMotion

__all__ = [
    "GrownMesh",
    "IndividualDocument",
    "SpeciesMotion",
    "document_of",
    "individual_result",
    "individual_table",
    "law_of_table",
    "quick_motion",
    "read_document",
    "read_grown",
    "ship_motions",
    "shipped_motion",
]
