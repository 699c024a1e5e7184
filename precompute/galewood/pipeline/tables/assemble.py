"""Assembles the parts of a table: the motion of the default method, and the paper's records."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from galewood.constants import TABLE_FORMAT, TABLE_VERSION
from galewood.motion.modal import ModalTensors
from galewood.motion.search import (
    Compared,
    InternalStates,
    Rule,
    air_of,
    build_search,
    compared,
    typical_error,
)
from galewood.pipeline.reduction import (
    ModalTraining,
    Oscillators,
    Subspace,
    fitted,
    linear_motion,
    quantise,
    quantum,
)
from galewood.pipeline.sampling import SampledRun, SampleWind
from galewood.pipeline.tables.drawn import CHECKED_POSES, FITTED_POSES, drawn_poses
from galewood.pipeline.tables.options import TableSettings
from galewood.pipeline.tables.surface import RenderMesh
from galewood.solid.fem import FemSettings
from galewood.solid.skinning import (
    QUICK_SMOOTHING,
    THOROUGH_SMOOTHING,
    Effort,
    MotionSamples,
    Skin,
    make_skin,
    with_attached_pieces,
)
from galewood.table import Metadata, Records, Table
from galewood.util import Array, Floats

REACH_MARGIN = 1.5
"""Allowance for motion beyond that of the training runs, as in pressures beyond the sampled range."""


@dataclass(frozen=True)
class TableContext:
    """What a table contains besides its motion."""

    mass_kg: Floats  # (n,) of the tet vertices
    mesh: RenderMesh
    description: Metadata
    """Species, height, time step, design wind and provenance."""
    settings: TableSettings

    @property
    def height_m(self) -> float:
        """Height of the tree, m."""
        return float(self.description["height_m"])


@dataclass(frozen=True)
class DefaultPart:
    """A table without the paper's records, and its modes on the tet vertices."""

    table: Table
    subspace: Subspace


def assemble_linear(
    body: Oscillators, winds: Sequence[SampleWind], fem: FemSettings, of: TableContext
) -> Table:
    """A table of natural modes alone: linear motion, without any simulation.

    ``winds`` are those whose motion decides which vertices share a node.
    """
    linear = linear_motion(body, of.mass_kg, winds, fem)
    motion = ModalMotion(linear.modal, linear.subspace, linear.q, [wind.pressure_pa for wind in winds])
    return _drawn_table(motion, {}, of, QUICK_SMOOTHING)


def assemble_transferred(motion: ModalMotion, of: TableContext) -> Table:
    """The table of a model that no run was simulated for, with a nonlinear force and pose from elsewhere.

    Its mesh is bound already; what is drawn is checked in the poses of the largest motion.
    """
    table = _table(motion, {}, of)
    if of.mesh.distortion is not None:
        poses = strong_poses(np.concatenate(motion.q))
        table.metadata["drawn"] = of.mesh.distortion.in_poses(table, poses[:CHECKED_STRONG], gaps=False)
    return table


def assemble_default(training: ModalTraining, of: TableContext) -> DefaultPart:
    """The table of the default method, fitted to the training runs."""
    model = fitted(training, of.mass_kg)
    subspace = model.subspace
    errors = {
        "truncation_max_m": subspace.max_error_m,
        "truncation_energy": subspace.energy_left,
        "training_m": model.training_error_m,
    }
    q = [subspace.project(run.displacement_m) for run in training.runs]
    winds_pa = [np.asarray(run.pressure_pa, np.float64) for run in training.runs]
    motion = ModalMotion(model.modal, subspace, q, winds_pa)
    return DefaultPart(_drawn_table(motion, errors, of, THOROUGH_SMOOTHING), subspace)


def assemble_records(
    runs: Sequence[SampledRun],
    winds: Sequence[SampleWind],
    default: DefaultPart,
    settings: TableSettings,
    on_progress: Callable[[float], None] = lambda fraction: None,
) -> Records:
    """The records of the paper's state search in the modes of a table.

    ``on_progress`` gets the fraction done and may raise to cancel.
    """
    scale = default.table.mode_scale
    motion = quantise((default.subspace.project(run.displacement_m) for run in runs), scale[0])
    starts = np.cumsum([0, *(len(run.pressure_pa) for run in runs)]).astype(np.uint32)
    pressure = np.concatenate([run.pressure_pa for run in runs]).astype(np.float32)
    on_progress(0.05)
    states = internal_states(runs)
    layout = compared(states)
    weight = weights(layout, states.components, settings)
    sigma_pa = settings.sigma_share * spread_pa(pressure)
    rule = Rule(states.components, sigma_pa, weight["initial"], weight["maximum"])
    on_progress(0.15)
    search = build_search(layout, air_of(pressure, starts), rule, lambda f: on_progress(0.15 + 0.85 * f))
    metadata = {
        "records": len(motion.dq),
        "points": states.velocity.shape[1],
        "components": states.components,
        "sigma_pa": sigma_pa,
        "weight": weight,
        "pose_easing": settings.pose_easing,
        "winds": [wind.name for wind in winds],
        "frames": [len(run.pressure_pa) for run in runs],
    }
    return Records(metadata, motion.dq, pressure, starts, search.offsets, search.record, search.mismatches)


def assemble_table(
    runs: Sequence[SampledRun], winds: Sequence[SampleWind], training: ModalTraining, of: TableContext
) -> Table:
    """A whole table: the default method from the training runs, the paper's records from ``runs``."""
    default = assemble_default(training, of)
    return replace(default.table, paper=assemble_records(runs, winds, default, of.settings))


@dataclass(frozen=True)
class ModalMotion:
    """A modal model, and its motion q (T + 1, r) under the winds (T, 2), Pa, that it was made from."""

    modal: ModalTensors
    subspace: Subspace
    q: Sequence[Floats]
    winds_pa: Sequence[Floats]

    @property
    def strongest_pa(self) -> float:
        """Strength of the strongest wind, Pa."""
        return max(float(np.linalg.norm(wind, axis=1).max(initial=0.0)) for wind in self.winds_pa)


def _drawn_table(motion: ModalMotion, errors: Metadata, of: TableContext, effort: Effort) -> Table:
    """The table of a modal model with smoothed weights, checked in poses they were not smoothed for."""
    table, distortion = _table(motion, errors, of), of.mesh.distortion
    if distortion is None:
        return table
    fitted = drawn_poses(table, distortion.rest_m, distortion.wood, FITTED_POSES)
    fitted = np.concatenate([fitted, distortion.far_poses(table, motion.q)])
    mesh = of.mesh.smoothed(distortion.tree, motion.subspace.basis, fitted, effort)
    table = _table(motion, errors, replace(of, mesh=mesh))
    if effort is THOROUGH_SMOOTHING:
        table = with_attached_pieces(table, distortion, motion.q)
    checked = drawn_poses(table, distortion.rest_m, distortion.wood, CHECKED_POSES)
    table.metadata["drawn"] = distortion.in_poses(table, checked, gaps=effort is THOROUGH_SMOOTHING)
    return table


def _table(motion: ModalMotion, errors: Metadata, of: TableContext) -> Table:
    """The table of a modal model."""
    modal, basis, every = motion.modal, motion.subspace.basis, np.concatenate(motion.q)
    most_pa = max(motion.strongest_pa, float(modal.limits[2]))
    skin = _skin(basis, np.sqrt(np.mean(every**2, axis=0)), strong_poses(every), of)
    metadata: Metadata = {
        "format": TABLE_FORMAT,
        "version": TABLE_VERSION,
        **of.description,
        "modes": basis.shape[2],
        "primitives": of.mesh.primitives,
        "peak_pressure_pa": most_pa,
        "reach_m": REACH_MARGIN * _reach_m(skin.node_basis, every),
        "errors": {**errors, "node_rms_m": skin.rms_error_m, "node_max_m": skin.max_error_m},
    }
    scale = np.full(basis.shape[2], quantum(motion.q), np.float32)
    return Table(
        metadata=metadata, mode_scale=scale,
        node_basis=skin.node_basis, node_rest_m=skin.node_rest_m,
        node_turn=skin.node_turn, node_parent=skin.node_parent,
        joint_nodes=skin.joint_nodes, joint_share=skin.joint_share, joint_rest_m=skin.joint_rest_m,
        vertex_joint=skin.vertex_joint,
        modal_step=modal.step, modal_load=modal.load, modal_sway=modal.sway, modal_force=modal.force,
        modal_shown=modal.shown, modal_pose=modal.pose, modal_limits=modal.limits,
        modal_drag_point=modal.drag_point, modal_drag_shape=modal.drag_shape, modal_drag_rest=modal.drag_rest,
        modal_drag_place=modal.drag_place, modal_place=modal.place, modal_place_load=modal.place_load,
    )  # fmt: skip


CHECKED_STRONG = 8
"""Number of them in which the table of an individual is checked."""
STRONG_POSES = 24
"""Poses of the training runs in which the motion of the branches must follow from that of the nodes."""


def strong_poses(q: Floats) -> Floats:
    """(k, r) poses of the largest motion in q (f, r)."""
    far = np.argsort(-np.linalg.norm(q, axis=1), kind="stable")[: max(1, len(q) // 8)]
    return q[far[:: max(1, len(far) // STRONG_POSES)]]


def _skin(basis: Floats, q_rms: Floats, strong: Floats, of: TableContext) -> Skin:
    moved = of.mesh.axis.displacement(basis) @ strong.T
    farthest_m = float(np.linalg.norm(moved, axis=1).max(initial=0.0))
    tolerance_m = min(of.settings.node_share * of.height_m, of.settings.node_sway_share * farthest_m)
    samples = MotionSamples(basis, strong, q_rms)
    return make_skin(of.mesh.axis, of.mesh.bindings, samples, tolerance_m)


def _reach_m(basis: Array, q: Floats) -> float:
    """Largest displacement of any node (n, 3, r) under the motion q (T, r), m.

    A node moves at most by the norm of its basis times that of q: most nodes cannot be the farthest.
    """
    nodes = basis.astype(np.float64)
    most = np.linalg.norm(nodes, 2, axis=(1, 2)) * float(np.linalg.norm(q, axis=1).max(initial=0.0))
    farthest_m = 0.0
    for k in np.argsort(-most, kind="stable"):
        if most[k] <= farthest_m:
            break
        squared = np.square(q @ nodes[k].T)
        farthest_m = max(farthest_m, float(np.sqrt((squared[:, 0] + squared[:, 1] + squared[:, 2]).max())))
    return farthest_m


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
