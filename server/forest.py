"""A client's forest on the server: wind, lookup and time for every tree of every group."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from precompute.lookup import ForestLookup
from precompute.table import Table
from precompute.tangent import TangentForest
from precompute.wind import (
    Wind,
    WindField,
    WindState,
    change_wind,
    height_factor,
    limit_pressure,
    sampled_peak_pa,
)
from server.wire import TICK_HZ, Group, Method, Poses

Trees = npt.NDArray[np.float32]


class GroupWalk:
    """Trees that share a table: where they stand and where in the table each is."""

    def __init__(self, table: Table, trees: Trees, pose_easing: float | None, method: Method) -> None:
        """trees (n, 4): x m, z m, yaw rad, scale."""
        count = len(trees)
        self._x_m, self._z_m = trees[:, 0].astype(np.float64), trees[:, 1].astype(np.float64)
        self._pressure_x, self._pressure_z = np.zeros(count, np.float32), np.zeros(count, np.float32)
        self._height_m = float(table.metadata["height_m"]) * trees[:, 3].astype(np.float64)
        self._sampled_peak_pa = sampled_peak_pa(table.pressure_pa)
        self._profile: tuple[float, float] | None = None
        self._height_factor = np.ones(count)
        self._lookup = _lookup(table, count, pose_easing, method)
        self._lookup.set_trees(trees[:, 0], trees[:, 1], trees[:, 2], trees[:, 3])

    def step(self, field: WindField, time_s: float, dt_s: float) -> None:
        """Let dt_s pass, up to time_s, under the wind of that moment."""
        wind = field.at(time_s).wind
        self._set_profile(wind.height_exponent, wind.reference_height_m)
        out = (self._pressure_x, self._pressure_z)
        field.pressure(self._x_m, self._z_m, time_s, *out, self._height_factor)
        limit_pressure(*out, self._sampled_peak_pa)
        self._lookup.advance(dt_s, self._pressure_x, self._pressure_z)

    def _set_profile(self, exponent: float, reference_height_m: float) -> None:
        """Taller trees reach into faster air."""
        if self._profile != (exponent, reference_height_m):
            self._profile = (exponent, reference_height_m)
            self._height_factor = height_factor(self._height_m, exponent, reference_height_m)

    def poses(self) -> Poses:
        """(n, r) poses in units of the table's modes.scale."""
        return self._lookup.poses()


def _lookup(
    table: Table, count: int, pose_easing: float | None, method: Method
) -> ForestLookup | TangentForest:
    if method == "tangent":
        return TangentForest(table.tangent, float(table.metadata["dt_s"]), table.mode_scale, count)
    return ForestLookup(table, count, pose_easing=pose_easing)


class ForestWalk:
    """Every group of one client under one wind and one clock, which ticks TICK_HZ times a second."""

    def __init__(
        self, tables: Sequence[Table], groups: Sequence[Group], trees: Trees,
        wind: Wind | WindState, *, start_s: float, pose_easing: float | None, method: Method = "tangent",
    ) -> None:  # fmt: skip
        """trees (Σ count, 4) in the order of the groups, whose tables are given beside them."""
        ends = np.cumsum([group.count for group in groups])[:-1]
        parts = np.split(trees, ends)
        self._groups = [
            GroupWalk(table, part, pose_easing, method) for table, part in zip(tables, parts, strict=True)
        ]
        self._start_s = start_s
        self._ticks = 0
        self._field = WindField(wind)
        self._next = self._field.state

    @property
    def time_s(self) -> float:
        """The forest's own time: that of the poses as they are now."""
        return self._start_s + self._ticks / TICK_HZ

    def change_wind(self, wind: Wind) -> WindState:
        """Glide to another wind from the next tick on; may be called while a tick is computed elsewhere.

        The state is what the client needs to show the same wind. It begins at the end of the tick that may be
        under way, which therefore sees the old wind whichever state it takes.
        """
        self._next = change_wind(self._next, wind, self.time_s + 1 / TICK_HZ)
        return self._next

    def step(self) -> None:
        """One tick under the wind at its end, as the page does it."""
        self._field.state = self._next
        self._ticks += 1
        for group in self._groups:
            group.step(self._field, self.time_s, 1 / TICK_HZ)

    def poses(self) -> tuple[Poses, ...]:
        """(count, r) poses of each group."""
        return tuple(group.poses() for group in self._groups)
