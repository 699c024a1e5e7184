"""A table beside the finite elements it was made from, on winds that were not sampled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from precompute.dynamics import FemModel, Simulator
from precompute.lookup import ForestLookup
from precompute.table import Table
from precompute.wind import dynamic_pressure

Floats = npt.NDArray[np.float64]


def unseen_winds(design_speed_m_s: float, frames: int, dt_s: float) -> dict[str, Floats]:
    """Pressures (frames, 2) Pa that no sample has: other periods and directions, a step, a gust then calm."""
    t = np.arange(frames, dtype=np.float64) * dt_s
    swing = 0.5 * np.sin(2 * np.pi * t / 4.3) + 0.5 * np.sin(2 * np.pi * t / 1.7 + 1.0)
    speeds = {
        "new-period-000": (0.0, 0.65 * (1 + 0.4 * np.cos(2 * np.pi * t / 2.9))),
        "between-030": (30.0, 0.6 * (1 + 0.4 * np.cos(2 * np.pi * t / 3.7 + np.pi))),
        "two-tones-200": (200.0, 0.5 * (1 + 0.6 * swing)),
        "step-100": (100.0, np.where(t < 1.0, 0.2, 0.7)),
        "gust-then-still-015": (15.0, 0.7 * np.sin(np.pi * np.clip(t / 3.0, 0.0, 1.0)) ** 2 * (t < 3.0)),
    }
    return {
        name: dynamic_pressure(design_speed_m_s * speed)[:, None]
        * np.array([np.cos(np.radians(deg)), np.sin(np.radians(deg))])
        for name, (deg, speed) in speeds.items()
    }


def fem_nodes(model: FemModel, table: Table, pressure_pa: Floats) -> Floats:
    """(frames, n, 3) node displacements of the finite elements, seen through the table's own basis.

    The nodes' basis is fitted to the model's vertices nearest to them, so that both move the same points.
    """
    simulator = Simulator(model)
    vertices = model.nodes_m[: model.vertex_count]
    gap = np.linalg.norm(vertices[None] - table.node_rest_m[:, None].astype(np.float64), axis=2)
    nearest = gap.argmin(axis=1)
    track = np.empty((len(pressure_pa), len(nearest), 3))
    for frame, pressure in enumerate(pressure_pa):
        simulator.step(pressure)
        track[frame] = simulator.u[nearest]
    return track


def table_nodes(table: Table, pressure_pa: Floats, **options: Any) -> Floats:
    """(frames, n, 3) node displacements of a tree that looks the table up."""
    forest = ForestLookup(table, 1, **options)
    dt_s = float(table.metadata["dt_s"])
    poses = np.empty((len(pressure_pa), len(table.mode_scale)))
    basis = table.node_basis.astype(np.float64)
    for frame, (x, z) in enumerate(pressure_pa):
        forest.advance(dt_s, [x], [z])
        poses[frame] = forest.q[0]
    return np.einsum("nik,tk->tni", basis, poses)


def evaluate_table(
    table: Table, model: FemModel, frames: int, tick: Callable[[float, str], None]
) -> dict[str, Any]:
    """Errors over the height of the eased and the literal search on unseen winds, and of not moving."""
    winds = unseen_winds(float(table.metadata["design_speed_m_s"]), frames, float(table.metadata["dt_s"]))
    figures: dict[str, Any] = {}
    methods: dict[str, dict[str, Any]] = {
        "paper": {},
        "paper-literal": {"pose_easing": 0.0, "still_air": False},
    }
    for k, (name, pressure) in enumerate(winds.items()):
        tick(k / len(winds), f"Simulating {name}")
        truth = fem_nodes(model, table, pressure)
        height_m = float(table.metadata["height_m"])
        figures[name] = {
            method: compare(table_nodes(table, pressure, **options), truth, height_m)
            for method, options in methods.items()
        }
        figures[name]["rest-pose"] = compare(np.zeros_like(truth), truth, height_m)
    tick(1.0, "Done")
    return figures


def compare(track: Floats, truth: Floats, height_m: float) -> dict[str, float]:
    """How far one motion of nodes (frames, n, 3) is from the true one."""
    error = np.linalg.norm(track - truth, axis=2)
    half = len(error) // 2
    lean, true_lean = track[:, :, [0, 2]].mean(axis=0).ravel(), truth[:, :, [0, 2]].mean(axis=0).ravel()
    return {
        "max_error": float(error.max() / height_m),
        "rms_error": float(np.sqrt(np.mean(error**2)) / height_m),
        "true_sway": float(np.linalg.norm(truth, axis=2).max() / height_m),
        "growth": float(error[half:].max() / max(error[:half].max(), 1e-12)),
        "lean": float(lean @ true_lean / max(true_lean @ true_lean, 1e-30)),
        "largest_step": _largest_step(track) / max(_largest_step(truth), 1e-12),
    }


def _largest_step(track: Floats) -> float:
    return float(np.linalg.norm(np.diff(track, axis=0), axis=2).max())
