"""1/f^β gusts: a frozen turbulence field with a given spectrum, advected over the forest.

Along the wind, the power at frequency f is (1 + 70.8 n²)^(−β/2) with n = f L / c: von Kármán's spectrum
(1948; ESDU 85020) with its exponent −5/3 as a parameter. Across the wind, the coherence of each frequency
decays exponentially with distance (Davenport 1961). web/player/src/core/wind/models/spectral.ts implements
the same arithmetic.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
from functools import lru_cache

import numba
import numpy as np

from galewood.wind.document import Wind
from galewood.wind.models.fourier import Floats, roots_of_unity, transform_columns, transform_rows
from galewood.wind.models.frame import view_of
from galewood.wind.models.hashing import hash32
from galewood.wind.models.texture import sample_texture

COLUMNS, ROWS = 1024, 128
CELLS_ALONG, CELLS_ACROSS = 16, 4
"""Grid cells per length scale: the field spans 64 by 32 length scales."""
LATERAL_SHARE = 0.5
SLANT = 0.0955
"""About 0.382 field widths per field length, which spreads successive passes over a tree evenly."""
VON_KARMAN = 70.8
DECAY = 7.0
"""Davenport's decay constant across the wind."""
SLOWEST_COHERENCE = 0.15
"""The width of the slowest gusts is limited to that of this reduced frequency n."""
TURN = 2.0 * math.pi / 4294967296.0


class SpectralGusts:
    """The gusts of one seed and exponent."""

    def __init__(self, seed: int, beta: float) -> None:
        """Synthesise the field, or take it from a small cache."""
        self._field = spectral_field(seed, beta)

    def velocity(
        self, wind: Wind, travel: float, x_m: Floats, z_m: Floats, out_x: Floats, out_z: Floats
    ) -> None:
        """Write the velocity (m/s, world x and z) at each position (m)."""
        view = view_of(
            wind, travel, LATERAL_SHARE, cells_along=CELLS_ALONG, cells_across=CELLS_ACROSS, slant=SLANT
        )
        sample_texture(self._field, COLUMNS, ROWS, view, x_m, z_m, out_x, out_z)


@lru_cache(maxsize=4)
def spectral_field(seed: int, beta: float) -> Floats:
    """(2, ROWS · COLUMNS) spline coefficients of the gusts along and across the wind, unit variance."""
    field = np.zeros((2, ROWS * COLUMNS))
    along, across = roots_of_unity(COLUMNS), roots_of_unity(ROWS)
    _amplitudes(field[0], field[1], seed, beta)
    _to_field(field[0], field[1], along.cosine, along.sine, across.cosine, across.sine)
    field.flags.writeable = False
    return field


@numba.njit(cache=True, nogil=True)
def _amplitudes(re, im, seed, beta):  # pragma: no cover  (compiled)
    """Fixed amplitudes and seeded phases for all wavenumbers except those constant along the wind."""
    for x in range(COLUMNS):
        kx = x if x <= COLUMNS // 2 else x - COLUMNS
        n = abs(kx) * (CELLS_ALONG / COLUMNS)
        if n == 0.0:
            continue
        width = DECAY / (2.0 * math.pi) * math.sqrt(n * n + SLOWEST_COHERENCE * SLOWEST_COHERENCE)
        total = 0.0
        for y in range(ROWS):
            m = (y if y <= ROWS // 2 else y - ROWS) * (CELLS_ACROSS / ROWS)
            total += 1.0 / (width * width + m * m)
        power = (1.0 + VON_KARMAN * n * n) ** (-0.5 * beta)
        for y in range(ROWS):
            m = (y if y <= ROWS // 2 else y - ROWS) * (CELLS_ACROSS / ROWS)
            amplitude = math.sqrt(power / (total * (width * width + m * m)))
            phase = hash32(seed, y * COLUMNS + x) * TURN
            re[y * COLUMNS + x] = amplitude * math.cos(phase)
            im[y * COLUMNS + x] = amplitude * math.sin(phase)


@numba.njit(cache=True, nogil=True)
def _to_field(re, im, cos_x, sin_x, cos_y, sin_y):  # pragma: no cover  (compiled)
    """Transform to physical space with unit variance, compensating for the attenuation by spline sampling."""
    energy, cross = (
        0.0,
        0.0,
    )  # Σ|Z|² and Re Σ Z(k) Z(−k): twice the mean of a² is their sum, of b² their difference
    for y in range(ROWS):
        for x in range(COLUMNS):
            i = y * COLUMNS + x
            j = ((ROWS - y) & (ROWS - 1)) * COLUMNS + ((COLUMNS - x) & (COLUMNS - 1))
            energy += re[i] * re[i] + im[i] * im[i]
            cross += re[i] * re[j] - im[i] * im[j]
    for y in range(ROWS):
        for x in range(COLUMNS):
            i = y * COLUMNS + x
            lift = 9.0 / ((2.0 + cos_x[x]) * (2.0 + cos_y[y]))
            re[i] *= lift
            im[i] *= lift
    transform_rows(re, im, COLUMNS, ROWS, cos_x, sin_x, 1.0)
    transform_columns(re, im, COLUMNS, ROWS, cos_y, sin_y, 1.0)
    scale_a, scale_b = 1.0 / math.sqrt(0.5 * (energy + cross)), 1.0 / math.sqrt(0.5 * (energy - cross))
    for i in range(ROWS * COLUMNS):
        re[i] *= scale_a
        im[i] *= scale_b
