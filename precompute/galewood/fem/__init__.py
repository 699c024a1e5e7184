"""Corotational finite elements; in: elements, masses, loads; out: rest pose, natural modes, motion.

Settings are cheap to import; all other names are loaded when they are first used.
"""

from typing import TYPE_CHECKING

from galewood.fem.settings import Element, FemSettings, Scheme
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.fem.assembly import ElementSystem
    from galewood.fem.damping import damping_report, effective_damping_ratio, rayleigh
    from galewood.fem.drag import LEAST_PROFILE, Drag
    from galewood.fem.dynamics import Simulator
    from galewood.fem.elasticity import PAIRS, gradients, moduli, stiffness_blocks
    from galewood.fem.factor import TangentFactor, solve_factor, tangent_factor
    from galewood.fem.foundation import with_ground_reaction, with_root_springs
    from galewood.fem.model import FemModel, load_model, save_model
    from galewood.fem.modes import Modes, natural_modes, tangent_modes
    from galewood.fem.prestress import rest_prestress, strain_displacements
    from galewood.fem.quadratic import elevate, midside_parents, node_mass_shares
    from galewood.fem.solver import NotPositiveDefinite
    from galewood.fem.statics import (
        ExcessiveSagError,
        RestPose,
        gravity_rest_pose,
        loaded_pose,
        solve_static,
        weightless_pose,
    )
    from galewood.fem.support import Support, supporting_factors

__getattr__ = lazily(
    __name__,
    {
        "ElementSystem": "galewood.fem.assembly",
        "damping_report": "galewood.fem.damping",
        "rayleigh": "galewood.fem.damping",
        "effective_damping_ratio": "galewood.fem.damping",
        "LEAST_PROFILE": "galewood.fem.drag",
        "Drag": "galewood.fem.drag",
        "Simulator": "galewood.fem.dynamics",
        "PAIRS": "galewood.fem.elasticity",
        "gradients": "galewood.fem.elasticity",
        "moduli": "galewood.fem.elasticity",
        "stiffness_blocks": "galewood.fem.elasticity",
        "TangentFactor": "galewood.fem.factor",
        "solve_factor": "galewood.fem.factor",
        "tangent_factor": "galewood.fem.factor",
        "with_root_springs": "galewood.fem.foundation",
        "with_ground_reaction": "galewood.fem.foundation",
        "FemModel": "galewood.fem.model",
        "load_model": "galewood.fem.model",
        "save_model": "galewood.fem.model",
        "Modes": "galewood.fem.modes",
        "natural_modes": "galewood.fem.modes",
        "tangent_modes": "galewood.fem.modes",
        "rest_prestress": "galewood.fem.prestress",
        "strain_displacements": "galewood.fem.prestress",
        "elevate": "galewood.fem.quadratic",
        "midside_parents": "galewood.fem.quadratic",
        "node_mass_shares": "galewood.fem.quadratic",
        "NotPositiveDefinite": "galewood.fem.solver",
        "RestPose": "galewood.fem.statics",
        "ExcessiveSagError": "galewood.fem.statics",
        "loaded_pose": "galewood.fem.statics",
        "weightless_pose": "galewood.fem.statics",
        "gravity_rest_pose": "galewood.fem.statics",
        "solve_static": "galewood.fem.statics",
        "Support": "galewood.fem.support",
        "supporting_factors": "galewood.fem.support",
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
