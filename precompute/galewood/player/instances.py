"""Trees that stand side by side: where, turned how, how large, and so at which pace each goes on."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from galewood.util import Floats


class TreeInstances:
    """What both methods keep of their trees; twin of web/src/pacedTrees.ts."""

    def __init__(self, count: int, mode_scale: npt.NDArray[np.float32], dt_s: float) -> None:
        """``count`` trees at rest; mode_scale (r,) is the stream's unit of q, dt_s the table's step."""
        modes = len(mode_scale)
        self._scale, self._dt_s = mode_scale.astype(np.float64), dt_s
        self._now, self._before = np.zeros((count, modes)), np.zeros((count, modes))
        self._phase, self._rate, self._size = np.zeros(count), np.zeros(count), np.ones(count)
        self._turn = np.tile(np.array([1.0, 0.0]), (count, 1))
        self.x_m, self.z_m = np.zeros(count, np.float32), np.zeros(count, np.float32)
        self.q = np.zeros((count, modes), np.float32)
        """(count, r) shown pose, between the last two steps."""

    def set_trees(
        self, x_m: npt.ArrayLike, z_m: npt.ArrayLike, yaw_rad: npt.ArrayLike, scale: npt.ArrayLike
    ) -> None:
        """Place, turn and size of each tree (count,); their state goes on."""
        self.x_m[:], self.z_m[:] = x_m, z_m
        yaw = np.asarray(yaw_rad, np.float32).astype(np.float64)
        # Rounded: the last bit of a cosine is nobody's promise.
        self._turn[:, 0] = np.cos(yaw).astype(np.float32)
        self._turn[:, 1] = np.sin(yaw).astype(np.float32)
        self._size[:] = np.asarray(scale, np.float32)

    def _passing(
        self, dt_s: float, pressure_x: npt.ArrayLike, pressure_z: npt.ArrayLike
    ) -> tuple[Floats, Floats]:
        """Sets how many steps each tree goes in dt_s (large ones sway slower); the pressures as numbers."""
        np.divide(dt_s / self._dt_s, self._size, out=self._rate)
        return np.asarray(pressure_x, np.float64), np.asarray(pressure_z, np.float64)

    def poses(self) -> npt.NDArray[np.int32]:
        """(count, r) shown pose in units of the table's mode scale, as the stream sends it."""
        return np.rint(self.q / self._scale).astype(np.int32)
