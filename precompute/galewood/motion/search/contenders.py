"""Mismatches with those records only that the successor does not beat already on part of the components.

Most components match rarely, or differ often. The former are counted by listing their matches; of the latter
those that differ most often are counted first, as a lower bound of the mismatches. The remaining components
matter only for the records that this bound does not rule out (docs/design/0001-exact-search.md).
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
import numpy.typing as npt

from galewood.motion.search.similarity import Compared, Ranks

RARE_MATCH_SHARE = 0.05
"""Matches of a component are listed if their share of all pairs of records is smaller."""
MAX_BOUND_COMPONENTS = 256
"""Most components of the lower bound, beside those whose matches are listed."""
TILE_RECORDS = 1024
"""Records of a pass: their ranges stay in the fastest cache while all states are compared with them."""


@dataclass(frozen=True)
class Matches:
    """Matches of m components: records order[k, begin[c, k]:end[c, k]] match state c in component k."""

    order: Ranks  # (m, z) records by value
    begin: Ranks  # (z, m)
    end: Ranks  # (z, m)
    weight: Ranks  # (m,) how often the component counts


@dataclass(frozen=True)
class Stages:
    """The components of all records, in the order of counting."""

    matches: Matches
    head: Compared  # components that count twice: (h, z) instead of (z, h), h even
    tail: Compared
    tail_twice: int  # the first components of the tail that count twice; the others count once


def stages(layout: Compared) -> Stages:
    """Arrange the components so that the number of mismatches soon exceeds any bound."""
    z, width = layout.rank.shape
    share = (layout.span.mean(axis=0, dtype=np.float64) + 1.0) / z
    weight = np.where(np.arange(width) < width // 4 * 3, 1, 2).astype(np.uint16)
    order = np.argsort(share, kind="stable")
    often, twice = share[order] >= RARE_MATCH_SHARE, weight[order] == 2
    rare, first, last = order[~often], order[often & twice], order[often & ~twice]
    head = min(MAX_BOUND_COMPONENTS, len(first)) // 2 * 2
    tail = np.concatenate([first[head:], last])
    columns = [np.ascontiguousarray(part.T) for part in (layout.rank, layout.low, layout.span)]
    return Stages(
        _matches(Compared(*(part[rare] for part in columns)), weight[rare]),
        Compared(*(part[first[:head]] for part in columns)),
        Compared(*(np.ascontiguousarray(part[tail].T) for part in columns)),
        len(first) - head,
    )


def _matches(columns: Compared, weight: Ranks) -> Matches:
    """Lists of the matches in m components, whose columns are (m, z)."""
    m, z = columns.rank.shape
    order, begin, end = np.empty((m, z), np.uint16), np.empty((m, z), np.uint16), np.empty((m, z), np.uint16)
    for i in range(m):
        order[i] = np.argsort(columns.rank[i], kind="stable")
        _match_bounds(order[i], columns.rank[i], columns.low[i], columns.span[i], begin[i], end[i])
    return Matches(order, np.ascontiguousarray(begin.T), np.ascontiguousarray(end.T), weight)


@numba.njit(cache=True, nogil=True)
def _match_bounds(order, rank, low, span, begin, end):  # pragma: no cover  (compiled)
    """Bounds of the records that match each state (z,); low and low + span ascend along ``order``."""
    first, last = 0, 0
    for c in order:
        while low[order[first]] + span[order[first]] < rank[c]:
            first += 1
        while last < len(order) and low[order[last]] <= rank[c]:
            last += 1
        begin[c], end[c] = first, last


@numba.njit(cache=True, nogil=True)
def _count_listed(order, begin, end, weight, first, out):  # pragma: no cover  (compiled)
    """Set out[i, j] to the mismatches of state first + i with record j in the components with lists."""
    total = 0
    for k in range(len(weight)):
        total += weight[k]
    for i in range(len(out)):
        row = out[i]
        row[:] = total
        for k in range(len(weight)):
            for s in range(begin[first + i, k], end[first + i, k]):
                row[order[k, s]] -= weight[k]


@numba.njit(cache=True, nogil=True)
def _add_twice(x0, x1, low0, low1, span0, span1, row):  # pragma: no cover  (compiled)
    """Add to row (n,) twice the mismatches of a state with n records in two components."""
    for j in range(len(row)):  # 16 bits throughout, for vectors of as many records as possible
        n = np.uint16(np.uint16(x0 - low0[j]) > span0[j])
        n = np.uint16(n + np.uint16(np.uint16(x1 - low1[j]) > span1[j]))
        row[j] = np.uint16(row[j] + np.uint16(n + n))


@numba.njit(cache=True, nogil=True)
def _add_head(rank, low, span, first, out):  # pragma: no cover  (compiled)
    """Add to out[i, j] the mismatches of state first + i with record j in the head."""
    for start in range(0, rank.shape[1], TILE_RECORDS):
        end = min(start + TILE_RECORDS, rank.shape[1])
        for k in range(0, len(rank), 2):
            low0, low1 = low[k, start:end], low[k + 1, start:end]
            span0, span1 = span[k, start:end], span[k + 1, start:end]
            for i in range(len(out)):
                x0, x1 = rank[k, first + i], rank[k + 1, first + i]
                _add_twice(x0, x1, low0, low1, span0, span1, out[i, start:end])


def lower_bounds(parts: Stages, first: int, last: int) -> npt.NDArray[np.uint16]:
    """(last − first, z) mismatches of states [first, last) with every record, without those in the tail."""
    out = np.empty((last - first, len(parts.tail.rank)), np.uint16)
    listed, head = parts.matches, parts.head
    _count_listed(listed.order, listed.begin, listed.end, listed.weight, first, out)
    _add_head(head.rank, head.low, head.span, first, out)
    return out


@numba.njit(cache=True, nogil=True)
def _outside(x, low, span):  # pragma: no cover  (compiled)
    """Number of components out of range."""
    n = np.uint16(0)
    for k in range(len(low)):
        n = np.uint16(n + np.uint16(np.uint16(x[k] - low[k]) > span[k]))
    return n


@numba.njit(cache=True, nogil=True)
def _add_tail(rank, low, span, twice, first, chosen, out):  # pragma: no cover  (compiled)
    for j in range(len(rank)):
        for i in range(len(out)):
            if chosen[i, j]:
                x = rank[first + i]
                double = _outside(x[:twice], low[j, :twice], span[j, :twice])
                single = _outside(x[twice:], low[j, twice:], span[j, twice:])
                out[i, j] += single + 2 * double


def complete(parts: Stages, first: int, chosen: npt.NDArray[np.bool_], bounds: Ranks) -> None:
    """Turn the lower bounds (n, z) of the states first, first + 1, … into mismatches where ``chosen``."""
    tail = parts.tail
    _add_tail(tail.rank, tail.low, tail.span, parts.tail_twice, first, chosen, bounds)
