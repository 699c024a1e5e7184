"""Views of an impostor: a grid on the upper hemisphere, which an octahedron maps to a square.

The rim of the square is the horizon. After Engelhardt and Dachsbacher, Octahedron Environment Maps (2008);
the same as the page's own impostors (web/src/scene/impostors/baking/octahedral.ts). In the axes of the table,
y up.
"""

from __future__ import annotations

import numpy as np

from galewood.util import Floats

VIEWS_PER_SIDE = 8
"""Even, so that the zenith, where a picture has no upright axis, is no view."""


def directions_at(square: Floats) -> Floats:
    """Unit vectors (n, 3) of the upper hemisphere at places (n, 2) of the square [-1, 1]²."""
    x, z = 0.5 * (square[:, 0] + square[:, 1]), 0.5 * (square[:, 0] - square[:, 1])
    found = np.stack([x, np.maximum(1.0 - np.abs(x) - np.abs(z), 0.0), z], axis=1)
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def squares_at(directions: Floats) -> Floats:
    """Places (n, 2) in the square of directions (n, 3); those below the horizon are lifted to it."""
    x, y, z = directions.T
    total = np.abs(x) + np.maximum(y, 0.0) + np.abs(z)
    return np.stack([x + z, x - z], axis=1) / total[:, None]


def view_directions() -> Floats:
    """(VIEWS_PER_SIDE², 3) directions towards the eye, row by row from the top of the picture."""
    side = np.linspace(-1.0, 1.0, VIEWS_PER_SIDE)
    row, column = np.divmod(np.arange(VIEWS_PER_SIDE**2), VIEWS_PER_SIDE)
    return directions_at(np.stack([side[column], side[row]], axis=1))


def view_axes(direction: Floats) -> Floats:
    """(3, 3) rows: to the right, upwards and towards the eye of the picture seen from a direction (3,)."""
    x, _, z = direction
    right = np.array([z, 0.0, -x]) / np.hypot(x, z)
    axes: Floats = np.stack([right, np.cross(direction, right), direction]).astype(np.float64)
    return axes
