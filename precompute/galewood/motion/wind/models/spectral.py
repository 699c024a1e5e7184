"""1/f^β gusts: a frozen turbulence field with a given spectrum, advected over the forest.

Along the wind, the power at frequency f is (1 + 70.8 n²)^(−β/2) with n = f L / c: von Kármán's spectrum
(1948; ESDU 85020) with its exponent −5/3 as a parameter. Across the wind, the coherence of each frequency
decays exponentially with distance (Davenport 1961).
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
from functools import lru_cache

import numba
import numpy as np

from galewood.constants import (
    HASH_TURN_RAD,
    SPECTRAL_CELLS_ACROSS,
    SPECTRAL_CELLS_ALONG,
    SPECTRAL_COLUMNS,
    SPECTRAL_DECAY,
    SPECTRAL_LATERAL_SHARE,
    SPECTRAL_ROWS,
    SPECTRAL_SLANT,
    SPECTRAL_SLOWEST_COHERENCE,
    SPECTRAL_VON_KARMAN,
)
from galewood.motion.wind.document import Wind
from galewood.motion.wind.models.fourier import Floats, roots_of_unity, transform_columns, transform_rows
from galewood.motion.wind.models.frame import view_of
from galewood.motion.wind.models.hashing import hash32
from galewood.motion.wind.models.texture import sample_texture


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
            wind,
            travel,
            SPECTRAL_LATERAL_SHARE,
            cells_along=SPECTRAL_CELLS_ALONG,
            cells_across=SPECTRAL_CELLS_ACROSS,
            slant=SPECTRAL_SLANT,
        )
        sample_texture(self._field, SPECTRAL_COLUMNS, SPECTRAL_ROWS, view, x_m, z_m, out_x, out_z)


@lru_cache(maxsize=4)
def spectral_field(seed: int, beta: float) -> Floats:
    """(2, rows · columns) spline coefficients of the gusts along and across the wind, unit variance."""
    field = np.zeros((2, SPECTRAL_ROWS * SPECTRAL_COLUMNS))
    along, across = roots_of_unity(SPECTRAL_COLUMNS), roots_of_unity(SPECTRAL_ROWS)
    _amplitudes(field[0], field[1], seed, beta)
    _to_field(field[0], field[1], along.cosine, along.sine, across.cosine, across.sine)
    field.flags.writeable = False
    return field


@numba.njit(cache=True, nogil=True)
def _amplitudes(re, im, seed, beta):  # pragma: no cover  (compiled)
    """Fixed amplitudes and seeded phases for all wavenumbers except those constant along the wind."""
    rows, columns = SPECTRAL_ROWS, SPECTRAL_COLUMNS
    per_row, per_column = SPECTRAL_CELLS_ACROSS / rows, SPECTRAL_CELLS_ALONG / columns
    slowest = SPECTRAL_SLOWEST_COHERENCE * SPECTRAL_SLOWEST_COHERENCE
    for x in range(columns):
        kx = x if x <= columns // 2 else x - columns
        n = abs(kx) * per_column
        if n == 0.0:
            continue
        width = SPECTRAL_DECAY / (2.0 * math.pi) * math.sqrt(n * n + slowest)
        total = 0.0
        for y in range(rows):
            m = (y if y <= rows // 2 else y - rows) * per_row
            total += 1.0 / (width * width + m * m)
        power = (1.0 + SPECTRAL_VON_KARMAN * n * n) ** (-0.5 * beta)
        for y in range(rows):
            m = (y if y <= rows // 2 else y - rows) * per_row
            amplitude = math.sqrt(power / (total * (width * width + m * m)))
            phase = hash32(seed, y * columns + x) * HASH_TURN_RAD
            re[y * columns + x] = amplitude * math.cos(phase)
            im[y * columns + x] = amplitude * math.sin(phase)


@numba.njit(cache=True, nogil=True)
def _to_field(re, im, cos_x, sin_x, cos_y, sin_y):  # pragma: no cover  (compiled)
    """Transform to physical space with unit variance, compensating for the attenuation by spline sampling."""
    rows, columns = SPECTRAL_ROWS, SPECTRAL_COLUMNS
    energy, cross = (
        0.0,
        0.0,
    )  # Σ|Z|² and Re Σ Z(k) Z(−k): twice the mean of a² is their sum, of b² their difference
    for y in range(rows):
        for x in range(columns):
            i = y * columns + x
            j = ((rows - y) & (rows - 1)) * columns + ((columns - x) & (columns - 1))
            energy += re[i] * re[i] + im[i] * im[i]
            cross += re[i] * re[j] - im[i] * im[j]
    for y in range(rows):
        for x in range(columns):
            i = y * columns + x
            lift = 9.0 / ((2.0 + cos_x[x]) * (2.0 + cos_y[y]))
            re[i] *= lift
            im[i] *= lift
    transform_rows(re, im, columns, rows, cos_x, sin_x, 1.0)
    transform_columns(re, im, columns, rows, cos_y, sin_y, 1.0)
    scale_a, scale_b = 1.0 / math.sqrt(0.5 * (energy + cross)), 1.0 / math.sqrt(0.5 * (energy - cross))
    for i in range(rows * columns):
        re[i] *= scale_a
        im[i] *= scale_b
