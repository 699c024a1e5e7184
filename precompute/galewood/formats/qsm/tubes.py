"""Closed tubes around the lines of branches."""

from __future__ import annotations

import numpy as np

from galewood.formats.qsm.branches import Line
from galewood.util import Floats, Int32s

SIDES = ((0.015, 5), (0.03, 6), (0.08, 8), (np.inf, 10))
"""Largest radius at the base, m, and the number of sides of such a tube."""


def tube_faces(line: Line) -> int:
    """Number of triangles of the tube around a line."""
    sides = _sides(line)
    return 2 * sides * len(line.radius_m) - 2


def tube(line: Line) -> tuple[Floats, Int32s]:
    """Vertices (n, 3) and faces (m, 3) of the closed tube around a line, with normals outwards.

    Each ring is a polygon of the area of the circle. The base is flat, the tip is a cone as high as wide.
    """
    sides, rings = _sides(line), len(line.radius_m)
    tangent, across = _frames(line.points_m)
    angle = 2 * np.pi * np.arange(sides) / sides
    size = np.sqrt(angle[1] / np.sin(angle[1]))
    around = (
        np.cos(angle)[:, None] * across[:, None] + np.sin(angle)[:, None] * np.cross(tangent, across)[:, None]
    )
    vertices = line.points_m[:, None] + (size * line.radius_m)[:, None, None] * around
    tip = line.points_m[-1] + line.radius_m[-1] * tangent[-1]
    return np.vstack([vertices.reshape(-1, 3), tip]), _faces(sides, rings)


def _sides(line: Line) -> int:
    return next(sides for radius, sides in SIDES if line.radius_m[0] < radius)


def _frames(points: Floats) -> tuple[Floats, Floats]:
    """Unit tangents (k, 3) of a line, and unit vectors (k, 3) across it that do not turn around it."""
    along = np.diff(points, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    tangent = np.vstack([along[:1], along[:-1] + along[1:], along[-1:]])
    size = np.linalg.norm(tangent, axis=1, keepdims=True)
    tangent = np.where(size > 1e-6, tangent / np.maximum(size, 1e-300), np.vstack([along[:1], along]))
    across = np.zeros_like(tangent)
    side = np.cross(tangent[0], np.eye(3)[int(np.argmin(np.abs(tangent[0])))])
    across[0] = side / np.linalg.norm(side)
    for k in range(1, len(points)):
        across[k] = _carried(across[k - 1], tangent[k - 1], tangent[k])
    return tangent, across


def _carried(across: Floats, before: Floats, after: Floats) -> Floats:
    """The vector across one tangent, turned with it to the next by the smallest rotation."""
    turn = 1.0 + float(before @ after)
    moved = across - float(after @ across) / turn * (before + after) if turn > 1e-6 else across
    moved = moved - float(moved @ after) * after
    return moved / np.linalg.norm(moved)


def _faces(sides: int, rings: int) -> Int32s:
    own = np.arange(sides)
    following = np.roll(own, -1)
    start = sides * np.arange(rings - 1)[:, None]
    lower = np.stack([start + own, start + following, start + following + sides], axis=-1)
    upper = np.stack([start + own, start + following + sides, start + own + sides], axis=-1)
    base = np.column_stack([np.zeros(sides - 2, np.int64), own[2:], own[1:-1]])
    last = sides * (rings - 1)
    tip = np.column_stack([last + own, last + following, np.full(sides, sides * rings)])
    return np.concatenate([lower.reshape(-1, 3), upper.reshape(-1, 3), base, tip]).astype(np.int32)
