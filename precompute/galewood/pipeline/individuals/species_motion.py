"""What individuals take over from the fitted table of the built-in tree of their species and form."""

from __future__ import annotations

import numpy as np

from galewood.pipeline.individuals.law import isotropic_part, law_of_table, sampled_states
from galewood.pipeline.individuals.motions import SpeciesMotion
from galewood.pipeline.individuals.stiffness import stiffness_factors
from galewood.pipeline.individuals.sway import largest_sway_m, sway_of_table
from galewood.solid.model import BeamModel
from galewood.table import Table


def species_motion(table: Table, beams: BeamModel) -> SpeciesMotion:
    """From the fitted table of a tree and the beams along its branches."""
    own, limits = sway_of_table(table), table.modal_limits.astype(np.float64)
    speed, pressure = float(limits[1]) / own.omega, float(limits[2]) / own.unit_pa
    force = isotropic_part(law_of_table(table), sampled_states(speed, pressure))
    return SpeciesMotion(
        tuple(stiffness_factors(beams, table.metadata["frequencies_hz"]).tolist()),
        largest_sway_m(table) / float(table.metadata["height_m"]),
        speed,
        pressure,
        tuple(force.tolist()),
    )
