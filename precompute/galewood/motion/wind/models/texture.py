"""Cubic B-spline sampling of a periodic gust field: twice differentiable, so that the load has no jumps."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba

from galewood.motion.wind.models.frame import write_velocity


@numba.njit(cache=True, nogil=True)
def _weights(t):  # pragma: no cover  (compiled)
    r = 1.0 - t
    t2, r2 = t * t, r * r
    return r2 * r / 6.0, (4.0 - 3.0 * t2 * (2.0 - t)) / 6.0, (4.0 - 3.0 * r2 * (2.0 - r)) / 6.0, t2 * t / 6.0


@numba.njit(cache=True, nogil=True)
def sample_texture(field, columns, rows, view, x_m, z_m, out_x, out_z):  # pragma: no cover  (compiled)
    """Write the velocity (m/s, world x and z) at positions x, z (m).

    ``field`` (2, rows · columns) holds spline coefficients of the fluctuations along and across the wind;
    both dimensions are powers of two. ``view``: see ``frame.View``.
    """
    along_gusts, across_gusts = field[0], field[1]
    for i in range(len(x_m)):
        along = view.cos_per_m * x_m[i] + view.sin_per_m * z_m[i] - view.travel
        across = view.cos_per_m * z_m[i] - view.sin_per_m * x_m[i]
        px = along * view.cells_along
        py = (across + view.slant * along) * view.cells_across
        fx, fy = math.floor(px), math.floor(py)
        x0, y0 = int(fx) - 1, int(fy) - 1
        w0, w1, w2, w3 = _weights(px - fx)
        v0, v1, v2, v3 = _weights(py - fy)
        a0, a1 = x0 & (columns - 1), (x0 + 1) & (columns - 1)
        a2, a3 = (x0 + 2) & (columns - 1), (x0 + 3) & (columns - 1)
        a, b = 0.0, 0.0
        for k in range(4):
            row = ((y0 + k) & (rows - 1)) * columns
            v = v0 if k == 0 else v1 if k == 1 else v2 if k == 2 else v3
            a += v * (
                w0 * along_gusts[row + a0]
                + w1 * along_gusts[row + a1]
                + w2 * along_gusts[row + a2]
                + w3 * along_gusts[row + a3]
            )
            b += v * (
                w0 * across_gusts[row + a0]
                + w1 * across_gusts[row + a1]
                + w2 * across_gusts[row + a2]
                + w3 * across_gusts[row + a3]
            )
        write_velocity(view, i, a, b, out_x, out_z)
