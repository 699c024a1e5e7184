"""Exact and fast state-to-state error E_int between records (paper, Eq. 12–15).

After the first step the internal state of a tree is always that of a record, so the search needs E_int only
between records (candidates.py selects which). Whether a value lies in a range depends only on the order of
the values, so values and ranges are replaced by 16-bit ranks.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

RELATIVE_RANGE = 1.0 / 20.0
"""Eq. 12: half-width of a component's range over its value."""
RANGE_FLOOR = 1e-3
"""Smallest half-width over the component's RMS: without it, a component at rest would match nothing."""
MOST_RECORDS = 65535
MOST_COMPONENTS = 65535
"""Limits of the 16-bit ranks and counts."""

Ranks = npt.NDArray[np.uint16]


@dataclass(frozen=True)
class InternalStates:
    """Internal state of z records at q sampled vertices."""

    velocity: npt.NDArray[np.float32]  # (z, q, 3) m/s
    force: npt.NDArray[np.float32]  # (z, q, 3) N
    stiffness: npt.NDArray[np.float32]  # (z, q, 6) N/m: xx yy zz xy xz yz of the 3×3 diagonal block

    @property
    def components(self) -> int:
        """Compared components of a record: 3 + 3 + 9 per vertex (all nine of the symmetric block count)."""
        return 15 * self.velocity.shape[1]


@dataclass(frozen=True)
class Compared:
    """Ranks in the layout of the comparison: 9q components that count once, then 3q that count twice.

    Component k of state c is in the range of record j if rank[c, k] − low[j, k] ≤ span[j, k], unsigned.
    """

    rank: Ranks  # (z, 12q)
    low: Ranks  # (z, 12q)
    span: Ranks  # (z, 12q)


def compared(states: InternalStates) -> Compared:
    """Ranks of the components of all records and of their ranges (Eq. 12 with a lower bound).

    Raises ValueError if records or components exceed 16 bits.
    """
    z = len(states.velocity)
    if z > MOST_RECORDS or states.components > MOST_COMPONENTS:
        raise ValueError(
            f"{z} records of {states.components} components exceed the limit of 65535 each: record less"
        )
    parts = (states.velocity, states.force, states.stiffness[..., :3], states.stiffness[..., 3:])
    value = np.concatenate([part.reshape(z, -1) for part in parts], axis=1).astype(np.float32)
    rms = np.sqrt(np.mean(np.square(value, dtype=np.float64), axis=0))
    half = np.maximum(np.abs(value) * np.float32(RELATIVE_RANGE), (RANGE_FLOOR * rms).astype(np.float32))
    value, half = np.ascontiguousarray(value.T), np.ascontiguousarray(half.T)
    columns = np.empty((3, len(value), z), np.uint16)

    def rank(k: int) -> None:
        order = np.argsort(value[k])
        ordered, reach = value[k][order], half[k][order]
        _write_ranks(order, ordered, ordered - reach, ordered + reach, *columns[:, k])

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(rank, range(len(value))))
    return Compared(*(np.ascontiguousarray(column.T) for column in columns))


@numba.njit(cache=True, nogil=True)
def _write_ranks(order, ordered, lowest, highest, rank, low, span):  # pragma: no cover  (compiled)
    """Ranks of the values and of the ends of their ranges, in one pass, as all three ascend together."""
    first, begin, end = 0, 0, 0
    for i in range(len(ordered)):
        if ordered[i] != ordered[first]:
            first = i
        while ordered[begin] < lowest[i]:
            begin += 1
        while end < len(ordered) and ordered[end] <= highest[i]:
            end += 1
        rank[order[i]], low[order[i]], span[order[i]] = first, begin, end - 1 - begin


@numba.njit(cache=True, nogil=True)
def _outside_four(x0, x1, x2, x3, low, span):  # pragma: no cover  (compiled)
    """Number of components out of range for four states, which share one load of the ranges."""
    n0, n1, n2, n3 = np.uint16(0), np.uint16(0), np.uint16(0), np.uint16(0)
    for k in range(len(low)):  # 16 bits throughout: anything wider makes the loop four times slower
        lo, size = low[k], span[k]
        n0 = np.uint16(n0 + np.uint16(np.uint16(x0[k] - lo) > size))
        n1 = np.uint16(n1 + np.uint16(np.uint16(x1[k] - lo) > size))
        n2 = np.uint16(n2 + np.uint16(np.uint16(x2[k] - lo) > size))
        n3 = np.uint16(n3 + np.uint16(np.uint16(x3[k] - lo) > size))
    return n0, n1, n2, n3


@numba.njit(cache=True, nogil=True)
def _count_outside(rank, low, span, first, last, out):  # pragma: no cover  (compiled)
    """out[c − first, j] = number of mismatches of state c with record j (Eq. 13), for c in [first, last)."""
    z, width = rank.shape
    once = width // 4 * 3
    for j in range(z):
        for c in range(first, last, 4):
            c1, c2, c3 = min(c + 1, last - 1), min(c + 2, last - 1), min(c + 3, last - 1)
            single = _outside_four(
                rank[c, :once],
                rank[c1, :once],
                rank[c2, :once],
                rank[c3, :once],
                low[j, :once],
                span[j, :once],
            )
            double = _outside_four(
                rank[c, once:],
                rank[c1, once:],
                rank[c2, once:],
                rank[c3, once:],
                low[j, once:],
                span[j, once:],
            )
            out[c - first, j] = single[0] + 2 * double[0]
            out[c1 - first, j] = single[1] + 2 * double[1]
            out[c2 - first, j] = single[2] + 2 * double[2]
            out[c3 - first, j] = single[3] + 2 * double[3]


def mismatch_rows(states: Compared, first: int, last: int) -> npt.NDArray[np.uint16]:
    """(last − first, z) mismatches (E_int times components) of states [first, last) with every record."""
    out = np.empty((last - first, len(states.rank)), np.uint16)
    _count_outside(states.rank, states.low, states.span, first, last, out)
    return out


def typical_error(layout: Compared, components: int, sample: int = 48) -> float:
    """Median E_int between ``sample`` evenly spaced records and all records."""
    chosen = np.unique(np.linspace(0, len(layout.rank) - 1, sample).astype(np.int64))
    rows = [mismatch_rows(layout, int(c), int(c) + 1) for c in chosen]
    return float(np.median(np.concatenate(rows))) / components
