"""The state-to-state error E_int between records (paper, Eq. 12–15), exactly and fast.

After the first step a tree's internal state is always that of a record, so E_int between records is all that
a search needs (candidates.py says which of them). Whether a value lies in a record's range depends on the
order of values alone, so both are replaced by ranks: sixteen bits a component, compared in one go.
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
"""Eq. 12: a component matches within a twentieth of its own value …"""
RANGE_FLOOR = 1e-3
"""… but never tighter than this share of the component's RMS, or one that rests would match nothing."""
MOST_RECORDS = 65535
MOST_COMPONENTS = 65535
"""Ranks and counts have sixteen bits."""

Ranks = npt.NDArray[np.uint16]


@dataclass(frozen=True)
class InternalStates:
    """Internal state of every record at q sampled points."""

    velocity: npt.NDArray[np.float32]  # (z, q, 3) m/s
    force: npt.NDArray[np.float32]  # (z, q, 3) N
    stiffness: npt.NDArray[np.float32]  # (z, q, 6) N/m: xx yy zz xy xz yz of the point's 3×3 diagonal block

    @property
    def components(self) -> int:
        """Compared components of a record: 3 + 3 + 9 a point (the block is symmetric, all nine count)."""
        return 15 * self.velocity.shape[1]


@dataclass(frozen=True)
class Compared:
    """Ranks laid out for comparison: 9q components that count once, then 3q that count twice.

    Component k of state c lies in the range of record j where rank[c, k] − low[j, k] ≤ span[j, k], unsigned.
    """

    rank: Ranks  # (z, 12q)
    low: Ranks  # (z, 12q)
    span: Ranks  # (z, 12q)


def compared(states: InternalStates) -> Compared:
    """Ranks of every record's components and of their ranges (Eq. 12 with the floor).

    Raises ValueError for more records or components than sixteen bits can count.
    """
    z = len(states.velocity)
    if z > MOST_RECORDS or states.components > MOST_COMPONENTS:
        raise ValueError(f"{z} records of {states.components} components are more than a table can hold")
    parts = (states.velocity, states.force, states.stiffness[..., :3], states.stiffness[..., 3:])
    value = np.concatenate([part.reshape(z, -1) for part in parts], axis=1).astype(np.float32)
    rms = np.sqrt(np.mean(np.square(value, dtype=np.float64), axis=0))
    half = np.maximum(np.abs(value) * np.float32(RELATIVE_RANGE), (RANGE_FLOOR * rms).astype(np.float32))
    columns = np.empty((3, value.shape[1], z), np.uint16)

    def rank(k: int) -> None:
        order = np.argsort(value[:, k])
        ordered, reach = value[order, k], half[order, k]
        _write_ranks(order, ordered, ordered - reach, ordered + reach, *columns[:, k])

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        list(pool.map(rank, range(value.shape[1])))
    return Compared(*(np.ascontiguousarray(column.T) for column in columns))


@numba.njit(cache=True, nogil=True)
def _write_ranks(order, ordered, lowest, highest, rank, low, span):  # pragma: no cover  (compiled)
    """Rank of every value and of its range's ends, which ascend with the values, by walking along them."""
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
    """Components outside their range of four states that share one load of the ranges."""
    n0, n1, n2, n3 = np.uint16(0), np.uint16(0), np.uint16(0), np.uint16(0)
    for k in range(len(low)):  # in sixteen bits throughout, or the loop takes four times as long
        lo, size = low[k], span[k]
        n0 = np.uint16(n0 + np.uint16(np.uint16(x0[k] - lo) > size))
        n1 = np.uint16(n1 + np.uint16(np.uint16(x1[k] - lo) > size))
        n2 = np.uint16(n2 + np.uint16(np.uint16(x2[k] - lo) > size))
        n3 = np.uint16(n3 + np.uint16(np.uint16(x3[k] - lo) > size))
    return n0, n1, n2, n3


@numba.njit(cache=True, nogil=True)
def _count_outside(rank, low, span, first, last, out):  # pragma: no cover  (compiled)
    """out[c − first, j] = mismatches of record j against state c (Eq. 13), for c in [first, last)."""
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
    """(last − first, z) E_int · components between states first..last and every record."""
    out = np.empty((last - first, len(states.rank)), np.uint16)
    _count_outside(states.rank, states.low, states.span, first, last, out)
    return out


def typical_error(layout: Compared, components: int, sample: int = 48) -> float:
    """Median E_int between a sample of the records and all."""
    chosen = np.unique(np.linspace(0, len(layout.rank) - 1, sample).astype(np.int64))
    rows = [mismatch_rows(layout, int(c), int(c) + 1) for c in chosen]
    return float(np.median(np.concatenate(rows))) / components
