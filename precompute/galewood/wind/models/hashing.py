"""Seeded integer hashes, identical to web/player/src/core/wind/hashing.ts."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math

import numba

GOLDEN = 0x9E3779B9
MASK = 0xFFFFFFFF


@numba.njit(cache=True, nogil=True)
def hash32(seed, k):  # pragma: no cover  (compiled)
    """Mueller's integer finaliser applied to (seed, k): 0 … 2³²−1."""
    h = (seed + GOLDEN * (k + 1)) & MASK
    for _ in range(2):
        h = ((h ^ (h >> 16)) * 0x45D9F3B) & MASK
    return h ^ (h >> 16)


@numba.njit(cache=True, nogil=True)
def signed_uniform(seed, k):  # pragma: no cover  (compiled)
    """Uniform in [−1, 1), exact in float64."""
    return hash32(seed, k) / 2147483648.0 - 1.0


def phase_rad(seed: int, k: int) -> float:
    """Uniform phase in [0, 2π)."""
    return hash32(seed, k) * (2.0 * math.pi / 4294967296.0)


def phase_turns(seed: int, k: int) -> float:
    """Uniform phase in [0, 1) turns."""
    return hash32(seed, k) / 4294967296.0
