"""Construction of the finite-element model; in: TetMesh, Skeleton, wood, foliage; out: a FemModel."""

from galewood.solid.model.added_wood import in_added_wood
from galewood.solid.model.beam_tree import ARM_SHARE, BeamModel, beam_model, loaded_beams
from galewood.solid.model.comparison import gusty_pressure, trajectory_difference
from galewood.solid.model.construction import GRAVITY_M_S2, build_model, unloaded_model
from galewood.solid.model.effective_mass import (
    effective_masses,
    free_mass_kg,
    horizontal_masses,
    participation_factors,
)
from galewood.solid.model.foliage import LumpedMasses, bind_foliage
from galewood.solid.model.from_tree import TreeModel, tree_model
from galewood.solid.model.reference import compare_with_reference, reference_model
from galewood.solid.model.typical_frequency import typical_frequency_hz

__all__ = [
    "ARM_SHARE",
    "GRAVITY_M_S2",
    "BeamModel",
    "LumpedMasses",
    "TreeModel",
    "beam_model",
    "bind_foliage",
    "build_model",
    "compare_with_reference",
    "effective_masses",
    "free_mass_kg",
    "gusty_pressure",
    "horizontal_masses",
    "in_added_wood",
    "loaded_beams",
    "participation_factors",
    "reference_model",
    "trajectory_difference",
    "tree_model",
    "typical_frequency_hz",
    "unloaded_model",
]
