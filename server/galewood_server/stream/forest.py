"""A forest on the server: its clock, and wind and lookup for every tree of every group."""

# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from collections.abc import Sequence

import numba
import numpy as np
from galewood.player import WindDrivenTrees
from galewood.table import Table
from galewood.wind import Wind, WindField, WindState, change_wind

from galewood_server.stream.frames import Shape
from galewood_server.stream.wire import TICK_HZ, Forest, Method, Poses
from galewood_server.stream.wire_forest import Trees

STREAM_ERROR_M = 0.25e-3
"""How far rounding may move a node of a tree of scale 1, at worst."""


@numba.njit(cache=True, nogil=True)
def quantise(q, unit, out):  # pragma: no cover  (compiled)
    """out = q / unit, rounded: (n, r) poses by the (r,) step of each mode."""
    for i in range(q.shape[0]):
        for k in range(q.shape[1]):
            out[i, k] = np.int32(np.rint(q[i, k] / unit[k]))


def stream_quantum(table: Table) -> int:
    """Units of modes.scale that a stream may round poses to: √Σ(½ step)² over the modes stays in bounds."""
    reach_m = np.linalg.norm(table.node_basis, axis=1).max(axis=0, initial=0.0) * table.mode_scale
    half_step_m = 0.5 * float(np.sqrt(np.sum(reach_m.astype(np.float64) ** 2)))
    return int(np.clip(STREAM_ERROR_M / max(half_step_m, 1e-12), 1, 65535))


class ForestClock:
    """A forest's time, which ticks TICK_HZ times a second, and its wind."""

    def __init__(self, wind: WindState, start_s: float) -> None:
        self.paused = False
        self.ticks = 0
        self.field = WindField(wind)
        self._start_s = start_s
        self._next = wind

    @property
    def time_s(self) -> float:
        """The forest's own time: that of its poses as they are now."""
        return self._start_s + self.ticks / TICK_HZ

    @property
    def wind(self) -> WindState:
        """The wind from the next tick on."""
        return self._next

    def change_wind(self, wind: Wind) -> WindState:
        """Glide to another wind from the next tick on; may be called while a tick is computed elsewhere.

        The state is what a client needs to show the same wind. It begins at the end of the tick that may be
        under way, which therefore sees the old wind whichever state it takes.
        """
        self._next = change_wind(self._next, wind, self.time_s + 1 / TICK_HZ)
        return self._next

    def tick(self) -> None:
        """One tick on."""
        self.field.state = self._next
        self.ticks += 1


class GroupStepper:
    """Trees of one table, and their poses as the stream sends them."""

    def __init__(self, table: Table, trees: Trees, pose_easing: float | None, method: Method) -> None:
        """trees (n, 4): x m, z m, yaw rad, scale."""
        self._trees = WindDrivenTrees(table, trees, method, pose_easing)
        quantum = stream_quantum(table)
        self._unit = quantum * table.mode_scale.astype(np.float64)
        self.shape: Shape = (len(trees), len(table.mode_scale), quantum)

    def step(self, field: WindField, time_s: float, dt_s: float) -> None:
        """Advance by dt_s, up to time_s, under the wind of that moment."""
        self._trees.step(field, time_s, dt_s)

    def write_poses(self, out: Poses) -> None:
        """(n, r) poses in units of quantum × modes.scale."""
        quantise(self._trees.q, self._unit, out)


class ForestStepper:
    """Every group of one forest, stepped under one clock."""

    def __init__(self, tables: Sequence[Table], forest: Forest, clock: ForestClock) -> None:
        """The table of each group beside what was asked for."""
        ends = np.cumsum([group.count for group in forest.groups], dtype=np.int64)
        parts = np.split(forest.trees, ends)[:-1]
        self.clock = clock
        self._groups = [
            GroupStepper(table, part, forest.pose_easing, forest.method)
            for table, part in zip(tables, parts, strict=True)
        ]

    @property
    def shapes(self) -> list[Shape]:
        """(count, modes, quantum) of each group."""
        return [group.shape for group in self._groups]

    def step(self) -> None:
        """Follow the clock by one tick, under the wind at its end, as the page does it."""
        for group in self._groups:
            group.step(self.clock.field, self.clock.time_s, 1 / TICK_HZ)

    def write_poses(self, out: Sequence[Poses]) -> None:
        """(count, r) poses of each group."""
        for group, rows in zip(self._groups, out, strict=True):
            group.write_poses(rows)
