"""Assembles a table from recorded trajectories: reduced motion, modal model, search, nodes and metadata."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse

from galewood.reduction import (
    Fitted,
    ModalTraining,
    Nodes,
    QuantisedMotion,
    fit_smallest,
    largest_motion_m,
    make_nodes,
    quantise,
    render_basis,
)
from galewood.sampling import SampledRun
from galewood.search import Compared, InternalStates, Rule, air_of, build_search, compared, typical_error
from galewood.table import FORMAT, VERSION, Metadata, Table, poses
from galewood.util import Array, Floats


@dataclass(frozen=True)
class TableSettings:
    """Parameters and tolerances of a table (docs/design/0002-pose-easing.md explains the defaults)."""

    modes: int | None = None
    """Oscillators of the modal model; None: as few of the standard sizes as follow the training runs."""
    sigma_share: float = 0.3
    """σ of Eq. 16 over the RMS pressure of the records."""
    weight_leverage: float = 0.94
    """w / (1 − w) at the largest weight, over the median E_int; relative, as stiff trees differ less."""
    weight_initial: float | None = None
    """Initial weight; None: 5 % below the largest weight."""
    weight_maximum: float | None = None
    """Largest weight; None: derived from ``weight_leverage``."""
    weight_growth: float = 0.01
    pose_easing: float = 0.08
    truncation_share: float = 6e-4
    """Largest vertex error of the reduced basis over the height."""
    node_share: float = 5e-4
    """Largest deviation of a vertex from its node at RMS motion, over the height."""
    node_sway_share: float = 0.03
    """The same over the largest RMS motion of the tree, so that stiff trees also bend smoothly."""


@dataclass(frozen=True)
class RenderMesh:
    """The mesh that the viewer moves: vertices in file order and their weights on the tet vertices."""

    vertices_m: Floats  # (v, 3)
    binding: scipy.sparse.csr_matrix  # (v, n)
    primitives: list[dict[str, Any]]  # name, kind, vertices


def internal_states(runs: Sequence[SampledRun]) -> InternalStates:
    """Internal states of the records of all runs, concatenated."""
    velocity, force, stiffness = (
        np.concatenate([getattr(run, name) for run in runs]) for name in ("velocity", "force", "stiffness")
    )
    return InternalStates(velocity, force, stiffness)


def weights(layout: Compared, components: int, settings: TableSettings) -> dict[str, float]:
    """Parameters of the weight w of Eq. 16 for these states: initial, maximum, growth."""
    leverage = settings.weight_leverage * typical_error(layout, components)
    maximum = settings.weight_maximum or leverage / (1.0 + leverage)
    initial = settings.weight_initial or 0.95 * maximum
    return {"initial": min(initial, maximum), "maximum": maximum, "growth": settings.weight_growth}


def spread_pa(pressure_pa: Array) -> float:
    """RMS length of the pressure vectors (z, 2) of the records with wind, Pa; 1 if there are none."""
    squared = np.square(pressure_pa, dtype=np.float64).sum(axis=1)
    return float(np.sqrt(squared[squared > 0].mean())) if squared.any() else 1.0


def assemble_table(
    runs: Sequence[SampledRun],
    mass_kg: Floats,
    mesh: RenderMesh,
    description: Metadata,
    settings: TableSettings,
    training: ModalTraining,
    on_progress: Callable[[float], None] = lambda fraction: None,
) -> Table:
    """Assemble the table of the recorded ``runs``.

    ``mass_kg`` (n,) are the masses of the tet vertices. ``description`` adds species, height, winds and
    provenance to the metadata. ``on_progress`` gets the fraction done and may raise to cancel.
    """
    height_m = float(description["height_m"])
    fitted = fit_smallest(training, mass_kg, height_m, settings.truncation_share * height_m)
    modal, subspace = fitted.modal, fitted.subspace
    on_progress(0.2)
    motion = quantise(subspace.project(run.displacement_m) for run in runs)
    starts = np.cumsum([0, *(len(run.pressure_pa) for run in runs)]).astype(np.uint32)
    q_rms = np.sqrt(np.mean((poses(motion.dq, starts) * motion.scale.astype(np.float64)) ** 2, axis=0))
    vertex_basis = render_basis(mesh.binding, subspace.basis)
    sway_m = largest_motion_m(vertex_basis, q_rms)
    tolerance_m = min(settings.node_share * height_m, settings.node_sway_share * sway_m)
    nodes = make_nodes(vertex_basis, mesh.vertices_m, q_rms, tolerance_m)
    on_progress(0.3)
    pressure = np.concatenate([run.pressure_pa for run in runs]).astype(np.float32)
    states = internal_states(runs)
    layout = compared(states)
    weight = weights(layout, states.components, settings)
    sigma_pa = settings.sigma_share * spread_pa(pressure)
    rule = Rule(states.components, sigma_pa, weight["initial"], weight["maximum"])
    search = build_search(layout, air_of(pressure, starts), rule, lambda f: on_progress(0.3 + 0.7 * f))
    metadata = _metadata(description, settings, mesh, fitted, motion, nodes, states, sigma_pa, weight)
    return Table(
        metadata, motion.scale, nodes.basis, nodes.rest_m, nodes.vertex_node, motion.dq, pressure, starts,
        search.offsets, search.record, search.mismatches,
        modal.step, modal.load, modal.sway, modal.force, modal.shown, modal.pose, modal.limits,
    )  # fmt: skip


def _metadata(
    description: Metadata,
    settings: TableSettings,
    mesh: RenderMesh,
    fitted: Fitted,
    motion: QuantisedMotion,
    nodes: Nodes,
    states: InternalStates,
    sigma_pa: float,
    weight: dict[str, float],
) -> Metadata:
    return {
        "format": FORMAT,
        "version": VERSION,
        **description,
        "modes": fitted.subspace.modes,
        "records": len(motion.dq),
        "primitives": mesh.primitives,
        "points": states.velocity.shape[1],
        "components": states.components,
        "sigma_pa": sigma_pa,
        "weight": weight,
        "pose_easing": settings.pose_easing,
        "errors": {
            "truncation_max_m": fitted.subspace.max_error_m,
            "truncation_energy": fitted.subspace.energy_left,
            "training_m": fitted.training_error_m,
            "node_rms_m": nodes.rms_error_m,
            "node_max_m": nodes.max_error_m,
        },
    }
