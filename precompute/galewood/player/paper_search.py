"""The paper's state search (Algorithm 1) for many trees: finds the next record and the resulting pose.

Every language performs the same operations in the same order. All find the same records and, in units of the
table's mode scale, bit-identical poses: no fused multiply-add, no fast math.
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
import weakref
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from galewood.constants import (
    EXPONENTIAL_SQUARINGS,
    EXPONENTIAL_TERMS,
    MAX_STEPS_PER_ADVANCE,
    SEARCH_ANY_AIR,
    SEARCH_SNAP,
)
from galewood.motion.search import last_records, still_records
from galewood.player.instances import TreeInstances
from galewood.table import Table
from galewood.util import Array, Floats

_TERMS = np.array([(-1.0) ** n / math.factorial(n) for n in range(EXPONENTIAL_TERMS)])
"""Taylor series of exp(−t) for small t."""
_DIVISOR = 2.0**EXPONENTIAL_SQUARINGS


@numba.njit(cache=True, nogil=True)
def gaussian(exponent):
    """1 − exp(−exponent) for exponent ≥ 0, by sums and products only: the same bits in all languages."""
    t = min(exponent, 50.0) / _DIVISOR
    p = _TERMS[EXPONENTIAL_TERMS - 1]
    for n in range(EXPONENTIAL_TERMS - 2, -1, -1):
        p = p * t + _TERMS[n]
    for _ in range(EXPONENTIAL_SQUARINGS):
        p = p * p
    return 1.0 - p


class SearchArrays(NamedTuple):
    """Search tensors of a table in the types of the computation."""

    offsets: npt.NDArray[np.int64]
    candidate: npt.NDArray[np.int64]
    error: Floats  # (nnz,) E_int
    pressure: Floats  # (z, 2) Pa
    calm: npt.NDArray[np.bool_]  # (z,) no wind acts
    barred: npt.NDArray[np.bool_]  # (z,) last of a trajectory
    by_x: npt.NDArray[np.int64]  # (z,) records sorted by pressure along x
    half_precision: float  # 1 / (2 σ²), Pa⁻²


@numba.njit(cache=True, nogil=True)
def nearest_pressure(search, air, fx, fz):
    """First step (Algorithm 1, line 2): the record with a successor and the nearest pressure to (fx, fz), Pa.

    Ties go to the lowest record. The records are visited in the order of their pressures along x, outwards
    from fx, until that component alone exceeds the best distance. ``search`` are SearchArrays, ``air`` as in
    ``best_candidate``. Returns −1 if there is no such record.
    """
    pressure, by_x = search.pressure, search.by_x
    below, above = 0, len(by_x)
    while below < above:
        middle = (below + above) // 2
        if pressure[by_x[middle], 0] < fx:
            below = middle + 1
        else:
            above = middle
    right, left = below, below - 1
    best, found = np.inf, -1
    while left >= 0 or right < len(by_x):
        to_left = fx - pressure[by_x[left], 0] if left >= 0 else np.inf
        to_right = pressure[by_x[right], 0] - fx if right < len(by_x) else np.inf
        if to_left < to_right:
            j = by_x[left]
            left -= 1
        else:
            j = by_x[right]
            right += 1
        dx, dz = fx - pressure[j, 0], fz - pressure[j, 1]
        if dx * dx > best:
            break
        distance = dx * dx + dz * dz
        better = distance < best or (distance == best and j < found)
        if better and not search.barred[j] and (air == SEARCH_ANY_AIR or search.calm[j] == air):
            best, found = distance, j
    return found


@numba.njit(cache=True, nogil=True)
def best_candidate(search, state, weight, air, fx, fz):
    """Later steps (Algorithm 1, lines 7–9): the candidate of least total error (Eq. 16).

    Ties go to the successor of the last record, then to the lowest record. Candidates are sorted by internal
    error, so the search stops once that alone exceeds the best total. ``air`` restricts the search to records
    of moving air (0) or still air (1); SEARCH_ANY_AIR allows all. Returns −1 if there is no such record.
    """
    pressure = search.pressure
    best, found = np.inf, -1
    for s in range(search.offsets[state], search.offsets[state + 1]):
        internal = (1.0 - weight) * search.error[s]
        if internal > best:
            break
        j = search.candidate[s]
        if air != SEARCH_ANY_AIR and search.calm[j] != air:
            continue
        dx, dz = fx - pressure[j, 0], fz - pressure[j, 1]
        total = internal + weight * gaussian((dx * dx + dz * dz) * search.half_precision)
        if total < best or (total == best and (j == state or (found != state and j < found))):
            best, found = total, j
    return found


def brute_force(
    state: int,
    error_row: Floats,
    pressure: Floats,
    barred: Array,
    half_precision: float,
    weight: float,
    f: Floats,
    air: int = -1,
) -> int:
    """Reference for ``best_candidate`` that compares all records; ``error_row`` (z,): E_int, f (2,): Pa."""
    best, found = np.inf, -1
    for j in range(len(error_row)):
        dx, dz = f[0] - pressure[j, 0], f[1] - pressure[j, 1]
        external = gaussian((dx * dx + dz * dz) * half_precision)
        total = (1.0 - weight) * error_row[j] + weight * external
        allowed = air == SEARCH_ANY_AIR or bool(air) == (not pressure[j].any())
        better = total < best or (total == best and j == state)
        if better and allowed and not barred[j]:
            best, found = total, j
    return found


def search_arrays(table: Table) -> SearchArrays:
    """Convert the search tensors of a table."""
    records = table.records
    sigma = float(records.metadata["sigma_pa"])
    return SearchArrays(
        records.offsets.astype(np.int64),
        records.candidate.astype(np.int64),
        records.mismatches.astype(np.float64) / float(records.metadata["components"]),
        records.pressure_pa.astype(np.float64),
        still_records(records.pressure_pa),
        last_records(records.trajectory),
        np.argsort(records.pressure_pa[:, 0], kind="stable"),
        1.0 / (2.0 * sigma * sigma),
    )


@numba.njit(cache=True, nogil=True)
def _ease(poses, dq, first, found, easing, now, before):
    """Follow the path of the record while the offset from it decays like a critically damped spring.

    The initial speed of the offset keeps the motion smooth where the search jumps. Both roots of the
    recurrence are 1 − easing (docs/design/0002-pose-easing.md).
    """
    keep = (1.0 - easing) * (1.0 - easing)
    pull = easing * easing
    settled = True
    for k in range(len(now)):
        came = 0.0 if first else dq[found - 1, k]
        offset = now[k] - poses[found, k]
        speed = keep * ((now[k] - before[k]) - came) - pull * offset
        before[k] = now[k]
        now[k] = poses[found + 1, k] + (offset + speed)
        settled = settled and abs(offset + speed) < SEARCH_SNAP and abs(speed) < SEARCH_SNAP
    if settled:
        for k in range(len(now)):
            now[k] = poses[found + 1, k]


@numba.njit(cache=True, nogil=True)
def _step(lookup, rule, i, fx, fz, state):
    """Step tree i: find the record, take over the state of its successor and add its Δq (Algorithm 1)."""
    search, dq = lookup.search, lookup.dq
    record, weight, now, before = state
    initial, maximum, growth, easing, separate_still_air = rule
    air = SEARCH_ANY_AIR
    if separate_still_air:
        air = 1 if fx == 0.0 and fz == 0.0 else 0
    found = _find(search, record[i] + 1, weight[i], air, fx, fz)
    if found < 0:  # no record of such air in the table: search all
        found = _find(search, record[i] + 1, weight[i], SEARCH_ANY_AIR, fx, fz)
    follows = found == record[i] + 1 and record[i] >= 0
    weight[i] = min(maximum, weight[i] + growth) if follows else initial
    record[i] = found
    if easing > 0.0:
        _ease(lookup.poses, dq, lookup.starts[found], found, easing, now[i], before[i])
    else:
        for k in range(dq.shape[1]):
            before[i, k] = now[i, k]
            now[i, k] += dq[found, k]


@numba.njit(cache=True, nogil=True)
def _find(search, state, weight, air, fx, fz):
    """Find the record for the next step from a state (0: first step).

    If wind sets in on a tree in still air, the search starts again with a first step.
    """
    if state == 0 or (air == 0 and search.calm[state]):
        return nearest_pressure(search, air, fx, fz)
    return best_candidate(search, state, weight, air, fx, fz)


@numba.njit(cache=True, nogil=True)
def _advance(lookup, scale, rule, rate, turn, pressure, phase, state, q):
    """Advance all trees by ``rate`` steps each and write the interpolated poses to q (count, r or more).

    ``lookup`` are LookupArrays; ``state`` holds record and weight (count,) and the poses of the last step and
    of that before (count, r).
    """
    px, pz = pressure
    _, _, now, before = state
    for i in range(len(phase)):
        fx = turn[i, 0] * px[i] - turn[i, 1] * pz[i]
        fz = turn[i, 1] * px[i] + turn[i, 0] * pz[i]
        phase[i] += rate[i]
        steps = 0
        while phase[i] >= 1.0 and steps < MAX_STEPS_PER_ADVANCE:
            _step(lookup, rule, i, fx, fz, state)
            phase[i] -= 1.0
            steps += 1
        phase[i] -= np.floor(phase[i])
        for k in range(now.shape[1]):
            q[i, k] = (before[i, k] + (now[i, k] - before[i, k]) * phase[i]) * scale[k]


class LookupArrays(NamedTuple):
    """Read-only arrays that all forests of a table share."""

    search: SearchArrays
    dq: Floats  # (z, r) in units of mode_scale
    poses: Floats  # (z, r)
    starts: npt.NDArray[np.bool_]  # (z,) first of a trajectory


_arrays: dict[int, LookupArrays] = {}


def lookup_arrays(table: Table) -> LookupArrays:
    """Arrays of a table in the types of the computation; created once and kept as long as the table."""
    found = _arrays.get(id(table))
    if found is None:
        found = _arrays[id(table)] = _widened(table)
        weakref.finalize(table, _arrays.pop, id(table), None)
    return found


def _widened(table: Table) -> LookupArrays:
    records = table.records
    starts = np.zeros(len(records.dq), np.bool_)
    starts[records.trajectory[:-1].astype(np.int64)] = True
    dq, poses = records.dq.astype(np.float64), records.pose().astype(np.float64)
    return LookupArrays(search_arrays(table), dq, poses, starts)


class PaperForest(TreeInstances):
    """Trees of one table stepped by the paper's state search, each with its own state, yaw and time scale."""

    def __init__(
        self, table: Table, count: int, *, pose_easing: float | None = None, still_air: bool = True
    ) -> None:
        """Create ``count`` trees at rest. ``pose_easing`` 0 with ``still_air`` False is the literal method.

        pose_easing: 0..1, how fast the pose approaches that of the record found; None: the table's value.
        still_air: in still air search only records of still air, otherwise only records of moving air.
        """
        super().__init__(count, table.mode_scale, float(table.metadata["dt_s"]))
        metadata = table.records.metadata
        easing = metadata["pose_easing"] if pose_easing is None else pose_easing
        self._lookup = lookup_arrays(table)
        weight = metadata["weight"]
        self._rule = (
            float(weight["initial"]),
            float(weight["maximum"]),
            float(weight["growth"]),
            float(easing),
            bool(still_air),
        )
        self._weight = np.zeros(count)
        self.record = np.full(count, -1, np.int32)
        """(count,) last record found, −1 before the first step; a tree is in the state of its successor."""

    def advance(self, dt_s: float, pressure_x: npt.ArrayLike, pressure_z: npt.ArrayLike) -> None:
        """Advance by dt_s seconds under world pressures (count,) in Pa. Large trees step slower."""
        pressure = self._begin(dt_s, pressure_x, pressure_z)
        state = (self.record, self._weight, self._now, self._before)
        _advance(
            self._lookup,
            self._scale,
            self._rule,
            self._rate,
            self._turn,
            pressure,
            self._phase,
            state,
            self.q,
        )
