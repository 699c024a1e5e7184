"""A table beside the finite elements it was made from, on winds that were not sampled.

Every figure is a distance over the tree's height, at the table's nodes: each node is held against the model's
vertex nearest to it, both seen as displacements, so where a node stands for several vertices that counts too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from precompute.dynamics import FemModel, Simulator
from precompute.evaluate_winds import unseen_winds
from precompute.lookup import ForestLookup
from precompute.table import Table
from precompute.tangent import TangentForest

Floats = npt.NDArray[np.float64]
Make = Callable[[Table], ForestLookup | TangentForest]

FRAMES_SHOWN = (20, 22, 40, 60)
"""The paper's own frames (its Fig. 3), from 1."""

METHODS: dict[str, Make] = {
    "tangent": lambda table: TangentForest(table.tangent, float(table.metadata["dt_s"]), table.mode_scale, 1),
    "paper": lambda table: ForestLookup(table, 1),
    "paper-literal": lambda table: ForestLookup(table, 1, pose_easing=0.0, still_air=False),
}


@dataclass(frozen=True)
class Nodes:
    """The table's nodes at rest (n, 3) m, and the vertex of the model nearest to each."""

    rest_m: Floats
    nearest: npt.NDArray[np.int64]


def nodes_of(model: FemModel, table: Table) -> Nodes:
    """Which vertex stands for which node."""
    rest_m = table.node_rest_m.astype(np.float64)
    _, nearest = KDTree(model.nodes_m[: model.vertex_count]).query(rest_m)
    return Nodes(rest_m, np.asarray(nearest, np.int64))


def fem_nodes(model: FemModel, nodes: Nodes, pressure_pa: Floats) -> Floats:
    """(frames, n, 3) node displacements of the finite elements."""
    simulator = Simulator(model)
    track = np.empty((len(pressure_pa), len(nodes.nearest), 3))
    for frame, pressure in enumerate(pressure_pa):
        simulator.step(pressure)
        track[frame] = simulator.u[nodes.nearest]
    return track


def table_nodes(table: Table, pressure_pa: Floats, make: Make) -> tuple[Floats, float]:
    """(frames, n, 3) node displacements of one tree of the table, and its largest coverage (1 if not told).

    A shown pose lies between two steps, and right after a step it is the older one: the track is taken a
    frame later.
    """
    forest, dt_s = make(table), float(table.metadata["dt_s"])
    poses, coverage = [], 0.0
    for x, z in np.concatenate([pressure_pa, pressure_pa[-1:]]):
        forest.advance(dt_s, [x], [z])
        poses.append(forest.q[0].astype(np.float64))
        coverage = max(coverage, float(forest.coverage[0]) if isinstance(forest, TangentForest) else 1.0)
    track = np.einsum("nik,tk->tni", table.node_basis.astype(np.float64), np.array(poses[1:]))
    return track, coverage


def nearest_sample(table: Table, pressure_pa: Floats) -> Floats:
    """(frames, n, 3) the sampled run whose wind is nearest to this one, played over and over."""
    starts = table.trajectory.astype(np.int64)
    places = [np.resize(np.arange(a, b), len(pressure_pa)) for a, b in pairwise(starts.tolist())]
    gaps = [float(np.mean((table.pressure_pa[place] - pressure_pa) ** 2)) for place in places]
    poses = table.pose()[places[int(np.argmin(gaps))]] * table.mode_scale.astype(np.float64)
    return np.einsum("nik,tk->tni", table.node_basis.astype(np.float64), poses)


def evaluate_table(
    table: Table,
    model: FemModel,
    frames: int,
    tick: Callable[[float, str], None],
    *,
    strength: float = 0.65,
    seed: int = 20_001,
) -> dict[str, Any]:
    """Figures per unseen wind and method, beside a tree at rest and the nearest sampled run played back."""
    metadata, nodes = table.metadata, nodes_of(model, table)
    dt_s, height_m = float(metadata["dt_s"]), float(metadata["height_m"])
    winds = unseen_winds(float(metadata["design_speed_m_s"]), frames, dt_s, strength=strength, seed=seed)
    figures: dict[str, Any] = {}
    for k, (name, pressure) in enumerate(winds.items()):
        tick(k / len(winds), f"Simulating {name}")
        truth = fem_nodes(model, nodes, pressure)
        tracks = {method: table_nodes(table, pressure, make) for method, make in METHODS.items()}
        tracks["nearest-sample"] = (nearest_sample(table, pressure), 1.0)
        tracks["rest-pose"] = (np.zeros_like(truth), 1.0)
        figures[name] = {
            method: {**compare(track, truth, nodes.rest_m, height_m), "coverage": coverage}
            for method, (track, coverage) in tracks.items()
        }
    tick(1.0, "Done")
    return figures


def compare(track: Floats, truth: Floats, rest_m: Floats, height_m: float) -> dict[str, Any]:
    """How far one motion of nodes (frames, n, 3) is from the true one."""
    error = np.linalg.norm(track - truth, axis=2)
    half, sway = len(error) // 2, float(np.linalg.norm(truth, axis=2).max())
    shown = [frame for frame in FRAMES_SHOWN if frame <= len(error)]
    lean, true_lean = track[:, :, [0, 2]].mean(axis=0).ravel(), truth[:, :, [0, 2]].mean(axis=0).ravel()
    return {
        "max_error": float(error.max() / height_m),
        "rms_error": float(np.sqrt(np.mean(error**2)) / height_m),
        "max_error_of_sway": float(error.max() / max(sway, 1e-12)),
        "rms_error_of_sway": float(np.sqrt(np.mean(error**2)) / max(sway, 1e-12)),
        "true_sway": sway / height_m,
        "growth": float(error[half:].max() / max(error[:half].max(), 1e-12)),
        "last_error": float(error[-1].max() / height_m),
        "frames": {frame: float(error[frame - 1].max() / height_m) for frame in shown},
        "hausdorff": {
            frame: hausdorff(rest_m + track[frame - 1], rest_m + truth[frame - 1]) / height_m
            for frame in shown
        },
        "error_by_frame": [float(value) for value in error.max(axis=1) / height_m],
        "lean": float(lean @ true_lean / max(true_lean @ true_lean, 1e-30)),
        "largest_step": _largest_step(track) / max(_largest_step(truth), 1e-12),
    }


def hausdorff(a: Floats, b: Floats) -> float:
    """The farthest that a point of either set (n, 3) is from the other set, m."""
    return float(max(KDTree(a).query(b)[0].max(), KDTree(b).query(a)[0].max()))


def _largest_step(track: Floats) -> float:
    return float(np.linalg.norm(np.diff(track, axis=0), axis=2).max())
