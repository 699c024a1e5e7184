"""A measured wind: the fluctuations of a recording, carried downwind unchanged (Taylor 1938)."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba
import numpy as np

from galewood.constants import RECORDED_LATERAL_SHARE
from galewood.motion.wind.document import Wind
from galewood.motion.wind.models.frame import view_of, write_velocity
from galewood.motion.wind.recording import Recording
from galewood.util import Floats


class RecordedGusts:
    """The gusts of one recording."""

    def __init__(self, recording: Recording) -> None:
        """Decode the samples."""
        self._samples = np.ascontiguousarray(recording.fluctuations())
        self._interval_s = recording.interval_s

    def velocity(
        self, wind: Wind, time_s: float, x_m: Floats, z_m: Floats, out_x: Floats, out_z: Floats
    ) -> None:
        """Write the velocity (m/s, world x and z) at each position (m)."""
        view = view_of(wind, 0.0, RECORDED_LATERAL_SHARE)
        now = (time_s, wind.convection_speed_m_s, self._interval_s)
        _sample(self._samples, now, view, x_m, z_m, out_x, out_z)


@numba.njit(cache=True, nogil=True)
def _sample(samples, now, view, x_m, z_m, out_x, out_z):  # pragma: no cover  (compiled)
    """Cubic interpolation (Catmull–Rom): it passes through the samples, and the load has no kinks."""
    time_s, convection_m_s, interval_s = now
    count = len(samples)
    for i in range(len(x_m)):
        age_s = time_s - (view.cos * x_m[i] + view.sin * z_m[i]) / convection_m_s
        position = age_s / interval_s
        first = math.floor(position)
        t = position - first
        k1 = int(first) % count
        k0, k2, k3 = (k1 - 1) % count, (k1 + 1) % count, (k1 + 2) % count
        w0 = 0.5 * t * (t * (2.0 - t) - 1.0)
        w1 = 0.5 * (t * t * (3.0 * t - 5.0) + 2.0)
        w2 = 0.5 * t * (t * (4.0 - 3.0 * t) + 1.0)
        w3 = 0.5 * t * t * (t - 1.0)
        a = w0 * samples[k0, 0] + w1 * samples[k1, 0] + w2 * samples[k2, 0] + w3 * samples[k3, 0]
        b = w0 * samples[k0, 1] + w1 * samples[k1, 1] + w2 * samples[k2, 1] + w3 * samples[k3, 1]
        write_velocity(view, i, a, b, out_x, out_z)
