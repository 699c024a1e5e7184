"""Corotational finite elements; in: elements, masses, loads; out: rest pose, natural modes, motion."""

from galewood.fem.assembly import ElementSystem
from galewood.fem.damping import damping_report, rayleigh, shown_ratio
from galewood.fem.dynamics import Simulator
from galewood.fem.elasticity import PAIRS, gradients, moduli, stiffness_blocks
from galewood.fem.model import Element, FemModel, FemSettings, Scheme, load_model, save_model
from galewood.fem.modes import Modes, natural_modes, tangent_modes
from galewood.fem.prestress import rest_prestress
from galewood.fem.quadratic import elevate, midside_parents, node_mass_shares
from galewood.fem.solver import NotPositiveDefinite
from galewood.fem.statics import RestPose, balanced_pose, gravity_rest_pose, solve_static

__all__ = [
    "PAIRS",
    "Element",
    "ElementSystem",
    "FemModel",
    "FemSettings",
    "Modes",
    "NotPositiveDefinite",
    "RestPose",
    "Scheme",
    "Simulator",
    "balanced_pose",
    "damping_report",
    "elevate",
    "gradients",
    "gravity_rest_pose",
    "load_model",
    "midside_parents",
    "moduli",
    "natural_modes",
    "node_mass_shares",
    "rayleigh",
    "rest_prestress",
    "save_model",
    "shown_ratio",
    "solve_static",
    "stiffness_blocks",
    "tangent_modes",
]
