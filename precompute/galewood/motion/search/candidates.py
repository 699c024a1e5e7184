"""Candidate lists for an exact search: most records can never be found from a given state.

The proof is in docs/design/0001-exact-search.md; ``_pairs`` is its first rule and ``envelope`` its second.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from galewood.motion.search.contenders import Stages, complete, lower_bounds, stages
from galewood.motion.search.envelope import keep_winners
from galewood.motion.search.similarity import Compared
from galewood.util import Array, Floats

ROUNDING_MARGIN = 1e-9
"""A candidate is dropped only if it loses by more than any rounding error."""
CHUNK_STATES = 48
"""States per task of the thread pool."""
GRID_CELLS = 64
"""Cells per side of the pressure grid, each one σ wide; pressures beyond it go to the last cell."""
NEIGHBOUR_OFFSETS = (
    0,
    1,
    -1,
    GRID_CELLS,
    -GRID_CELLS,
    GRID_CELLS + 1,
    GRID_CELLS - 1,
    1 - GRID_CELLS,
    -1 - GRID_CELLS,
)
"""Index offsets of a cell and its neighbours."""
GAIN_STEPS_PER_SIGMA = 256
GAIN_SPAN_SIGMA = 12


@dataclass(frozen=True)
class Search:
    """Candidates j of every state c, sorted by (mismatches, j), in CSR form."""

    offsets: npt.NDArray[np.uint32]  # (z + 1,)
    record: npt.NDArray[np.uint16]  # (nnz,)
    mismatches: npt.NDArray[np.uint16]  # (nnz,)


@dataclass(frozen=True)
class Rule:
    """Parameters of Eq. 16 and the range of its weight w; the candidates are exact for all w in the range."""

    components: int
    sigma_pa: float
    weight_initial: float
    weight_maximum: float

    @property
    def leverage(self) -> tuple[float, float]:
        """w / (1 − w) at both ends of the range."""
        w0, w1 = self.weight_initial, self.weight_maximum
        return w0 / (1.0 - w0), w1 / (1.0 - w1)


class Air(NamedTuple):
    """Pressures of the records, and which records the search may find."""

    pressure: npt.NDArray[np.float64]  # (z, 2) Pa
    calm: npt.NDArray[np.bool_]  # (z,) no wind acts
    barred: npt.NDArray[np.bool_]  # (z,) last of a trajectory: never found, as it has no successor


class Weighing(NamedTuple):
    """What decides whether one record beats another, as the kernels take it."""

    components: int
    sigma: float  # Pa
    leverage: tuple[float, float]  # w / (1 − w) at both ends of the range of w
    gain: Floats  # ``gain_bound``


def air_of(pressure_pa: Array, trajectory: Array) -> Air:
    """Air of records with pressures (z, 2), Pa; ``trajectory`` holds the first record of each run, and z."""
    barred = last_records(trajectory)
    return Air(pressure_pa.astype(np.float64), still_records(pressure_pa), barred)


def gain_bound() -> npt.NDArray[np.float64]:
    """Upper bound of G(d) = max_b [exp(−b²/2) − exp(−(b+d)²/2)] at d = i / GAIN_STEPS_PER_SIGMA (d in σ).

    G(d) is the largest advantage in external error over a rival at distance d, under any pressure.
    """
    d = np.arange(GAIN_SPAN_SIGMA * GAIN_STEPS_PER_SIGMA + 1)[:, None] / GAIN_STEPS_PER_SIGMA
    b = np.arange(0.0, 3.0, 2e-3)[None, :]  # the maximum lies in [0, 1]; the grid error is below 1e-6
    gain = np.exp(-0.5 * b * b) - np.exp(-0.5 * (b + d) ** 2)
    return np.minimum(gain.max(axis=1) + 2e-6, 1.0)


@numba.njit(cache=True, nogil=True)
def still_records(pressure):  # pragma: no cover  (compiled)
    """(z,) true for records without wind: the pressure (z, 2) is exactly zero."""
    calm = np.empty(len(pressure), np.bool_)
    for j in range(len(pressure)):
        calm[j] = pressure[j, 0] == 0.0 and pressure[j, 1] == 0.0
    return calm


def last_records(trajectory: Array) -> npt.NDArray[np.bool_]:
    """(z,) true for the last record of each trajectory, which is never found as it has no successor."""
    last = np.zeros(int(trajectory[-1]), np.bool_)
    last[trajectory[1:].astype(np.int64) - 1] = True
    return last


@numba.njit(cache=True, nogil=True)
def _ordered(row, chosen, components, order):  # pragma: no cover  (compiled)
    """Sort the chosen records by (mismatches, index), by counting sort; return their number."""
    bucket = np.zeros(components + 2, np.int32)
    for j in range(len(row)):
        if chosen[j]:
            bucket[row[j] + 1] += 1
    for e in range(components + 1):
        bucket[e + 1] += bucket[e]
    for j in range(len(row)):
        if chosen[j]:
            order[bucket[row[j]]] = j
            bucket[row[j]] += 1
    return bucket[components]


@numba.njit(cache=True, nogil=True)
def cells_of(pressure, sigma, lowest):  # pragma: no cover  (compiled)
    """(z,) grid cell of each pressure (z, 2); the outermost cells stay empty as a border."""
    cells = np.empty(len(pressure), np.int32)
    for j in range(len(pressure)):
        x = 1 + min(int((pressure[j, 0] - lowest[0]) / sigma), GRID_CELLS - 3)
        z = 1 + min(int((pressure[j, 1] - lowest[1]) / sigma), GRID_CELLS - 3)
        cells[j] = x * GRID_CELLS + z
    return cells


@numba.njit(cache=True, nogil=True)
def _beats(k, j, error, own, pressure, scale, leverage, gain):  # pragma: no cover  (compiled)
    """Whether record k of error ``own``, which precedes j, beats j under every pressure."""
    slack = error - own
    dx = pressure[j, 0] - pressure[k, 0]
    dz = pressure[j, 1] - pressure[k, 1]
    if dx == 0.0 and dz == 0.0:
        return True
    d = math.sqrt(dx * dx + dz * dz) * scale
    return leverage * gain[min(int(d) + 1, len(gain) - 1)] < slack or leverage < slack


@numba.njit(cache=True, nogil=True)
def _choose_rows(first, bounds, air, weighing, chosen):
    """Choose the records that may be candidates of the states first, first + 1, …

    bounds (n, z): lower bounds of the mismatches. The others are those that ``_pairs`` would drop because of
    the successor, whatever their mismatches are.
    """  # pragma: no cover  (compiled)
    pressure, calm, barred = air
    components, sigma, leverage, gain = weighing
    scale = GAIN_STEPS_PER_SIGMA / sigma
    for i in range(len(bounds)):
        c = first + i
        for j in range(bounds.shape[1]):
            if barred[c] or j == c:
                chosen[i, j] = True
            elif barred[j]:
                chosen[i, j] = False
            elif calm[j]:
                chosen[i, j] = not calm[c]
            else:
                error = bounds[i, j] / components - ROUNDING_MARGIN
                chosen[i, j] = not _beats(c, j, error, 0.0, pressure, scale, leverage[1], gain)


@numba.njit(cache=True, nogil=True)
def _pairs(c, row, chosen, air, cells, weighing, room):
    """Write the candidates of state c that no nearby candidate beats to ``kept``; return their number.

    They are sorted by (mismatches, j), except for the successor, record c itself, which wins every tie and
    comes first. A record may beat only records of the same air (still or moving), as a query may be
    restricted to either; but a state of still air is never queried for moving air only. All still records
    have the same pressure, so only the first of them is kept. ``room`` are ``kept`` and work arrays.
    """  # pragma: no cover  (compiled)
    pressure, calm, barred = air
    components, sigma, leverages, gain = weighing
    kept, order, head, after = room
    scale, leverage = GAIN_STEPS_PER_SIGMA / sigma, leverages[1]
    number = _ordered(row, chosen, components, order)
    across = calm[c] and not barred[c]
    head[:] = -1  # last kept moving record of each cell; ``after`` links to the one kept before it
    count, still_kept = 0, False
    hopeless = np.full(2, np.inf)  # per air: an error that no pressure can compensate
    if not barred[c]:
        kept[0] = c
        count = 1
        still_kept = calm[c]
        hopeless[int(calm[c])] = 2 * ROUNDING_MARGIN + leverage
        if across:
            hopeless[:] = 2 * ROUNDING_MARGIN + leverage
    for i in range(number):
        j = order[i]
        if barred[j] or j == c:
            continue
        error = row[j] / components - ROUNDING_MARGIN
        if error > max(hopeless[0], hopeless[1]):
            break
        hopeless[int(calm[j])] = min(hopeless[int(calm[j])], error + 2 * ROUNDING_MARGIN + leverage)
        if calm[j]:
            beaten = still_kept
            still_kept = True
        else:
            use_successor = count > 0 and kept[0] == c and (across or not calm[c])
            beaten = use_successor and _beats(
                c, j, error, row[c] / components, pressure, scale, leverage, gain
            )
            for side in NEIGHBOUR_OFFSETS:
                if beaten:
                    break
                s = head[cells[j] + side]
                while s >= 0 and not beaten:
                    k = kept[s]
                    own = row[k] / components
                    beaten = _beats(k, j, error, own, pressure, scale, leverage, gain)
                    s = after[s]
        if not beaten:
            kept[count] = j
            if not calm[j]:
                after[count] = head[cells[j]]
                head[cells[j]] = count
            count += 1
    return count


@numba.njit(cache=True, nogil=True)
def _sort_successor(c, row, kept, count):  # pragma: no cover  (compiled)
    """Move the successor from the front to its place in the order of (mismatches, j)."""
    if kept[0] != c:
        return
    s = 1
    while s < count and row[kept[s]] == row[c] and kept[s] < c:
        kept[s - 1] = kept[s]
        s += 1
    kept[s - 1] = c


@numba.njit(cache=True, nogil=True)
def _prune_rows(
    first, rows, chosen, air, cells, weighing, counts, record, mismatches
):  # pragma: no cover  (compiled)
    order, kept, after = (
        np.empty(rows.shape[1], np.int32),
        np.empty(rows.shape[1], np.int32),
        np.empty(rows.shape[1], np.int32),
    )
    head = np.empty(GRID_CELLS * GRID_CELLS, np.int32)
    for i in range(len(rows)):
        c, row = first + i, rows[i]
        count = _pairs(c, row, chosen[i], air, cells, weighing, (kept, order, head, after))
        if not air.barred[c]:
            count = keep_winners(c, row, air, weighing, ROUNDING_MARGIN, kept, count)
        _sort_successor(c, row, kept, count)
        counts[i] = count
        for s in range(count):
            record[i, s] = kept[s]
            mismatches[i, s] = row[kept[s]]


@dataclass(frozen=True)
class Builder:
    """What the candidates of all states depend on."""

    parts: Stages
    air: Air
    weighing: Weighing
    cells: npt.NDArray[np.int32]  # (z,) grid cell of each pressure

    def candidates(self, first: int, last: int) -> tuple[Array, Array, Array]:
        """Candidates of the states [first, last).

        Returns the number of candidates of each state (n,), and all records and mismatches, concatenated.
        """
        rows = lower_bounds(self.parts, first, last)
        chosen = np.empty(rows.shape, np.bool_)
        _choose_rows(first, rows, self.air, self.weighing, chosen)
        complete(self.parts, first, chosen, rows)
        counts = np.empty(len(rows), np.int64)
        record, mismatches = np.empty_like(rows), np.empty_like(rows)
        _prune_rows(first, rows, chosen, self.air, self.cells, self.weighing, counts, record, mismatches)
        return (
            counts,
            np.concatenate([record[i, :n] for i, n in enumerate(counts)]),
            np.concatenate([mismatches[i, :n] for i, n in enumerate(counts)]),
        )


def build_search(
    layout: Compared, air: Air, rule: Rule, on_progress: Callable[[float], None] = lambda fraction: None
) -> Search:
    """Find the candidates of all states; ``on_progress`` gets the fraction done and may raise to cancel."""
    z = len(layout.rank)
    cells = cells_of(air.pressure, rule.sigma_pa, air.pressure.min(axis=0))
    weighing = Weighing(rule.components, rule.sigma_pa, rule.leverage, gain_bound())
    builder = Builder(stages(layout), air, weighing, cells)

    def chunk(first: int) -> tuple[Array, Array, Array]:
        return builder.candidates(first, min(first + CHUNK_STATES, z))

    parts: list[tuple[Array, Array, Array]] = []
    # Threads instead of numba's parallel loops: the kernels release the GIL, and builds may run concurrently.
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for part in pool.map(chunk, range(0, z, CHUNK_STATES)):
            parts.append(part)
            on_progress(min(1.0, len(parts) * CHUNK_STATES / z))
    counts = np.concatenate([part[0] for part in parts])
    offsets = np.concatenate([[0], np.cumsum(counts)]).astype(np.uint32)
    return Search(
        offsets, np.concatenate([part[1] for part in parts]), np.concatenate([part[2] for part in parts])
    )
