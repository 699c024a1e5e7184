"""Gusts of improved Perlin noise (Perlin 2002): three octaves that move with the wind and slowly evolve."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba
import numpy as np
import numpy.typing as npt

from galewood.constants import (
    PERLIN_CELLS_PER_SCALE,
    PERLIN_CHANGE,
    PERLIN_EDGES,
    PERLIN_GAIN,
    PERLIN_LATERAL_SHARE,
    PERLIN_NOISE_VARIANCE,
    PERLIN_OCTAVES,
    PERLIN_SLANT,
)
from galewood.motion.wind.document import Wind
from galewood.motion.wind.models.frame import view_of, write_velocity
from galewood.motion.wind.models.hashing import hash32
from galewood.util import Floats

SLOPES: Floats = np.array([PERLIN_EDGES[h & 15] for h in range(256)], np.float64).ravel()


class PerlinGusts:
    """The gusts of one seed."""

    def __init__(self, seed: int) -> None:
        """Create the seeded permutation table."""
        self._permutation = permutation(seed)

    def velocity(
        self, wind: Wind, travel: float, x_m: Floats, z_m: Floats, out_x: Floats, out_z: Floats
    ) -> None:
        """Write the velocity (m/s, world x and z) at each position (m)."""
        view = view_of(
            wind,
            travel,
            PERLIN_LATERAL_SHARE,
            cells_along=PERLIN_CELLS_PER_SCALE,
            cells_across=PERLIN_CELLS_PER_SCALE,
            slant=PERLIN_SLANT,
        )
        _sample(self._permutation, SLOPES, view, x_m, z_m, out_x, out_z)


def permutation(seed: int) -> npt.NDArray[np.int32]:
    """(512,) seeded permutation of 0 … 255, repeated twice."""
    order = np.arange(256, dtype=np.int32)
    for i in range(255, 0, -1):
        j = hash32(seed, i) % (i + 1)
        order[i], order[j] = order[j], order[i]
    return np.concatenate([order, order])


@numba.njit(cache=True, nogil=True)
def _slope(g, h, x, y, z):  # pragma: no cover  (compiled)
    h *= 3
    return g[h] * x + g[h + 1] * y + g[h + 2] * z


@numba.njit(cache=True, nogil=True)
def noise(p, g, x, y, z):  # pragma: no cover  (compiled)
    """Improved Perlin noise with mean 0 and a period of 256 cells along each axis."""
    fx, fy, fz = math.floor(x), math.floor(y), math.floor(z)
    i, j, k = int(fx) & 255, int(fy) & 255, int(fz) & 255
    x, y, z = x - fx, y - fy, z - fz
    u = x * x * x * (x * (x * 6.0 - 15.0) + 10.0)
    v = y * y * y * (y * (y * 6.0 - 15.0) + 10.0)
    w = z * z * z * (z * (z * 6.0 - 15.0) + 10.0)
    a, b = p[i] + j, p[i + 1] + j
    aa, ab, ba, bb = p[a] + k, p[a + 1] + k, p[b] + k, p[b + 1] + k
    x1, y1, z1 = x - 1.0, y - 1.0, z - 1.0
    n000, n100 = _slope(g, p[aa], x, y, z), _slope(g, p[ba], x1, y, z)
    n010, n110 = _slope(g, p[ab], x, y1, z), _slope(g, p[bb], x1, y1, z)
    n001, n101 = _slope(g, p[aa + 1], x, y, z1), _slope(g, p[ba + 1], x1, y, z1)
    n011, n111 = _slope(g, p[ab + 1], x, y1, z1), _slope(g, p[bb + 1], x1, y1, z1)
    n00, n10 = n000 + u * (n100 - n000), n010 + u * (n110 - n010)
    n01, n11 = n001 + u * (n101 - n001), n011 + u * (n111 - n011)
    n0, n1 = n00 + v * (n10 - n00), n01 + v * (n11 - n01)
    return n0 + w * (n1 - n0)


@numba.njit(cache=True, nogil=True)
def _sample(p, g, view, x_m, z_m, out_x, out_z):  # pragma: no cover  (compiled)
    total = 0.0
    for o in range(PERLIN_OCTAVES):
        total += PERLIN_GAIN ** (2 * o)
    along_scale = 1.0 / math.sqrt(PERLIN_NOISE_VARIANCE * total)
    across_scale = 1.0 / math.sqrt(PERLIN_NOISE_VARIANCE)
    change = PERLIN_CHANGE * view.travel
    for i in range(len(x_m)):
        along = view.cos_per_m * x_m[i] + view.sin_per_m * z_m[i] - view.travel
        across = view.cos_per_m * z_m[i] - view.sin_per_m * x_m[i]
        px, py = along * view.cells_along, (across + view.slant * along) * view.cells_across
        a, gain, scale = 0.0, 1.0, 1.0
        for o in range(PERLIN_OCTAVES):  # offsets prevent a common zero at the origin
            a += gain * noise(p, g, px * scale + 17.31 * o, py * scale + 9.67 * o, change + 31.5 * o)
            gain *= PERLIN_GAIN
            scale *= 2.0
        b = noise(p, g, px + 101.4, py + 57.8, change + 0.5)
        write_velocity(view, i, a * along_scale, b * across_scale, out_x, out_z)
