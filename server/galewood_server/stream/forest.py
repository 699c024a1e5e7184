"""Forest simulation on the server: the clock, and wind and table lookup for every tree."""

from __future__ import annotations

from collections.abc import Sequence

import numba
import numpy as np
from galewood.constants import TICK_HZ
from galewood.motion.wind import Wind, WindField, WindState, change_wind, with_front
from galewood.options import Method
from galewood.player import WindDrivenForest, WindDrivenTrees
from galewood.table import Compliance, Table
from galewood.util import Floats, Singles

from galewood_server.stream.frames import Shape
from galewood_server.stream.pulls import GroupPulls, pullings
from galewood_server.stream.wire import Forest, Poses, Pull, Pulling, Trees

WARM_UP_TREES = 2
"""Trees stepped to warm up: numba compiles other code for arrays of one row."""
STREAM_ERROR_M = 0.25e-3
"""Maximum displacement error of a node from quantisation, for a tree of scale 1."""


@numba.njit(cache=True, nogil=True)
def quantise(q: Singles, unit: Floats, out: Poses) -> None:  # pragma: no cover  (compiled)
    """out (n, r) = round(q / unit): q (n, r) modal coordinates, unit (r,) quantisation step per mode."""
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            out[i, k] = np.int32(np.rint(q[i, k] / unit[k]))


def stream_quantum(table: Table) -> int:
    """Quantisation step in units of modes.scale for which √Σ(½ step)² over the modes ≤ STREAM_ERROR_M."""
    reach_m = np.linalg.norm(table.node_basis, axis=1).max(axis=0, initial=0.0) * table.mode_scale
    half_step_m = 0.5 * float(np.sqrt(np.sum(reach_m.astype(np.float64) ** 2)))
    return int(np.clip(STREAM_ERROR_M / max(half_step_m, 1e-12), 1, 65535))


class ForestClock:
    """The time of a forest, advanced TICK_HZ times per second, and its wind."""

    def __init__(self, wind: WindState, start_s: float) -> None:
        self.paused = False
        self.ticks = 0
        self.field = WindField(wind)
        self._start_s = start_s
        self._next = wind

    @property
    def time_s(self) -> float:
        """The forest's time (s), which is the time of its current poses."""
        return self._start_s + self.ticks / TICK_HZ

    @property
    def wind(self) -> WindState:
        """The wind that applies from the next tick on."""
        return self._next

    def change_wind(self, wind: Wind) -> WindState:
        """Start a transition to another wind at the next tick. Thread-safe with respect to `tick`.

        Returns the state from which a client computes the same wind. The transition starts at the end of a
        tick that may be in progress, so that this tick sees the old wind with either state.
        """
        self._next = change_wind(self._next, wind, self.time_s + 1 / TICK_HZ)
        return self._next

    def send_front(self, x_m: float, z_m: float) -> WindState:
        """Start a gust front at a place at the next tick. Thread-safe like `change_wind`."""
        self._next = with_front(self._next, x_m, z_m, self.time_s + 1 / TICK_HZ)
        return self._next

    def lacks(self, wind: Wind) -> bool:
        """Whether the gusts of a wind must be prepared before it applies."""
        return not self.field.has(wind)

    def prepare(self, wind: Wind | None = None) -> None:
        """Prepare the gusts of the present wind, or of one to change to. Slow: call it in a thread."""
        state = self._next if wind is None else change_wind(self._next, wind, self.time_s)
        self.field.prepare(state, self.time_s)

    def tick(self) -> None:
        """Advance by one tick."""
        self.field.state = self._next
        self.ticks += 1


class GroupStepper:
    """The trees of one table, and their poses as integers for the stream."""

    def __init__(
        self,
        table: Table,
        trees: Trees,
        pose_easing: float | None,
        method: Method,
        compliance: Compliance | None = None,
    ) -> None:
        """trees (n, 4): x (m), z (m), yaw (rad), scale."""
        self._made_of = (table, trees[:WARM_UP_TREES], pose_easing, method)
        self.trees = WindDrivenTrees(table, trees, method, pose_easing)
        self.pulls = GroupPulls(table, trees, compliance)
        quantum = stream_quantum(table)
        self._unit = quantum * table.mode_scale.astype(np.float64)
        self.shape: Shape = (len(trees), len(table.mode_scale), quantum)

    def pull(self, pulls: Sequence[Pull], dt_s: float) -> None:
        """Move the trees that are pulled by their hands; call after all trees have been advanced by dt_s."""
        self.pulls.step(self.trees, pulls, dt_s)

    def warm_up(self) -> None:
        """Step a few trees of this kind, so that everything is compiled before the first tick."""
        few, field = GroupStepper(*self._made_of), WindField(Wind())
        few.trees.step(field, 1.0, 1 / TICK_HZ)
        WindDrivenForest([few.trees]).step(field, 2.0, 1 / TICK_HZ)
        few.pull((), 1 / TICK_HZ)
        few.write_poses(np.zeros(few.shape[:2], np.int32))

    def write_poses(self, out: Poses) -> None:
        """Write the poses (n, r) in units of quantum × modes.scale."""
        quantise(self.trees.q, self._unit, out)


class ForestStepper:
    """All groups of a forest, stepped under one clock."""

    def __init__(
        self,
        tables: Sequence[Table],
        forest: Forest,
        clock: ForestClock,
        compliances: Sequence[Compliance | None] = (),
    ) -> None:
        """`tables` has one table per group of `forest`, `compliances` its compliance or None, if given."""
        ends = np.cumsum([group.count for group in forest.groups], dtype=np.int64)
        parts = np.split(forest.trees, ends)[:-1]
        self.clock = clock
        given = compliances or [None] * len(tables)
        clock.prepare()
        self._groups = [
            GroupStepper(table, part, forest.pose_easing, forest.method, compliance)
            for table, part, compliance in zip(tables, parts, given, strict=True)
        ]

        self._forest = WindDrivenForest([group.trees for group in self._groups])
        for group in self._groups:
            group.warm_up()

    @property
    def shapes(self) -> list[Shape]:
        """(count, modes, quantum) of each group."""
        return [group.shape for group in self._groups]

    def step(self, pulls: Sequence[Pull] = ()) -> None:
        """Advance by one tick under the wind at its end, like the browser."""
        self._forest.step(self.clock.field, self.clock.time_s, 1 / TICK_HZ)
        for group in self._groups:
            group.pull(pulls, 1 / TICK_HZ)

    def pullings(self, pulls: Sequence[Pull]) -> tuple[Pulling, ...]:
        """The pulls and the forces that they exerted in the last step."""
        return pullings(pulls, [group.pulls for group in self._groups])

    def write_poses(self, out: Sequence[Poses]) -> None:
        """Write the poses (count, r) of each group."""
        for group, rows in zip(self._groups, out, strict=True):
            group.write_poses(rows)
