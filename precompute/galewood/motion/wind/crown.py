"""Turbulence within a crown: gusts of a few metres, which the gust models of a forest are too coarse for.

A frozen, periodic velocity field is carried over the forest by the wind (Taylor's hypothesis). It is a sum of
plane waves of 3 to 12 m, each across its own direction, so that the field is free of divergence. Their power
per octave falls with the 2/3 power of the wavelength, as in the inertial range (Kolmogorov 1941). Gusts reach
the top of a crown first. Specified in spec/formats/wind.md.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING

import numba
import numpy as np

from galewood.constants import (
    CROWN_CELL_M,
    CROWN_CELLS,
    CROWN_FEWEST_PERIODS,
    CROWN_INTENSITY,
    CROWN_LEAN_ACROSS,
    CROWN_LEAN_ALONG,
    CROWN_MOST_GUST,
    CROWN_MOST_PERIODS,
    CROWN_SLANT,
    CROWN_WAVES,
    HASH_TURN_RAD,
    STREAMLINING_PRESSURE_PA,
)
from galewood.motion.wind.models.hashing import hash32
from galewood.util import Floats

if TYPE_CHECKING:
    from galewood.motion.wind.transition import Moment

KEPT_FIELDS = 64
"""Of 65 kB each: one for every forest of a server with its own wind."""


@lru_cache(maxsize=KEPT_FIELDS)
def crown_field(seed: int) -> Floats:
    """(cells, cells, 2) velocity along and across the wind at the grid points, unit variance each."""
    field = np.zeros((CROWN_CELLS, CROWN_CELLS, 2))
    phase = np.arange(CROWN_CELLS) * (2.0 * math.pi / CROWN_CELLS)
    for k in range(CROWN_WAVES):
        octave = (k + 0.5) / CROWN_WAVES
        number = CROWN_FEWEST_PERIODS * (CROWN_MOST_PERIODS / CROWN_FEWEST_PERIODS) ** octave
        heading = hash32(seed, 3 * k) * HASH_TURN_RAD
        m, n = math.floor(number * math.cos(heading) + 0.5), math.floor(number * math.sin(heading) + 0.5)
        size = math.hypot(m, n)
        start = hash32(seed, 3 * k + 1) * HASH_TURN_RAD
        wave = size ** (-1.0 / 3.0) * np.cos(n * phase[:, None] + m * phase[None, :] + start)
        field[..., 0] += wave * (-n / size)
        field[..., 1] += wave * (m / size)
    field /= np.sqrt(np.mean(np.square(field), axis=(0, 1)))
    field.flags.writeable = False
    return field


def crown_carried(moment: Moment) -> tuple[float, float, float, float]:
    """What the turbulence depends on at one time: cosine and sine of the direction, distance, m, intensity.

    The cosine model describes the wind completely: its intensity is 0. The field's seed is that of
    ``moment.crown``.
    """
    wind = moment.wind
    heading = math.radians(wind.direction_deg)
    share = CROWN_INTENSITY * wind.gustiness * moment.crown.weight
    return math.cos(heading), math.sin(heading), moment.travel * moment.crown.length_scale_m, share


def gust_pressures(gusts: Floats, x_pa: Floats, z_pa: Floats) -> Floats:
    """(T, 2, n) pressures along x and z, Pa, of relative gusts (T, 2n) in winds (T,), Pa."""
    along, across, x, z = gusts[:, ::2], gusts[:, 1::2], x_pa[:, None], z_pa[:, None]
    return np.stack([along * x - across * z, along * z + across * x], axis=1)


@numba.njit(cache=True, nogil=True)
def write_gusts(
    field, carried, places, stand, turn, size, pressure, exponent, out
):  # pragma: no cover  (compiled)
    """Write the relative pressures of the gusts at places of trees to out (count, 2G).

    ``field`` is from ``crown_field``, ``carried`` from ``crown_carried``; places (G, 3) are points of a tree,
    m; ``stand`` is where the trees stand, x and z (count,) m; turn (count, 2) cosine and sine of the yaw,
    size (count,) the scale; ``pressure`` is that at the trees along x and z, (count,) Pa; ``exponent`` is
    their streamlined exponent. ``out`` has two numbers for each place: what the pressure there is in addition
    to that at the tree, along it and across it, over its strength.
    """
    for i in range(len(out)):
        _write_tree_gusts(field, carried, places, (*stand, turn, size), pressure, exponent, i, out)


@numba.njit(cache=True, nogil=True)
def write_gusts_of_each(
    field, carried, tables, stand, turn, size, pressure, out
):  # pragma: no cover  (compiled)
    """Write the relative pressures of the gusts at places of trees of T tables: ``write_gusts``.

    ``tables`` are the places (T, G, 3), the streamlined exponents (T,), and the table of each tree (count,).
    """
    places, exponent, table = tables
    for i in range(len(out)):
        k = table[i]
        _write_tree_gusts(field, carried, places[k], (*stand, turn, size), pressure, exponent[k], i, out)


@numba.njit(cache=True, nogil=True)
def _write_tree_gusts(
    field, carried, places, trees, pressure, exponent, i, out
):  # pragma: no cover  (compiled)
    """Write the gusts at the places of tree i to its row of out."""
    c, s, distance, intensity = carried
    x_m, z_m, turn, size = trees
    pressure_x, pressure_z = pressure
    square = pressure_x[i] * pressure_x[i] + pressure_z[i] * pressure_z[i]
    growth = exponent if square > STREAMLINING_PRESSURE_PA * STREAMLINING_PRESSURE_PA else 2.0
    if intensity == 0.0 or square == 0.0:
        out[i, :] = 0.0
        return
    for g in range(len(places)):
        # three.js rotation.y, as in the shader
        x = x_m[i] + size[i] * (turn[i, 0] * places[g, 0] + turn[i, 1] * places[g, 2])
        z = z_m[i] + size[i] * (turn[i, 0] * places[g, 2] - turn[i, 1] * places[g, 0])
        y = size[i] * places[g, 1]
        along = (c * x + s * z - distance + CROWN_LEAN_ALONG * y) / CROWN_CELL_M
        across = (c * z - s * x + CROWN_LEAN_ACROSS * y) / CROWN_CELL_M + CROWN_SLANT * along
        column, row = math.floor(along), math.floor(across)
        t, w = along - column, across - row
        left, right = int(column) & (CROWN_CELLS - 1), int(column + 1) & (CROWN_CELLS - 1)
        near, far = int(row) & (CROWN_CELLS - 1), int(row + 1) & (CROWN_CELLS - 1)
        for side in range(2):
            first = field[near, left, side] + t * (field[near, right, side] - field[near, left, side])
            last = field[far, left, side] + t * (field[far, right, side] - field[far, left, side])
            gust = min(max(intensity * (first + w * (last - first)), -CROWN_MOST_GUST), CROWN_MOST_GUST)
            out[i, 2 * g + side] = gust * (growth if side == 0 else 1.0)
