"""Motion of one tree under one wind: the reference solution and both methods of its table.

The comparison of the web page shows it. All tracks are modal coordinates q of the table, so that one renderer
draws them: the displacement of the nodes is basis (n, 3, r) times q (r).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse

from galewood.check.evaluation.evaluate import methods_of, play_pressures
from galewood.check.evaluation.measures import hausdorff
from galewood.check.evaluation.source import tets_of
from galewood.motion.wind import WindField, WindState, height_factor, limit_pressure, to_tree_frame
from galewood.options import METHOD_NAMES
from galewood.solid.fem import FemModel, Simulator
from galewood.solid.skinning import points_embedding
from galewood.table import Table
from galewood.util import Floats

OnProgress = Callable[[float, str], None]


@dataclass(frozen=True)
class Place:
    """Position and yaw of the tree, and the time at which the comparison starts."""

    x_m: float = 0.0
    z_m: float = 0.0
    yaw_rad: float = 0.0
    start_s: float = 0.0


@dataclass(frozen=True)
class Errors:
    """Per frame, over the tree's height: largest node error, and Hausdorff distance of the nodes."""

    max: Floats  # (frames,)
    hausdorff: Floats  # (frames,)


@dataclass(frozen=True)
class Comparison:
    """Coordinates of all motions, their common pressure, and their errors; "paper" only with its records."""

    pressure_pa: Floats  # (frames, 2) in the tree's own frame
    q: dict[str, Floats]  # fem, modal, paper: (frames, r)
    sway: Floats  # (frames,) largest node displacement of the reference solution, over the height
    errors: dict[str, Errors]  # modal, paper
    left_out: Floats  # (frames,) largest part of the reference outside the basis, over the height


def nodes_on_wood(table: Table, model: FemModel) -> scipy.sparse.csr_matrix:
    """(n, N) weights of the table's nodes on the vertices of the model."""
    return points_embedding(table.node_rest_m, tets_of(model))


def comparison_tracks(
    table: Table,
    model: FemModel,
    nodes: scipy.sparse.csr_matrix,
    wind: WindState,
    place: Place,
    frames: int,
    on_progress: OnProgress,
) -> Comparison:
    """Compute the motions of a tree at a place in a wind; ``nodes`` comes from ``nodes_on_wood``.

    ``on_progress`` gets the fraction 0..1 and a message; it may raise to cancel. Raises FloatingPointError if
    the reference simulation diverges.
    """
    pressure_pa = pressure_at(table, wind, place, frames)
    rest_m, height_m = table.node_rest_m.astype(np.float64), float(table.metadata["height_m"])
    reference = _simulate(model, nodes, pressure_pa, lambda share: on_progress(0.8 * share, "Simulating"))
    basis = table.node_basis.astype(np.float64).reshape(-1, len(table.mode_scale))
    projected = np.asarray(
        np.linalg.lstsq(basis, reference.reshape(frames, -1).T, rcond=None)[0].T, np.float64
    )
    q, errors = {"fem": projected}, {}
    makes = methods_of(table)
    for k, name in enumerate(name for name in METHOD_NAMES if name in makes):
        on_progress(0.8 + 0.1 * k, "Comparing")
        q[name], _ = play_pressures(table, pressure_pa, makes[name])
        errors[name] = _errors((q[name] @ basis.T).reshape(reference.shape), reference, rest_m, height_m)
    left_out = _farthest((projected @ basis.T).reshape(reference.shape) - reference, height_m)
    on_progress(1.0, "Done")
    return Comparison(pressure_pa, q, _farthest(reference, height_m), errors, left_out)


def pressure_at(table: Table, wind: WindState, place: Place, frames: int) -> Floats:
    """(frames, 2) Pa in the tree's frame, frame i at start + (i + 1) steps, exactly as in a forest.

    The tree's height enters the wind profile, and the pressure is limited to the sampled peak.
    """
    field, dt_s = WindField(wind), float(table.metadata["dt_s"])
    peak_pa, exponent = table.peak_pressure_pa, table.streamlined_exponent
    height_m = np.array([float(table.metadata["height_m"])])
    x_m, z_m = np.array([place.x_m]), np.array([place.z_m])
    world = np.zeros((2, frames, 1), np.float32)
    for frame in range(frames):
        time_s = place.start_s + (frame + 1) * dt_s
        now = field.at(time_s).wind
        factor = height_factor(height_m, now.height_exponent, now.reference_height_m)
        field.pressure(x_m, z_m, time_s, world[0, frame], world[1, frame], exponent, factor)
        limit_pressure(world[0, frame], world[1, frame], peak_pa)
    own = to_tree_frame(world[0, :, 0].astype(np.float64), world[1, :, 0].astype(np.float64), place.yaw_rad)
    return np.stack(own, axis=1)


def _simulate(
    model: FemModel, nodes: scipy.sparse.csr_matrix, pressure_pa: Floats, on_progress: Callable[[float], None]
) -> Floats:
    """(frames, n, 3) displacement of the nodes, m; ``nodes`` (n, N) are their weights on the model."""
    simulator, frames = Simulator(model), len(pressure_pa)
    at_rest = nodes @ simulator.u[: model.vertex_count]
    track = np.empty((frames, len(at_rest), 3))
    for frame, pressure in enumerate(pressure_pa):
        on_progress(frame / frames)
        simulator.step(pressure)
        track[frame] = nodes @ simulator.u[: model.vertex_count]
    return track


def _errors(track: Floats, reference: Floats, rest_m: Floats, height_m: float) -> Errors:
    distances = [hausdorff(rest_m + one, rest_m + other) for one, other in zip(track, reference, strict=True)]
    return Errors(_farthest(track - reference, height_m), np.array(distances) / height_m)


def _farthest(displacement_m: Floats, height_m: float) -> Floats:
    """(frames,) length of the longest of the vectors (frames, n, 3), over the height."""
    longest: Floats = np.linalg.norm(displacement_m, axis=2).max(axis=1) / height_m
    return longest
