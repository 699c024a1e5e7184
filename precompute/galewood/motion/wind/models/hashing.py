"""Seeded integer hashes, identical in every language."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import numba

from galewood.constants import HASH_FACTOR, HASH_GOLDEN, HASH_TURN_RAD

UINT32_MASK = 0xFFFFFFFF


@numba.njit(cache=True, nogil=True)
def hash32(seed, k):  # pragma: no cover  (compiled)
    """Mueller's integer finaliser applied to (seed, k): 0 … 2³²−1."""
    h = (seed + HASH_GOLDEN * (k + 1)) & UINT32_MASK
    for _ in range(2):
        h = ((h ^ (h >> 16)) * HASH_FACTOR) & UINT32_MASK
    return h ^ (h >> 16)


@numba.njit(cache=True, nogil=True)
def signed_uniform(seed, k):  # pragma: no cover  (compiled)
    """Uniform in [−1, 1), exact in float64."""
    return hash32(seed, k) / 2147483648.0 - 1.0


def phase_rad(seed: int, k: int) -> float:
    """Uniform phase in [0, 2π)."""
    return hash32(seed, k) * HASH_TURN_RAD


def phase_turns(seed: int, k: int) -> float:
    """Uniform phase in [0, 1) turns."""
    return hash32(seed, k) / 4294967296.0
