"""What is drawn of a table: far poses, in which its stretch is measured, and whether it may be seen.

A tree sways far in several headings and in a storm, and is pulled. Skinning weights are smoothed for one
choice of such poses and the stretch is measured in another, with other headings, another wind and other
points that are pulled.
"""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from galewood.constants import PULL_MOST_REACH
from galewood.motion.wind import Wind, WindField
from galewood.pipeline.tables.expected import STORM_M_S
from galewood.player import WindDrivenTrees, point_response
from galewood.solid.skinning import FIGURE_SWAY, is_torn, stretch_words
from galewood.table import Table, encode
from galewood.util import Floats, Ints

log = logging.getLogger("galewood.build")
HEADING_COUNT = 4
STRONG_M_S = 30.0
"""Mean speed of the wind whose farthest sways are scaled to the sway of the figures."""
PLAYED_FRAMES = 150
PULLS_PER_POINT = 2
LOWEST_PULL = 0.3
"""Height above which points are pulled, relative to that of the tree."""


@dataclass(frozen=True)
class PoseChoice:
    """The first of the headings, degrees, the seed of the wind, and the points that are pulled."""

    heading_deg: float
    seed: int
    pulled_points: int = 12
    spread: bool = False
    """Points far from each other, so that each limb has one; otherwise random vertices."""


FITTED_POSES = PoseChoice(0.0, 11, pulled_points=48, spread=True)
"""Weights are smoothed for pulls at many points, as a pull bends the limb that is pulled and few others."""
CHECKED_POSES = PoseChoice(25.0, 12)


def drawn_poses(table: Table, rest_m: Floats, wood: Ints, choice: PoseChoice) -> Floats:
    """(k, r) far poses of a table whose vertices rest at rest_m (v, 3), of them those of ``wood`` (w,)."""
    height_m = float(table.metadata["height_m"])
    basis = table.node_basis.astype(np.float64)
    top = basis[int(table.node_rest_m[:, 1].argmax())]
    found: list[Floats] = [np.zeros((0, basis.shape[2]))]
    for q in _played(table, STRONG_M_S, choice):
        sway = np.linalg.norm(q @ top.T, axis=1) / height_m
        far = int(sway.argmax())
        if sway[far] > 0:
            found.append(q[far : far + 1] * (FIGURE_SWAY / sway[far]))
    for q in _played(table, STORM_M_S, choice):
        moved = np.linalg.norm(np.tensordot(q, basis, axes=(1, 2)), axis=2)  # (T, n)
        found.append(q[[int(np.linalg.norm(q @ top.T, axis=1).argmax()), int(moved.max(axis=1).argmax())]])
    return np.concatenate([*found, *_pulled(table, rest_m, wood, choice)])


def _played(table: Table, speed_m_s: float, choice: PoseChoice) -> Floats:
    """(headings, T, r) the motion in a wind from each heading."""
    yaw = np.radians(choice.heading_deg + np.arange(HEADING_COUNT) * 360 / HEADING_COUNT)
    place_m = 10.0 * float(table.metadata["height_m"]) * np.arange(HEADING_COUNT)
    rows = np.column_stack([place_m, 0 * yaw, yaw, np.ones(HEADING_COUNT)])
    trees = WindDrivenTrees(table, rows)
    field, dt_s = WindField(Wind(mean_speed_m_s=speed_m_s, seed=choice.seed)), float(table.metadata["dt_s"])
    motion = np.zeros((HEADING_COUNT, PLAYED_FRAMES, len(table.mode_scale)))
    for frame in range(PLAYED_FRAMES):
        trees.step(field, (frame + 1) * dt_s, dt_s)
        motion[:, frame] = trees.q
    return motion


def _pulled(table: Table, rest_m: Floats, wood: Ints, choice: PoseChoice) -> list[Floats]:
    """Static poses (1, r) of the modes, pulled sideways as far as a hand may at the top and other points."""
    height_m, random = float(table.metadata["height_m"]), np.random.default_rng(choice.seed)
    high = wood[rest_m[wood, 1] > LOWEST_PULL * height_m]
    if not len(high):
        return []
    top = int(rest_m[high, 1].argmax())
    chosen = (
        farthest_points(rest_m[high], top, choice.pulled_points)
        if choice.spread
        else [top, *random.choice(len(high), choice.pulled_points - 1)]
    )
    found: list[Floats] = []
    for point in high[chosen]:
        response = point_response(table, int(point))
        for angle in random.uniform(0, np.pi) + np.arange(PULLS_PER_POINT) * np.pi / PULLS_PER_POINT:
            q = response.pose @ np.array([np.cos(angle), 0.0, np.sin(angle)])
            moved_m = float(np.linalg.norm(response.point @ q))
            if moved_m > 0:
                found.append(q[None] * (PULL_MOST_REACH * height_m / moved_m))
    return found


def farthest_points(place_m: Floats, first: int, count: int) -> list[int]:
    """The first of some places (n, 3), and as many others, each farthest from those before it."""
    chosen, away_m = [first], np.full(len(place_m), np.inf)
    for _ in range(count - 1):
        away_m = np.minimum(away_m, np.linalg.norm(place_m - place_m[chosen[-1]], axis=1))
        chosen.append(int(away_m.argmax()))
    return chosen


def encoded_unless_torn(table: Table) -> bytes | None:
    """The file of a preliminary table; None if it tears the tree, which stands still until the next one."""
    drawn = table.metadata.get("drawn", {})
    if not is_torn(drawn):
        return encode(table)
    log.info("the table '%s' %s", table.metadata["provenance"]["stage"], stretch_words(drawn))
    return None
