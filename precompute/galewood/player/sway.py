"""Plays a table under a wind without rendering and measures the sway."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.motion.wind import Wind, WindField
from galewood.options import Method
from galewood.player.wind_driven import WindDrivenTrees
from galewood.table import Table
from galewood.util import Floats

SPACING_M = 10.0


def grid_placements(count: int, seed: int = 0) -> tuple[Floats, Floats, Floats, Floats]:
    """x, z (m), yaw (rad) and scale (count,) of trees on a jittered grid; deterministic for a seed."""
    rng = np.random.default_rng(seed)
    side = int(np.ceil(np.sqrt(count)))
    cell = np.stack(np.divmod(np.arange(count), side))
    x, z = SPACING_M * (cell + rng.uniform(-0.3, 0.3, (2, count)))
    return x, z, rng.uniform(-np.pi, np.pi, count), rng.uniform(0.8, 1.2, count)


def play(table: Table, wind: Wind, seconds: float, trees: int, method: Method = "modal") -> dict[str, Any]:
    """Play ``trees`` trees and return sway and downwind lean of the top node, over the height."""
    x, z, yaw, scale = grid_placements(trees)
    forest = WindDrivenTrees(table, np.column_stack([x, z, yaw, scale]), method)
    top, dt_s, field = int(np.argmax(table.node_rest_m[:, 1])), float(table.metadata["dt_s"]), WindField(wind)
    track = np.zeros((round(seconds / dt_s), trees, 3))
    for frame in range(len(track)):
        forest.step(field, frame * dt_s, dt_s)
        track[frame] = forest.q @ table.node_basis[top].T
    return _figures(track, yaw, np.radians(wind.direction_deg), float(table.metadata["height_m"]))


def _figures(track: Floats, yaw: Floats, heading: float, height_m: float) -> dict[str, Any]:
    own = heading + yaw  # the world's direction in each tree's frame
    along = track[..., 0] * np.cos(own) + track[..., 2] * np.sin(own)
    settled = along[len(along) // 4 :]
    return {
        "frames": len(track),
        "trees": track.shape[1],
        "largest_sway": float(np.linalg.norm(track, axis=2).max() / height_m),
        "mean_lean_downwind": float(settled.mean() / height_m),
        "sway_about_the_mean": float(settled.std(axis=0).mean() / height_m),
        "largest_step": float(np.linalg.norm(np.diff(track, axis=0), axis=2).max() / height_m),
    }
