"""The state-to-state error E_int (paper, Eq. 12–15) and the candidates that suffice for an exact search.

After the first step a tree's internal state is always that of a record, so E_int between records is all a
search needs, and most pairs can never win: docs/design/0001-exact-search.md proves it, ``prune`` is the rule.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
import numpy.typing as npt

RELATIVE_RANGE = 1.0 / 20.0
"""Eq. 12: a component matches within a twentieth of its own value …"""
RANGE_FLOOR = 1e-3
"""… but never tighter than this share of the component's RMS, or one that rests would match nothing."""
MARGIN = 1e-9
"""A candidate is dropped only if it loses by more than rounding could ever give back."""
CHUNK = 48
GAIN_STEPS_PER_SIGMA = 256
GAIN_SPAN_SIGMA = 12

Array = npt.NDArray[Any]


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
class Search:
    """Per record c its candidates j, sorted by (mismatches, j), as CSR."""

    offsets: npt.NDArray[np.uint32]  # (z + 1,)
    record: npt.NDArray[np.uint16]  # (nnz,)
    mismatches: npt.NDArray[np.uint16]  # (nnz,)


@dataclass(frozen=True)
class Compared:
    """States laid out for comparison: 9q components that count once, then 3q that count twice."""

    value: npt.NDArray[np.float32]  # (z, 12q)
    low: npt.NDArray[np.float32]  # (z, 12q)
    high: npt.NDArray[np.float32]  # (z, 12q)


def compared(states: InternalStates) -> Compared:
    """Values and ranges (Eq. 12 with the floor) of every record's components."""
    z = len(states.velocity)
    parts = (states.velocity, states.force, states.stiffness[..., :3], states.stiffness[..., 3:])
    value = np.concatenate([part.reshape(z, -1) for part in parts], axis=1).astype(np.float32)
    rms = np.sqrt(np.mean(np.square(value, dtype=np.float64), axis=0))
    half = np.maximum(np.abs(value) * np.float32(RELATIVE_RANGE), (RANGE_FLOOR * rms).astype(np.float32))
    return Compared(value, value - half, value + half)


@numba.njit(cache=True, nogil=True)
def _outside_four(x0, x1, x2, x3, low, high):  # pragma: no cover  (compiled)
    """Components outside [low, high] of four states that share one load of the ranges."""
    n0, n1, n2, n3 = np.int32(0), np.int32(0), np.int32(0), np.int32(0)
    for k in range(len(low)):  # from a plain 0, or the loop is not vectorised
        lo, hi = low[k], high[k]
        n0 += np.int32((x0[k] < lo) | (x0[k] > hi))
        n1 += np.int32((x1[k] < lo) | (x1[k] > hi))
        n2 += np.int32((x2[k] < lo) | (x2[k] > hi))
        n3 += np.int32((x3[k] < lo) | (x3[k] > hi))
    return n0, n1, n2, n3


@numba.njit(cache=True, nogil=True)
def _count_outside(value, low, high, first, last, out):  # pragma: no cover  (compiled)
    """out[c − first, j] = mismatches of record j against state c (Eq. 13), for c in [first, last)."""
    z, width = value.shape
    once = width // 4 * 3
    for j in range(z):
        for c in range(first, last, 4):
            c1, c2, c3 = min(c + 1, last - 1), min(c + 2, last - 1), min(c + 3, last - 1)
            single = _outside_four(
                value[c, :once],
                value[c1, :once],
                value[c2, :once],
                value[c3, :once],
                low[j, :once],
                high[j, :once],
            )
            double = _outside_four(
                value[c, once:],
                value[c1, once:],
                value[c2, once:],
                value[c3, once:],
                low[j, once:],
                high[j, once:],
            )
            out[c - first, j] = single[0] + 2 * double[0]
            out[c1 - first, j] = single[1] + 2 * double[1]
            out[c2 - first, j] = single[2] + 2 * double[2]
            out[c3 - first, j] = single[3] + 2 * double[3]


def mismatch_rows(states: Compared, first: int, last: int) -> npt.NDArray[np.uint16]:
    """(last − first, z) E_int · components between states first..last and every record."""
    out = np.empty((last - first, len(states.value)), np.uint16)
    _count_outside(states.value, states.low, states.high, first, last, out)
    return out


def typical_error(states: InternalStates, sample: int = 48) -> float:
    """Median E_int between a sample of the records and all."""
    layout, z = compared(states), len(states.velocity)
    chosen = np.unique(np.linspace(0, z - 1, sample).astype(np.int64))
    rows = [mismatch_rows(layout, int(c), int(c) + 1) for c in chosen]
    return float(np.median(np.concatenate(rows))) / states.components


def gain_bound() -> npt.NDArray[np.float64]:
    """Upper bound of G(d) = max_b [exp(−b²/2) − exp(−(b+d)²/2)] at d = i / GAIN_STEPS_PER_SIGMA (d in σ).

    G is how much better than its rival at distance d a pressure can ever make a record look.
    """
    d = np.arange(GAIN_SPAN_SIGMA * GAIN_STEPS_PER_SIGMA + 1)[:, None] / GAIN_STEPS_PER_SIGMA
    b = np.arange(0.0, 3.0, 2e-3)[None, :]  # the best b lies in [0, 1]; the grid errs by less than 1e-6
    gain = np.exp(-0.5 * b * b) - np.exp(-0.5 * (b + d) ** 2)
    return np.minimum(gain.max(axis=1) + 2e-6, 1.0)


@numba.njit(cache=True, nogil=True)
def still_records(pressure):  # pragma: no cover  (compiled)
    """(z,) true for records on which no wind acts: the pressure (z, 2) is exactly zero."""
    calm = np.empty(len(pressure), np.bool_)
    for j in range(len(pressure)):
        calm[j] = pressure[j, 0] == 0.0 and pressure[j, 1] == 0.0
    return calm


@numba.njit(cache=True, nogil=True)
def _prune_row(c, row, pressure, barred, scale, leverage, gain, components, order, kept):  # pragma: no cover
    """Write the candidates of state c to ``kept``, sorted by (mismatches, j); return how many.

    Only a record of the same air, still or moving, can make another superfluous: either may be asked alone.
    Record c itself, the successor, wins every tie and is always kept.
    """
    z = len(row)
    calm = still_records(pressure)
    bucket = np.zeros(components + 2, np.int32)
    for j in range(z):
        bucket[row[j] + 1] += 1
    for e in range(components + 1):
        bucket[e + 1] += bucket[e]
    for j in range(z):
        order[bucket[row[j]]] = j
        bucket[row[j]] += 1
    count = 0
    hopeless = np.full(2, np.inf)  # for either air: an error that nothing can make up for
    if not barred[c]:
        kept[0] = c
        count = 1
        hopeless[int(calm[c])] = 2 * MARGIN + leverage
    for i in range(z):
        j = order[i]
        if barred[j] or j == c:
            continue
        error = row[j] / components - MARGIN
        if error > max(hopeless[0], hopeless[1]):
            break
        hopeless[int(calm[j])] = min(hopeless[int(calm[j])], error + 2 * MARGIN + leverage)
        dropped = False
        for s in range(count):
            k = kept[s]
            if calm[k] != calm[j]:
                continue
            slack = error - row[k] / components
            dx = pressure[j, 0] - pressure[k, 0]
            dz = pressure[j, 1] - pressure[k, 1]
            if dx == 0.0 and dz == 0.0:
                dropped = True
            elif slack > 0.0:
                d = np.sqrt(dx * dx + dz * dz) * scale
                dropped = leverage * gain[min(int(d) + 1, len(gain) - 1)] < slack or leverage < slack
            else:
                break  # candidates are sorted: no later one has a smaller error
            if dropped:
                break
        if not dropped:
            kept[count] = j
            count += 1
    s = 1
    while s < count and kept[0] == c and row[kept[s]] == row[c] and kept[s] < c:
        s += 1
    for i in range(1, s):  # the successor from the front to its place in the order
        kept[i - 1] = kept[i]
    kept[s - 1] = c if s > 1 else kept[0]
    return count


@numba.njit(cache=True, nogil=True)
def _prune_rows(first, rows, pressure, barred, scale, leverage, gain, components, counts, record, mismatches):
    order = np.empty(rows.shape[1], np.int32)  # pragma: no cover  (compiled)
    kept = np.empty(rows.shape[1], np.int32)
    for c in range(len(rows)):
        count = _prune_row(
            first + c, rows[c], pressure, barred, scale, leverage, gain, components, order, kept
        )
        counts[c] = count
        for s in range(count):
            record[c, s] = kept[s]
            mismatches[c, s] = rows[c, kept[s]]


def last_records(trajectory: Array) -> npt.NDArray[np.bool_]:
    """(z,) true for the last record of each trajectory: it has no successor and is never chosen."""
    last = np.zeros(int(trajectory[-1]), np.bool_)
    last[trajectory[1:].astype(np.int64) - 1] = True
    return last


def prune(
    first: int,
    rows: Array,
    pressure_pa: Array,
    trajectory: Array,
    components: int,
    sigma_pa: float,
    maximum_weight: float,
) -> tuple[Array, Array, Array]:
    """Candidates of states first, first + 1 … by their mismatches: counts (n,), records, mismatches."""
    counts = np.empty(len(rows), np.int64)
    record, mismatches = np.empty_like(rows), np.empty_like(rows)
    pressure = pressure_pa.astype(np.float64)
    scale = GAIN_STEPS_PER_SIGMA / sigma_pa
    leverage = maximum_weight / (1.0 - maximum_weight)
    barred = last_records(trajectory)
    _prune_rows(
        first, rows, pressure, barred, scale, leverage, gain_bound(), components, counts, record, mismatches
    )
    inside = np.arange(rows.shape[1])[None, :] < counts[:, None]
    return counts, record[inside], mismatches[inside]


def build_search(
    states: InternalStates,
    pressure_pa: Array,
    trajectory: Array,
    sigma_pa: float,
    maximum_weight: float,
    tick: Callable[[float], None] = lambda fraction: None,
) -> Search:
    """Compare every record with every other and keep the candidates. ``tick`` hears the fraction done."""
    layout, components = compared(states), states.components
    z = len(layout.value)

    def chunk(first: int) -> tuple[Array, Array, Array]:
        rows = mismatch_rows(layout, first, min(first + CHUNK, z))
        return prune(first, rows, pressure_pa, trajectory, components, sigma_pa, maximum_weight)

    parts: list[tuple[Array, Array, Array]] = []
    # Threads, not numba's own parallel loops: the kernels hold no lock, and builds may run side by side.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for part in pool.map(chunk, range(0, z, CHUNK)):
            parts.append(part)
            tick(min(1.0, len(parts) * CHUNK / z))
    counts = np.concatenate([part[0] for part in parts])
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.uint32)
    return Search(
        offsets, np.concatenate([part[1] for part in parts]), np.concatenate([part[2] for part in parts])
    )
