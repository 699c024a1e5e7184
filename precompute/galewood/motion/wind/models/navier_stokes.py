"""Eddies: two-dimensional stable fluids (Stam 1999) on a periodic grid that moves with the wind.

Units are grid cells and the standard deviation of the velocity. Each step advects semi-Lagrangially and then,
in Fourier space, projects onto fields with zero central-difference divergence, applies friction, adds seeded
forcing in a band of wavenumbers and rescales to unit variance, which keeps the energy constant. It uses only
+ − × ÷ and square roots in a fixed order, so that every language produces the same bits.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba
import numpy as np

from galewood.constants import (
    EDDY_BAND,
    EDDY_CELLS_PER_STEP,
    EDDY_FRICTION,
    EDDY_GRID,
    EDDY_KICK,
    EDDY_LARGE_SCALE_FRICTION,
    EDDY_SLOWEST_START,
)
from galewood.motion.wind.models.fourier import Floats, roots_of_unity, transform_columns, transform_rows
from galewood.motion.wind.models.hashing import hash32, signed_uniform


class Eddies:
    """One run of the solver from a seeded start; ``velocity`` (2, GRID²) holds the x and y components."""

    def __init__(self, seed: int) -> None:
        """Start from a seeded divergence-free field of unit variance."""
        self._seed = seed
        self._roots = roots_of_unity(EDDY_GRID)
        self._scratch = np.zeros((2, EDDY_GRID * EDDY_GRID))
        self.steps = 0
        self.velocity: Floats = np.zeros((2, EDDY_GRID * EDDY_GRID))
        _start(self.velocity[0], self.velocity[1], seed)
        self._correct(0.0)

    def step(self) -> None:
        """Advance by one fixed step."""
        self._scratch[:] = self.velocity
        _advect(self._scratch[0], self._scratch[1], self.velocity[0], self.velocity[1])
        self.steps += 1
        self._transform(-1.0)
        self._correct(EDDY_KICK)

    def _correct(self, forcing: float) -> None:
        """Turn the spectrum in ``velocity`` into the velocity of the next step."""
        forcing_seed = hash32(self._seed, 7919 + self.steps)
        cosine, sine = self._roots.cosine, self._roots.sine
        _project(self.velocity[0], self.velocity[1], cosine, sine, forcing, forcing_seed)
        self._transform(1.0)

    def _transform(self, sign: float) -> None:
        re, im, cosine, sine = *self.velocity, self._roots.cosine, self._roots.sine
        if sign < 0.0:
            transform_rows(re, im, EDDY_GRID, EDDY_GRID, cosine, sine, sign)
            transform_columns(re, im, EDDY_GRID, EDDY_GRID, cosine, sine, sign)
        else:
            transform_columns(re, im, EDDY_GRID, EDDY_GRID, cosine, sine, sign)
            transform_rows(re, im, EDDY_GRID, EDDY_GRID, cosine, sine, sign)


@numba.njit(cache=True, nogil=True)
def _advect(u, v, out_u, out_v):  # pragma: no cover  (compiled)
    """Semi-Lagrangian advection with bilinear interpolation, which never amplifies the field."""
    mask = EDDY_GRID - 1
    for y in range(EDDY_GRID):
        for x in range(EDDY_GRID):
            i = y * EDDY_GRID + x
            px, py = x - EDDY_CELLS_PER_STEP * u[i], y - EDDY_CELLS_PER_STEP * v[i]
            fx, fy = math.floor(px), math.floor(py)
            tx, ty = px - fx, py - fy
            x0, y0 = int(fx) & mask, (int(fy) & mask) * EDDY_GRID
            x1, y1 = (int(fx) + 1) & mask, ((int(fy) + 1) & mask) * EDDY_GRID
            w00, w10, w01, w11 = (1.0 - tx) * (1.0 - ty), tx * (1.0 - ty), (1.0 - tx) * ty, tx * ty
            out_u[i] = w00 * u[y0 + x0] + w10 * u[y0 + x1] + w01 * u[y1 + x0] + w11 * u[y1 + x1]
            out_v[i] = w00 * v[y0 + x0] + w10 * v[y0 + x1] + w01 * v[y1 + x0] + w11 * v[y1 + x1]


@numba.njit(cache=True, nogil=True)
def _start(re, im, seed):  # pragma: no cover  (compiled)
    """Random amplitudes that decay with the wavenumber; _project makes a velocity field of them."""
    half = EDDY_GRID // 2
    for y in range(EDDY_GRID):
        ky = y if y < half else y - EDDY_GRID
        for x in range(EDDY_GRID):
            kx = x if x < half else x - EDDY_GRID
            k2 = kx * kx + ky * ky
            i = y * EDDY_GRID + x
            if k2 >= EDDY_SLOWEST_START * EDDY_SLOWEST_START:
                amplitude = 1.0 / (k2 * math.sqrt(k2))
                re[i] = amplitude * signed_uniform(seed, 2 * i)
                im[i] = amplitude * signed_uniform(seed, 2 * i + 1)


@numba.njit(cache=True, nogil=True)
def _project(re, im, cosine, sine, forcing, seed):  # pragma: no cover  (compiled)
    """Project u + iv (spectra) to zero divergence, apply friction and forcing, scale to unit variance."""
    half = EDDY_GRID // 2
    re[0], im[0] = 0.0, 0.0
    for n in range(EDDY_GRID):  # the Nyquist wavenumbers carry no velocity
        re[half * EDDY_GRID + n], im[half * EDDY_GRID + n] = 0.0, 0.0
        re[n * EDDY_GRID + half], im[n * EDDY_GRID + half] = 0.0, 0.0
    energy, forced = 0.0, 0
    size = float(EDDY_GRID * EDDY_GRID)
    for y in range(half):
        for x in range(EDDY_GRID):
            kx = x if x < half else x - EDDY_GRID
            if x == half or (y == 0 and kx <= 0):
                continue
            i = y * EDDY_GRID + x
            j = ((EDDY_GRID - y) & (EDDY_GRID - 1)) * EDDY_GRID + ((EDDY_GRID - x) & (EDDY_GRID - 1))
            sx, sy = sine[x], sine[y]
            s2 = sx * sx + sy * sy
            k2 = float(kx * kx + y * y)
            ur, ui = 0.5 * (re[i] + re[j]), 0.5 * (im[i] - im[j])
            vr, vi = 0.5 * (im[i] + im[j]), 0.5 * (re[j] - re[i])
            # a divergence-free field is the curl of a stream function, hence parallel to (sy, −sx)
            pr, pi = (sy * ur - sx * vr) / s2, (sy * ui - sx * vi) / s2
            damping = 1.0 / (1.0 + EDDY_FRICTION + EDDY_LARGE_SCALE_FRICTION / k2)
            pr, pi = pr * damping, pi * damping
            if forcing > 0.0 and EDDY_BAND[0] * EDDY_BAND[0] <= k2 < EDDY_BAND[1] * EDDY_BAND[1]:
                impulse = forcing * size / (8.0 * math.sqrt(s2))
                pr += impulse * signed_uniform(seed, 2 * forced)
                pi += impulse * signed_uniform(seed, 2 * forced + 1)
                forced += 1
            ur, ui, vr, vi = sy * pr, sy * pi, -sx * pr, -sx * pi
            re[i], im[i], re[j], im[j] = ur - vi, ui + vr, ur + vi, vr - ui
            smooth = (2.0 + cosine[x]) * (2.0 + cosine[y]) / 9.0  # attenuation by cubic-spline sampling
            energy += smooth * smooth * (ur * ur + ui * ui + vr * vr + vi * vi)
    scale = 1.0 / math.sqrt(energy)  # Parseval: the mean of u² + v² becomes 2
    for i in range(EDDY_GRID * EDDY_GRID):
        re[i] *= scale
        im[i] *= scale
