"""Which axis of an accelerometer is vertical: that of the mean acceleration, which is gravity."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from galewood.util import Floats

GRAVITY_UNITS = {"m/s²": 9.80665, "g": 1.0, "mg": 1000.0}
"""Gravity in each unit of an acceleration."""
GRAVITY_TOLERANCE = 0.15
"""Sensors are out of calibration by some per cent; what is farther off is not gravity."""
LEVEL_WITHIN_DEG = 10.0
"""An axis that leans less is taken as vertical: it mixes less than a fifth of the others' sway."""


class Levelled(NamedTuple):
    """Accelerations (n, 1 or 2) along level axes.

    kept: indices of the axes that they are; empty: all were turned by lean_deg. vertical: index of the axis
    of gravity (None: turned). unit: that in which the mean acceleration is gravity.
    """

    values: Floats
    kept: tuple[int, ...]
    vertical: int | None
    lean_deg: float
    unit: str


def levelled(values: Floats, units: Sequence[str]) -> Levelled | None:
    """The level axes of accelerations (n, 2 or 3), NaN where one is missing; None: they have no gravity.

    ``units``: those in which the values may be.
    """
    if not np.isfinite(values).any(axis=0).all():
        return None
    mean = np.nanmean(values, axis=0)
    size = float(np.linalg.norm(mean))
    unit = next((one for one in units if abs(size / GRAVITY_UNITS[one] - 1) <= GRAVITY_TOLERANCE), None)
    if unit is None:
        return None
    steepest = int(np.argmax(np.abs(mean)))
    lean_deg = float(np.degrees(np.arccos(min(abs(float(mean[steepest])) / size, 1.0))))
    if lean_deg <= LEVEL_WITHIN_DEG or len(mean) < 3:
        kept = tuple(axis for axis in range(len(mean)) if axis != steepest)
        return Levelled(values[:, kept], kept, steepest, lean_deg, unit)
    return Levelled(values @ _level_axes(mean / size).T, (), None, lean_deg, unit)


def _level_axes(vertical: Floats) -> Floats:
    """(2, 3) level unit vectors, the first as near as possible to the axis that is most level."""
    axis = np.eye(3)[int(np.argmin(np.abs(vertical)))]
    level = axis - float(axis @ vertical) * vertical
    first = level / float(np.linalg.norm(level))
    return np.array([first, np.cross(vertical, first)], np.float64)
