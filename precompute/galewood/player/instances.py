"""Tree instances of one table: position, yaw, size, and the time step that follows from the size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.util import Array, Floats

TREE_ARRAYS = ("_now", "_before", "_phase", "_rate", "_size", "_turn", "x_m", "z_m", "q")
"""Attributes of ``TreeInstances`` with a row for each tree."""


@dataclass(frozen=True)
class Standing:
    """Where trees stand: arrays of their instances, not copies."""

    x_m: Array  # (n,)
    z_m: Array  # (n,)
    turn: Floats  # (n, 2) cosine and sine of the yaw
    size: Floats  # (n,) scale


class TreeInstances:
    """State of the trees that both methods share."""

    def __init__(self, count: int, mode_scale: npt.NDArray[np.float32], dt_s: float) -> None:
        """Create ``count`` trees at rest; dt_s: table step, s; mode_scale (r,): unit of streamed q."""
        modes = len(mode_scale)
        self._scale, self._dt_s = mode_scale.astype(np.float64), dt_s
        self._now, self._before = np.zeros((count, modes)), np.zeros((count, modes))
        self._phase, self._rate, self._size = np.zeros(count), np.zeros(count), np.ones(count)
        self._turn = np.tile(np.array([1.0, 0.0]), (count, 1))
        self.x_m, self.z_m = np.zeros(count, np.float32), np.zeros(count, np.float32)
        self.q = np.zeros((count, modes), np.float32)
        """(count, r) pose, interpolated between the last two steps."""

    def set_trees(
        self, x_m: npt.ArrayLike, z_m: npt.ArrayLike, yaw_rad: npt.ArrayLike, scale: npt.ArrayLike
    ) -> None:
        """Set position, yaw and size of each tree (count,); the state of motion is unchanged."""
        self.x_m[:], self.z_m[:] = x_m, z_m
        yaw = np.asarray(yaw_rad, np.float32).astype(np.float64)
        # Rounded, as the last bits of a cosine differ between libraries.
        self._turn[:, 0] = np.cos(yaw).astype(np.float32)
        self._turn[:, 1] = np.sin(yaw).astype(np.float32)
        self._size[:] = np.asarray(scale, np.float32)

    @property
    def standing(self) -> Standing:
        """Where the trees stand."""
        return Standing(self.x_m, self.z_m, self._turn, self._size)

    @property
    def steps(self) -> tuple[Floats, Floats, Floats]:
        """Poses (count, r) before and after the last step, and the share (count,) of it that is shown."""
        return self._before, self._now, self._phase

    @property
    def period_s(self) -> Floats:
        """(count,) time of a step of each tree, s."""
        return self._dt_s * self._size

    def _begin(
        self, dt_s: float, pressure_x: npt.ArrayLike, pressure_z: npt.ArrayLike
    ) -> tuple[Floats, Floats]:
        """Set the steps of each tree in dt_s (large trees sway slower); return the pressures as float64."""
        np.divide(dt_s / self._dt_s, self._size, out=self._rate)
        return np.asarray(pressure_x, np.float64), np.asarray(pressure_z, np.float64)

    def poses(self) -> npt.NDArray[np.int32]:
        """(count, r) poses in units of the table's mode scale, as the stream sends them."""
        return np.rint(self.q / self._scale).astype(np.int32)
