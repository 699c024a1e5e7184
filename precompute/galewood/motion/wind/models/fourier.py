"""Two-dimensional Fourier transform, bit-identical in every language.

The eddies of the Navier–Stokes model are chaotic: a difference in the last bit produces a different wind
within a few hundred steps. The order of all operations is therefore fixed, and the roots of unity are
computed by square roots, which IEEE 754 rounds correctly, rather than by a library's sine.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
from dataclasses import dataclass

import numba
import numpy as np

from galewood.util import Floats


@dataclass(frozen=True)
class Roots:
    """cos and sin of 2πk/n for k in [0, n), where n is a power of two and at least 4."""

    cosine: Floats  # (n,)
    sine: Floats  # (n,)


def roots_of_unity(n: int) -> Roots:
    """Roots of unity by half angles and complex products only; bit-identical on every IEEE 754 platform."""
    cosine, sine = np.ones(n), np.zeros(n)
    c, s = -1.0, 0.0  # the angle π
    bit = n // 2
    while bit >= 1:
        for k in range(0, n, 2 * bit):
            cosine[k + bit] = cosine[k] * c - sine[k] * s
            sine[k + bit] = cosine[k] * s + sine[k] * c
        half = math.sqrt((1.0 + c) / 2.0)
        c, s = half, 1.0 if bit == n // 2 else s / (2.0 * half)
        bit //= 2
    return Roots(cosine, sine)


@numba.njit(cache=True, nogil=True)
def _reversed_index(i, n):  # pragma: no cover  (compiled)
    j, bit = 0, 1
    while bit < n:
        j = (j << 1) | (i & 1)
        i >>= 1
        bit <<= 1
    return j


@numba.njit(cache=True, nogil=True)
def transform_rows(re, im, columns, rows, cosine, sine, sign):  # pragma: no cover  (compiled)
    """Transform every row of the flat (rows, columns) arrays in place; sign −1: forward, +1: inverse,
    unscaled.
    """
    for r in range(rows):
        row = r * columns
        for i in range(columns):
            j = _reversed_index(i, columns)
            if i < j:
                re[row + i], re[row + j] = re[row + j], re[row + i]
                im[row + i], im[row + j] = im[row + j], im[row + i]
        half = 1
        while half < columns:
            stride = columns // (2 * half)
            for k in range(half):
                wr, wi = cosine[k * stride], sign * sine[k * stride]
                for a in range(row + k, row + columns, 2 * half):
                    b = a + half
                    tr = re[b] * wr - im[b] * wi
                    ti = re[b] * wi + im[b] * wr
                    re[b], im[b] = re[a] - tr, im[a] - ti
                    re[a], im[a] = re[a] + tr, im[a] + ti
            half *= 2


@numba.njit(cache=True, nogil=True)
def transform_columns(re, im, columns, rows, cosine, sine, sign):  # pragma: no cover  (compiled)
    """Transform every column in place; the inner loop runs along rows, which are contiguous in memory."""
    for i in range(rows):
        j = _reversed_index(i, rows)
        if i < j:
            for x in range(columns):
                a, b = i * columns + x, j * columns + x
                re[a], re[b] = re[b], re[a]
                im[a], im[b] = im[b], im[a]
    half = 1
    while half < rows:
        stride = rows // (2 * half)
        for k in range(half):
            wr, wi = cosine[k * stride], sign * sine[k * stride]
            for first in range(k, rows, 2 * half):
                a = first * columns
                b = a + half * columns
                for _ in range(columns):
                    tr = re[b] * wr - im[b] * wi
                    ti = re[b] * wi + im[b] * wr
                    re[b], im[b] = re[a] - tr, im[a] - ti
                    re[a], im[a] = re[a] + tr, im[a] + ti
                    a += 1
                    b += 1
        half *= 2
