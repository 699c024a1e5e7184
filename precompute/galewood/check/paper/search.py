"""Comparison of the table's search with Algorithm 1 as printed, which compares states with all records."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from collections.abc import Sequence

import numba
import numpy as np
import numpy.typing as npt

from galewood.check.paper.plan import OnProgress, Plan
from galewood.motion.search import compared, mismatch_rows
from galewood.pipeline.sampling import SampledRun
from galewood.pipeline.tables import internal_states
from galewood.player import PaperForest, gaussian
from galewood.table import Table
from galewood.util import Array

TREE_COUNT = 100
CHUNK_RECORDS = 64


@numba.njit(cache=True, nogil=True)
def _least(row, components, pressure, barred, half_precision, weight, state, fx, fz):  # pragma: no cover
    """Record of least total error (Eq. 16); ties go to the successor, then to the lowest index."""
    best, found = np.inf, -1
    for j in range(len(row)):
        if barred[j]:
            continue
        dx, dz = fx - pressure[j, 0], fz - pressure[j, 1]
        internal = (1.0 - weight) * (row[j] / components)
        total = internal + weight * gaussian((dx * dx + dz * dz) * half_precision)
        if total < best or (total == best and j == state):
            best, found = total, j
    return found


@numba.njit(cache=True, nogil=True)
def _nearest(pressure, barred, fx, fz):  # pragma: no cover  (compiled)
    """First step (Algorithm 1, line 2): the lowest-numbered record with the nearest pressure."""
    best, found = np.inf, -1
    for j in range(len(pressure)):
        dx, dz = fx - pressure[j, 0], fz - pressure[j, 1]
        distance = dx * dx + dz * dz
        if distance < best and not barred[j]:
            best, found = distance, j
    return found


class Literal:
    """Algorithm 1 without precomputation: at every step the state is compared with every record.

    ``least``, ``most`` and ``growth`` are the weight rule of the table.
    """

    def __init__(self, table: Table, runs: Sequence[SampledRun]) -> None:
        states = internal_states(runs)
        self._layout, self._components = compared(states), float(states.components)
        self._rows: Array | None = None
        records = table.records
        self._pressure = records.pressure_pa.astype(np.float64)
        self._barred = np.zeros(len(self._pressure), np.bool_)
        self._barred[records.trajectory[1:].astype(np.int64) - 1] = True
        sigma = float(records.metadata["sigma_pa"])
        self._half_precision = 1.0 / (2.0 * sigma * sigma)
        weight = records.metadata["weight"]
        self.least, self.most = float(weight["initial"]), float(weight["maximum"])
        self.growth = float(weight["growth"])

    def compare_all(self) -> None:
        """Precompute all comparisons, for many queries; the counts are the same."""
        z = len(self._pressure)
        self._rows = np.empty((z, z), np.uint16)
        for first in range(0, z, CHUNK_RECORDS):
            last = min(first + CHUNK_RECORDS, z)
            self._rows[first:last] = mismatch_rows(self._layout, first, last)

    def _row(self, state: int) -> Array:
        if self._rows is not None:
            return self._rows[state]
        return mismatch_rows(self._layout, state, state + 1)[0]

    def find(self, record: int, weight: float, f: tuple[float, float]) -> int:
        """Return the record for the next step.

        ``record`` is the last one found (−1 at rest), f the pressure (x, z) in Pa.
        """
        if record < 0:
            return int(_nearest(self._pressure, self._barred, *f))
        state = record + 1
        return int(
            _least(
                self._row(state),
                self._components,
                self._pressure,
                self._barred,
                self._half_precision,
                weight,
                state,
                *f,
            )
        )


def against_brute_force(
    plan: Plan, table: Table, runs: Sequence[SampledRun], on_progress: OnProgress
) -> dict[str, int]:
    """Count random queries that the table's search and Algorithm 1 answer differently.

    The trees step through the table under pressures that jump at every step: a third are those of records, a
    third anything up to 1.3 times the strongest, and a third nearly calm.
    """
    literal, rng = Literal(table, runs), np.random.default_rng(plan.seed)
    literal.compare_all()
    peak = float(np.linalg.norm(table.records.pressure_pa, axis=1).max())
    queries = differences = 0
    states: set[int] = set()
    while queries < plan.queries:
        forest = PaperForest(table, TREE_COUNT, pose_easing=0.0, still_air=False)
        weight = np.zeros(TREE_COUNT)
        for _ in range(20):
            if queries >= plan.queries:
                break
            f = _winds(rng, table, peak)
            before = forest.record.copy()
            forest.advance(float(table.metadata["dt_s"]) * (1 + 1e-12), f[:, 0], f[:, 1])
            for i in range(TREE_COUNT):
                found = literal.find(int(before[i]), weight[i], (float(f[i, 0]), float(f[i, 1])))
                differences += int(found != forest.record[i])
                follows = before[i] >= 0 and forest.record[i] == before[i] + 1
                weight[i] = min(literal.most, weight[i] + literal.growth) if follows else literal.least
            states.update(before.tolist())
            queries += TREE_COUNT
            on_progress(min(queries / plan.queries, 1.0), f"Compared {queries:,} of {plan.queries:,} queries")
    return {"queries": queries, "differences": differences, "states": len(states), "seed": plan.seed}


def _winds(rng: np.random.Generator, table: Table, peak: float) -> npt.NDArray[np.float32]:
    """(TREE_COUNT, 2) Pa in single precision, so that both searches get exactly the same pressures."""
    own = table.records.pressure_pa[rng.integers(0, len(table.records.pressure_pa), TREE_COUNT)].astype(
        np.float64
    )
    angle, size = rng.uniform(0, 2 * np.pi, TREE_COUNT), peak * np.sqrt(rng.uniform(0, 1.69, TREE_COUNT))
    size[2 * TREE_COUNT // 3 :] *= 0.02
    any_wind = size[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return np.where((np.arange(TREE_COUNT) < TREE_COUNT // 3)[:, None], own, any_wind).astype(np.float32)
