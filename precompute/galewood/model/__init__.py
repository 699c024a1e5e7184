"""Construction of the finite-element model; in: TetMesh, Skeleton, wood, foliage; out: a FemModel."""

from galewood.model.added_wood import in_added_wood
from galewood.model.axis import Axis, Feet, axis_of_tets, chosen
from galewood.model.bark import WeldedWood, welded_wood
from galewood.model.beam_tree import BeamModel, beam_model
from galewood.model.bearers import edge_points
from galewood.model.binding import foliage_pieces, points_binding, render_binding
from galewood.model.comparison import gusty_pressure, trajectory_difference
from galewood.model.construction import GRAVITY_M_S2, LumpedMassesLike, MeshLike, SkeletonLike, build_model
from galewood.model.eased import AxisPaths, axis_paths
from galewood.model.effective_mass import (
    effective_masses,
    free_mass_kg,
    horizontal_masses,
    participation_factors,
)
from galewood.model.foliage import LumpedMasses, bind_foliage
from galewood.model.from_tree import tree_model
from galewood.model.holds import holds_of
from galewood.model.reference import compare_with_reference, reference_model
from galewood.model.typical_frequency import typical_frequency_hz

__all__ = [
    "GRAVITY_M_S2",
    "Axis",
    "AxisPaths",
    "BeamModel",
    "Feet",
    "LumpedMasses",
    "LumpedMassesLike",
    "MeshLike",
    "SkeletonLike",
    "WeldedWood",
    "axis_of_tets",
    "axis_paths",
    "beam_model",
    "bind_foliage",
    "build_model",
    "chosen",
    "compare_with_reference",
    "edge_points",
    "effective_masses",
    "foliage_pieces",
    "free_mass_kg",
    "gusty_pressure",
    "holds_of",
    "horizontal_masses",
    "in_added_wood",
    "participation_factors",
    "points_binding",
    "reference_model",
    "render_binding",
    "trajectory_difference",
    "tree_model",
    "typical_frequency_hz",
    "welded_wood",
]
