"""The table of the first second: natural modes of beams along the branches, before the wood is meshed."""

from __future__ import annotations

import numpy as np

from galewood.pipeline.reduction import Exposure, Oscillators, in_gusts, training_winds
from galewood.pipeline.sampling import MAX_SWAY_SHARE
from galewood.pipeline.tables.assemble import TableContext, assemble_linear
from galewood.pipeline.tables.options import BuildOptions
from galewood.pipeline.tables.report import Body, describe
from galewood.pipeline.tables.stiffness import goal_of
from galewood.pipeline.tables.surface import render_mesh
from galewood.pipeline.tables.table_stage import TableStage
from galewood.solid.fem import rayleigh
from galewood.solid.model import BeamModel, beam_model
from galewood.table import Table
from galewood.tree import TreeMesh


def beam_table(tree: TreeMesh, options: BuildOptions, render_glb: bytes) -> Table:
    """A preliminary table of an imported tree, within a second.

    Raises ValueError if the surface of the wood has no branches that beams could follow.
    """
    wood = options.wood_of(tree.species)
    goal = goal_of(tree, wood, options)
    wood = wood if goal is None else wood.scaled(goal.factor)
    model = beam_model(tree, wood, leaves=options.foliage == "leaf")
    speed_m_s = _design_speed(model, options.design_speed_m_s, tree.height_m)
    frequencies_hz = model.frequencies_hz[:10].tolist()
    body = Body(frequencies_hz, wood.name, model.streamlined_exponent, {"beams": model.beams})
    of = TableContext(
        model.mass_kg,
        render_mesh(tree, model.embedding, model.axis),
        describe(tree, body, speed_m_s, options, render_glb),
        options.table,
    )
    oscillators = _oscillators(model, wood.damping_ratio, options)
    winds = training_winds(oscillators, model.mass_kg, tree.height_m, options.fem, options.seed)
    table = assemble_linear(oscillators, winds, options.fem, of)
    TableStage.BEAMS.mark(table)
    return table


def _design_speed(model: BeamModel, asked_m_s: float, height_m: float) -> float:
    """The requested speed, reduced if its steady pressure would bend the beams too far."""
    share = model.steady_sway_m(asked_m_s) / height_m
    return asked_m_s * min(1.0, (MAX_SWAY_SHARE / max(share, 1e-9)) ** (1.0 / model.streamlined_exponent))


def _oscillators(model: BeamModel, damping_ratio: float, options: BuildOptions) -> Oscillators:
    omega = 2 * np.pi * model.frequencies_hz
    first_hz = float(model.frequencies_hz[0])
    alpha, beta = rayleigh(damping_ratio, first_hz, options.fem.damping_frequency_ratio)
    damping = np.diag(alpha + beta * omega**2)
    exposure = Exposure(
        model.exposed_area_m2, model.sheltered_share, model.wind_profile, model.streamlined_exponent,
        model.place_m,
    )  # fmt: skip
    shapes = model.shapes.reshape(len(omega), -1)
    return in_gusts(Oscillators(omega, damping, shapes, model.load, exposure))
