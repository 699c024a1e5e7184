"""Corotational finite elements; in: elements, masses, loads; out: rest pose, natural modes, motion.

Settings are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.solid.fem.settings import Element, FemSettings, Scheme
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.solid.fem.damping import damping_report, effective_damping_ratio, rayleigh
    from galewood.solid.fem.drag import LEAST_PROFILE, Drag
    from galewood.solid.fem.dynamics import Simulator
    from galewood.solid.fem.elements.assembly import ElementSystem
    from galewood.solid.fem.elements.elasticity import PAIRS, gradients, moduli, stiffness_blocks
    from galewood.solid.fem.elements.quadratic import elevate, midside_parents, node_mass_shares
    from galewood.solid.fem.factor import TangentFactor, solve_factor, tangent_factor
    from galewood.solid.fem.foundation import with_ground_reaction, with_root_springs
    from galewood.solid.fem.model import FemModel, load_model, save_model
    from galewood.solid.fem.modes import Modes, natural_modes, tangent_modes
    from galewood.solid.fem.prestress import rest_prestress, strain_displacements
    from galewood.solid.fem.solver import NotPositiveDefinite
    from galewood.solid.fem.statics import (
        ExcessiveSagError,
        RestPose,
        gravity_rest_pose,
        loaded_pose,
        solve_static,
        weightless_pose,
    )
    from galewood.solid.fem.support import Support, supporting_factors

__getattr__ = lazily(
    __name__,
    {
        "ElementSystem": "galewood.solid.fem.elements.assembly",
        "damping_report": "galewood.solid.fem.damping",
        "rayleigh": "galewood.solid.fem.damping",
        "effective_damping_ratio": "galewood.solid.fem.damping",
        "LEAST_PROFILE": "galewood.solid.fem.drag",
        "Drag": "galewood.solid.fem.drag",
        "Simulator": "galewood.solid.fem.dynamics",
        "PAIRS": "galewood.solid.fem.elements.elasticity",
        "gradients": "galewood.solid.fem.elements.elasticity",
        "moduli": "galewood.solid.fem.elements.elasticity",
        "stiffness_blocks": "galewood.solid.fem.elements.elasticity",
        "TangentFactor": "galewood.solid.fem.factor",
        "solve_factor": "galewood.solid.fem.factor",
        "tangent_factor": "galewood.solid.fem.factor",
        "with_root_springs": "galewood.solid.fem.foundation",
        "with_ground_reaction": "galewood.solid.fem.foundation",
        "FemModel": "galewood.solid.fem.model",
        "load_model": "galewood.solid.fem.model",
        "save_model": "galewood.solid.fem.model",
        "Modes": "galewood.solid.fem.modes",
        "natural_modes": "galewood.solid.fem.modes",
        "tangent_modes": "galewood.solid.fem.modes",
        "rest_prestress": "galewood.solid.fem.prestress",
        "strain_displacements": "galewood.solid.fem.prestress",
        "elevate": "galewood.solid.fem.elements.quadratic",
        "midside_parents": "galewood.solid.fem.elements.quadratic",
        "node_mass_shares": "galewood.solid.fem.elements.quadratic",
        "NotPositiveDefinite": "galewood.solid.fem.solver",
        "RestPose": "galewood.solid.fem.statics",
        "ExcessiveSagError": "galewood.solid.fem.statics",
        "loaded_pose": "galewood.solid.fem.statics",
        "weightless_pose": "galewood.solid.fem.statics",
        "gravity_rest_pose": "galewood.solid.fem.statics",
        "solve_static": "galewood.solid.fem.statics",
        "Support": "galewood.solid.fem.support",
        "supporting_factors": "galewood.solid.fem.support",
    },
)
__all__ = [
    "LEAST_PROFILE",
    "PAIRS",
    "Drag",
    "Element",
    "ElementSystem",
    "ExcessiveSagError",
    "FemModel",
    "FemSettings",
    "Modes",
    "NotPositiveDefinite",
    "RestPose",
    "Scheme",
    "Simulator",
    "Support",
    "TangentFactor",
    "damping_report",
    "effective_damping_ratio",
    "elevate",
    "gradients",
    "gravity_rest_pose",
    "load_model",
    "loaded_pose",
    "midside_parents",
    "moduli",
    "natural_modes",
    "node_mass_shares",
    "rayleigh",
    "rest_prestress",
    "save_model",
    "solve_factor",
    "solve_static",
    "stiffness_blocks",
    "strain_displacements",
    "supporting_factors",
    "tangent_factor",
    "tangent_modes",
    "weightless_pose",
    "with_ground_reaction",
    "with_root_springs",
]
