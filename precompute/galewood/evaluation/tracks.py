"""One tree's motion three ways under one wind: by the finite elements and by both methods of its table.

What the page's comparison shows. All tracks are modal coordinates q of the table, so that one renderer draws
them: a node's displacement is basis (n, 3, r) times q (r).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse

from galewood.evaluation.evaluate import METHODS, played
from galewood.evaluation.measures import hausdorff
from galewood.evaluation.source import tets_of
from galewood.fem import FemModel, Simulator
from galewood.mesh import TreeMesh
from galewood.model import render_binding
from galewood.table import Table
from galewood.util import Floats
from galewood.wind import WindField, WindState, height_factor, limit_pressure, sampled_peak_pa, to_tree_frame

OnProgress = Callable[[float, str], None]

COMPARED = ("modal", "paper")


@dataclass(frozen=True)
class Place:
    """Where the tree stands, and the moment at which its comparison begins."""

    x_m: float = 0.0
    z_m: float = 0.0
    yaw_rad: float = 0.0
    start_s: float = 0.0


@dataclass(frozen=True)
class Errors:
    """Per frame, over the tree's height: the farthest node, and the Hausdorff distance of the nodes."""

    max: Floats  # (frames,)
    hausdorff: Floats  # (frames,)


@dataclass(frozen=True)
class Comparison:
    """frames × r coordinates by each way, the pressure they had in common, and how far they are apart."""

    pressure_pa: Floats  # (frames, 2) in the tree's own frame
    q: dict[str, Floats]  # fem, tangent, paper: (frames, r)
    sway: Floats  # (frames,) farthest node of the finite elements from rest, over the height
    errors: dict[str, Errors]  # tangent, paper
    left_out: Floats  # (frames,) of the true motion, what no q of this table can show, over the height


def nodes_on_wood(table: Table, model: FemModel, tree: TreeMesh) -> scipy.sparse.csr_matrix:
    """(n, N) weights that make the table's nodes of the model's vertices.

    A node is the mean of the render vertices that it stands for, which hang on the wood as they did when the
    table was built.
    """
    label = table.vertex_node.astype(np.int64)
    count = np.bincount(label, minlength=len(table.node_rest_m))
    mean = scipy.sparse.csr_matrix(
        (1.0 / count[label], (label, np.arange(len(label)))), shape=(len(count), len(label))
    )
    return scipy.sparse.csr_matrix(mean @ render_binding(tree, tets_of(model)))


def comparison_tracks(
    table: Table,
    model: FemModel,
    nodes: scipy.sparse.csr_matrix,
    wind: WindState,
    place: Place,
    frames: int,
    on_progress: OnProgress,
) -> Comparison:
    """Play a wind at a place, ``nodes`` as from ``nodes_on_wood``.

    ``tick`` hears the share done and may raise to stop.
    """
    pressure_pa = pressure_at(table, wind, place, frames)
    rest_m, height_m = table.node_rest_m.astype(np.float64), float(table.metadata["height_m"])
    reference = _simulate(model, nodes, pressure_pa, lambda share: on_progress(0.8 * share, "Simulating"))
    basis = table.node_basis.astype(np.float64).reshape(-1, len(table.mode_scale))
    rendered = np.asarray(
        np.linalg.lstsq(basis, reference.reshape(frames, -1).T, rcond=None)[0].T, np.float64
    )
    q, errors = {"fem": rendered}, {}
    for k, name in enumerate(COMPARED):
        on_progress(0.8 + 0.1 * k, "Comparing")
        q[name], _ = played(table, pressure_pa, METHODS[name])
        errors[name] = _errors((q[name] @ basis.T).reshape(reference.shape), reference, rest_m, height_m)
    left_out = _farthest((rendered @ basis.T).reshape(reference.shape) - reference, height_m)
    on_progress(1.0, "Done")
    return Comparison(pressure_pa, q, _farthest(reference, height_m), errors, left_out)


def pressure_at(table: Table, wind: WindState, place: Place, frames: int) -> Floats:
    """(frames, 2) Pa in the tree's own frame, frame i at start + (i + 1) steps, exactly as a forest feels it.

    That is: with the height of the tree in the wind's profile, and no stronger than the table has sampled.
    """
    field, dt_s = WindField(wind), float(table.metadata["dt_s"])
    peak_pa, height_m = sampled_peak_pa(table.pressure_pa), np.array([float(table.metadata["height_m"])])
    x_m, z_m = np.array([place.x_m]), np.array([place.z_m])
    world = np.zeros((2, frames, 1), np.float32)
    for frame in range(frames):
        time_s = place.start_s + (frame + 1) * dt_s
        now = field.at(time_s).wind
        factor = height_factor(height_m, now.height_exponent, now.reference_height_m)
        field.pressure(x_m, z_m, time_s, world[0, frame], world[1, frame], factor)
        limit_pressure(world[0, frame], world[1, frame], peak_pa)
    own = to_tree_frame(world[0, :, 0].astype(np.float64), world[1, :, 0].astype(np.float64), place.yaw_rad)
    return np.stack(own, axis=1)


def _simulate(
    model: FemModel, nodes: scipy.sparse.csr_matrix, pressure_pa: Floats, on_progress: Callable[[float], None]
) -> Floats:
    """(frames, n, 3) displacements of the nodes (n, N) of the model's vertices."""
    simulator, frames = Simulator(model), len(pressure_pa)
    at_rest = nodes @ simulator.u[: model.vertex_count]
    track = np.empty((frames, len(at_rest), 3))
    for frame, pressure in enumerate(pressure_pa):
        on_progress(frame / frames)
        simulator.step(pressure)
        track[frame] = nodes @ simulator.u[: model.vertex_count]
    return track


def _errors(track: Floats, reference: Floats, rest_m: Floats, height_m: float) -> Errors:
    apart = [hausdorff(rest_m + one, rest_m + other) for one, other in zip(track, reference, strict=True)]
    return Errors(_farthest(track - reference, height_m), np.array(apart) / height_m)


def _farthest(displacement_m: Floats, height_m: float) -> Floats:
    """(frames,) longest of (frames, n, 3) vectors, over the height."""
    longest: Floats = np.linalg.norm(displacement_m, axis=2).max(axis=1) / height_m
    return longest
