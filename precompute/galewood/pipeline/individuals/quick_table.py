"""The table of an individual in seconds: its own beams, and the fitted motion of its species."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from galewood.motion.modal import shape_terms
from galewood.motion.wind import speed_of_pressure
from galewood.pipeline.individuals.curving import PAIRS, curved_shapes
from galewood.pipeline.individuals.law import Law, force_of_law, isotropic_law, sampled_states
from galewood.pipeline.individuals.motions import SpeciesMotion
from galewood.pipeline.individuals.stiffness import loaded_hz, of_all_modes
from galewood.pipeline.individuals.sway import Sway, sway_of_oscillators
from galewood.pipeline.reduction import (
    STANDARD_SIZE,
    Exposure,
    LinearMotion,
    Oscillators,
    Subspace,
    in_gusts,
    leading_oscillators,
    linear_motion,
    simulated_q,
)
from galewood.pipeline.sampling import SampleWind, gust_shapes, training_shapes
from galewood.pipeline.tables import (
    Body,
    BuildOptions,
    ModalMotion,
    TableContext,
    assemble_transferred,
    describe,
    smoothed_mesh,
    strong_poses,
)
from galewood.solid.fem import rayleigh
from galewood.solid.model import ARM_SHARE, BeamModel, beam_model
from galewood.table import Table
from galewood.tree import TreeMesh
from galewood.util import Floats

LEFT_OUT = (
    "what its own wood does beyond beams: a frequency may be off by some per cent",
    "the nonlinear motion of its own branches: that of its species is taken, the same in all directions",
)
"""What a table of an individual leaves out."""
EVEN_WINDS, GUSTY_WINDS = 5, 3
"""Winds whose linear motion determines typical speeds, and which vertices share a node."""
LINEAR_SHARE = 0.4
"""Pressure of these winds over the largest: without drag a linear tree sways farther."""


def individual_table(
    tree: TreeMesh,
    species: SpeciesMotion,
    options: BuildOptions,
    render_glb: bytes,
    law: Law | None = None,
) -> Table:
    """The table of a tree of a species; ``law`` takes the place of its isotropic one.

    Raises ValueError if the surface of the wood has no branches that beams could follow.
    """
    wood = options.wood_of(tree.species)
    model = beam_model(tree, wood, leaves=options.foliage == "leaf")
    factors = of_all_modes(np.array(species.stiffness), len(model.weightless_hz))
    body = _oscillators(model, factors, wood.damping_ratio, options)
    own = leading_oscillators(body, options.fem, STANDARD_SIZE.natural, STANDARD_SIZE.dynamic)
    sway = sway_of_oscillators(own, species.sway * tree.height_m)
    limits = np.array([1.0, species.speed * sway.omega, species.pressure * sway.unit_pa])
    winds = _winds(
        float(body.omega.min()) / (2 * np.pi), float(limits[2]), model.streamlined_exponent, options
    )
    linear = linear_motion(body, model.mass_kg, winds, options.fem)
    states = sampled_states(species.speed, species.pressure)
    law = law or isotropic_law(np.array(species.force))
    modal = replace(
        linear.modal,
        sway=np.ascontiguousarray(sway.rows, np.float32),
        force=np.ascontiguousarray(force_of_law(law, sway, limits, states), np.float32),
        limits=limits.astype(np.float32),
        pose=_pose(len(own.omega)),
    )
    subspace = _with_curving(linear, model, own, sway, tree.height_m)
    q = simulated_q(modal, [(wind.pressure_pa, wind.gusts) for wind in winds], options.fem.dt_s)
    motion = ModalMotion(modal, subspace, q, [wind.pressure_pa for wind in winds])
    poses = strong_poses(np.concatenate(q))
    hz = np.sort(body.omega[:10]) / (2 * np.pi)
    described = Body(hz.tolist(), wood.name, model.streamlined_exponent, {"beams": model.beams})
    of = TableContext(
        model.mass_kg,
        smoothed_mesh(tree, model.embedding, model.axis, subspace.basis, poses),
        describe(tree, described, options.design_speed_m_s, options, render_glb),
        options.table,
    )
    table = assemble_transferred(motion, of)
    table.metadata["provenance"] |= {"stage": "individual", "left_out": list(LEFT_OUT)}
    return table


def _oscillators(
    model: BeamModel, factors: Floats, damping_ratio: float, options: BuildOptions
) -> Oscillators:
    omega = 2 * np.pi * loaded_hz(model, factors)
    alpha, beta = rayleigh(
        damping_ratio, float(omega.min()) / (2 * np.pi), options.fem.damping_frequency_ratio
    )
    elastic = (
        2 * np.pi * model.weightless_hz
    ) ** 2 * factors  # the weight does not change what the wood damps
    exposure = Exposure(
        model.exposed_area_m2, model.sheltered_share, model.wind_profile, model.streamlined_exponent,
        model.place_m,
    )  # fmt: skip
    shapes = model.shapes.reshape(len(omega), -1)
    return in_gusts(Oscillators(omega, np.diag(alpha + beta * elastic), shapes, model.load, exposure))


def _winds(first_hz: float, most_pa: float, exponent: float, options: BuildOptions) -> list[SampleWind]:
    shapes = training_shapes(first_hz, options.fem.dt_s, exponent, seed=options.seed, count=EVEN_WINDS)
    shapes += gust_shapes(options.fem.dt_s, exponent, seed=options.seed, count=GUSTY_WINDS)
    speed_m_s = float(speed_of_pressure(LINEAR_SHARE * most_pa, exponent))
    return [shape.at(speed_m_s) for shape in shapes]


def _pose(oscillators: int) -> np.ndarray:
    """(d + 9, 3) the further output modes are the products of the sway coordinates."""
    pose = np.zeros((oscillators + 2 + shape_terms(0), len(PAIRS)), np.float32)
    pose[oscillators + 2 : oscillators + 2 + len(PAIRS)] = np.eye(len(PAIRS))
    return pose


def _with_curving(
    linear: LinearMotion, model: BeamModel, own: Oscillators, sway: Sway, height_m: float
) -> Subspace:
    """The output modes with those of the curved paths, m per unit of a product of the sway coordinates."""
    curved = curved_shapes(model, own, sway, ARM_SHARE * height_m).transpose(1, 2, 0)
    subspace = linear.subspace
    return replace(
        subspace,
        basis=np.ascontiguousarray(np.concatenate([subspace.basis, curved], axis=2)),
        scale=np.concatenate([subspace.scale, np.ones(len(PAIRS))]),
    )
