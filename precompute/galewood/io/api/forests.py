"""A forest of trees that play motion tables."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np
import numpy.typing as npt

from galewood.io.api.expected import expect
from galewood.io.api.tables import MotionTable
from galewood.motion.wind import Wind, WindField
from galewood.options import METHOD_NAMES, Method
from galewood.player import WindDrivenForest, WindDrivenTrees, grid_placements, record_points
from galewood.solid.skinning import drawn_positions, joint_rows
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Placements:
    """Where n trees stand, how each is turned and scaled, and which table it plays."""

    x_m: Floats
    """(n,)"""
    z_m: Floats
    """(n,)"""
    yaw_rad: Floats
    """(n,) rotation about the vertical axis."""
    scale: Floats
    """(n,) size over that of the table's tree; a larger tree sways more slowly."""
    table: Ints
    """(n,) index into the forest's tables."""

    def __post_init__(self) -> None:
        count = len(self.x_m)
        if any(len(one) != count for one in (self.z_m, self.yaw_rad, self.scale, self.table)):
            raise ValueError("the arrays of a Placements must have the same length")
        numbers = np.concatenate([self.x_m, self.z_m, self.yaw_rad, self.scale]).astype(np.float64)
        if not np.isfinite(numbers).all():
            raise ValueError("places, yaw and scale of a Placements must be finite numbers")
        if count and float(np.min(self.scale)) <= 0.0:
            raise ValueError("the scale of a tree must be above 0")

    def __len__(self) -> int:
        return len(self.x_m)


def grid(count: int, *, tables: int = 1, seed: int = 0) -> Placements:
    """Trees on a jittered grid, 10 m apart, turned and scaled (0.8 to 1.2) at random; tables in turn."""
    x_m, z_m, yaw_rad, scale = grid_placements(count, seed)
    return Placements(x_m, z_m, yaw_rad, scale, np.arange(count) % tables)


@dataclass(frozen=True)
class PointMotion:
    """T samples of the motion of a point of each of n trees, as it is shown, along the world's axes."""

    time_s: Floats
    """(T,)"""
    displacement_m: Floats
    """(T, n, 3) from the place at rest, at the size at which the tree stands."""
    velocity_m_s: Floats
    """(T, n, 3)"""
    acceleration_m_s2: Floats
    """(T, n, 3)"""
    wind_m_s: Floats
    """(T, n, 2) velocity of the wind at the top of each tree, along x and z."""
    pressure_pa: Floats
    """(T, n, 2) dynamic pressure on each tree, along x and z; compressed beyond the range of its table."""


class Forest:
    """Trees that move in a common wind, each with a state of its own."""

    def __init__(
        self,
        tables: Sequence[MotionTable],
        placements: Placements | npt.ArrayLike,
        wind: Wind,
        *,
        method: Method = "modal",
    ) -> None:
        """All trees are at rest at first.

        Args:
            tables: The motion tables.
            placements: Where the trees stand (``galewood.grid`` makes such), or an array (n, 2 to 4) of x m,
                z m, yaw rad and scale, whose rows play the tables in turn.
            wind: The wind; ``forest.wind`` changes it.
            method: "modal" (the modal reduced-order model) or "paper" (the paper's state search).

        Raises:
            TypeError: Tables or wind are something else.
            ValueError: There is no table, a placement names one that is not there, or the method is unknown.
        """
        if not isinstance(tables, str) and not tables:
            raise ValueError("a forest needs at least one table")
        if isinstance(tables, str | MotionTable):
            expect("tables", tables, MotionTable)
            raise TypeError("tables must be a list of tables: [table]")
        for index, one in enumerate(tables):
            expect(f"tables[{index}]", one, MotionTable)
        expect("wind", wind, Wind)
        if method not in METHOD_NAMES:
            raise ValueError(f"method must be one of {', '.join(METHOD_NAMES)}, not {method!r:.40}")
        if not isinstance(placements, Placements):
            placements = _placements_of(placements, len(tables))
        if len(placements) and not 0 <= int(placements.table.min()) <= int(placements.table.max()) < len(
            tables
        ):
            raise ValueError(f"placements.table must lie between 0 and {len(tables) - 1}")
        self.tables, self.placements, self.time_s = list(tables), placements, 0.0
        self._field = WindField(wind)
        rows = np.column_stack([placements.x_m, placements.z_m, placements.yaw_rad, placements.scale])
        self._members = [np.flatnonzero(placements.table == k) for k in range(len(tables))]
        self._groups = [
            WindDrivenTrees(one.table, rows[members], method)
            for one, members in zip(self.tables, self._members, strict=True)
        ]
        self._together = WindDrivenForest(self._groups)
        self._place = np.zeros(len(placements), np.int64)
        for members in self._members:
            self._place[members] = np.arange(len(members))

    @property
    def wind(self) -> Wind:
        """The wind now. Setting another one changes over to it smoothly, from the present time on."""
        return self._field.at(self.time_s).wind

    @wind.setter
    def wind(self, wind: Wind) -> None:
        expect("wind", wind, Wind)
        self._field.change(wind, self.time_s)

    def step(self, dt_s: float) -> None:
        """Advance all trees by dt_s seconds. ValueError if that is no finite time above 0."""
        if not (isinstance(dt_s, Real) and 0.0 < float(dt_s) < math.inf):
            raise ValueError(f"dt_s must be a time above 0 s, not {dt_s!r:.40}")
        self.time_s += dt_s
        self._together.step(self._field, self.time_s, dt_s)

    def record(self, duration_s: float, *, rate_hz: float = 30.0, vertex: int | None = None) -> PointMotion:
        """Advance all trees and return the motion of a point of each as arrays.

        Args:
            duration_s: How long to record; the forest is at the time of the last sample afterwards.
            rate_hz: Samples per second, 1 to 1000.
            vertex: The place that holds this render vertex, in every table; by default the highest node.

        Returns:
            Displacement, velocity and acceleration (T, n, 3), wind and pressure (T, n, 2); the first sample
            is that of the present pose.

        Raises:
            ValueError: A time, a rate or a vertex is out of range, or the forest has no trees.
        """
        if not (isinstance(rate_hz, Real) and 1.0 <= float(rate_hz) <= 1000.0):
            raise ValueError(f"rate_hz must be 1 to 1000 per second, not {rate_hz!r:.40}")
        if not (isinstance(duration_s, Real) and 1.0 / rate_hz <= float(duration_s) < math.inf):
            raise ValueError(f"duration_s must be at least one sample, 1 / rate_hz, not {duration_s!r:.40}")
        used = [k for k, members in enumerate(self._members) if len(members)]
        if not used:
            raise ValueError("the forest has no trees")
        rows = [_point_rows(self.tables[k], vertex) for k in used]
        time_s = self.time_s + np.arange(math.floor(duration_s * rate_hz + 1e-9) + 1) / rate_hz
        tracks = record_points(
            [self._groups[k] for k in used], rows, self._field, time_s, self._together.step
        )
        self.time_s = float(time_s[-1])
        count = len(self.placements)
        moved, blown = np.zeros((3, len(time_s), count, 3)), np.zeros((2, len(time_s), count, 2))
        for k, of_group in zip(used, tracks, strict=True):
            moved[:, :, self._members[k]], blown[:, :, self._members[k]] = of_group.moved, of_group.blown
        at = self.placements
        turned = np.einsum("nij,ktnj->ktni", _turns(at.yaw_rad) * at.scale[:, None, None], moved)
        return PointMotion(time_s, *turned, *blown)

    def modal_coordinates(self, tree: int) -> Floats:
        """(r,) modal coordinates of a tree, m: its displacement is Σ basis_k q_k."""
        group = self._groups[int(self.placements.table[tree])]
        return group.q[self._place[tree]].astype(np.float64)

    def displacement_m(self, tree: int) -> Floats:
        """(v, 3) displacement of the places that hold the render vertices of a tree, m.

        In the table's own frame and size. ``vertices_m`` also turns the vertices about these places.
        """
        table = self.tables[int(self.placements.table[tree])].table
        joints = joint_rows(table, table.node_basis) @ self.modal_coordinates(tree)
        return joints[table.vertex_joint.astype(np.int64)]

    def vertices_m(self, tree: int) -> Floats:
        """(v, 3) bent render vertices of a tree where it stands, m. ValueError if the table has no mesh."""
        at = self.placements
        one = self.tables[int(at.table[tree])]
        bent = drawn_positions(one.table, one.rest_vertices_m, self.modal_coordinates(tree))
        return _placed(bent, at.x_m[tree], at.z_m[tree], at.yaw_rad[tree], at.scale[tree])


def _placements_of(rows: npt.ArrayLike, tables: int) -> Placements:
    """Placements from x m, z m and optionally yaw rad and scale per tree. Raises ValueError."""
    given = np.asarray(rows, np.float64)
    if given.ndim != 2 or not 2 <= given.shape[1] <= 4:
        raise ValueError("placements must have 2 to 4 columns: x m, z m, yaw rad, scale")
    count = len(given)
    yaw_rad = given[:, 2] if given.shape[1] > 2 else np.zeros(count)
    scale = given[:, 3] if given.shape[1] > 3 else np.ones(count)
    return Placements(given[:, 0], given[:, 1], yaw_rad, scale, np.arange(count) % tables)


def _point_rows(one: MotionTable, vertex: int | None) -> Floats:
    """(3, r) displacement of the highest node, or of what holds a render vertex, per modal coordinate."""
    table = one.table
    if vertex is None:
        return table.node_basis[int(np.argmax(table.node_rest_m[:, 1]))].astype(np.float64)
    count = len(table.vertex_joint)
    if not 0 <= vertex < count:
        raise ValueError(f"vertex must lie between 0 and {count - 1} for the table of {one.name}")
    return joint_rows(table, table.node_basis)[int(table.vertex_joint[vertex])].astype(np.float64)


def _turns(yaw_rad: Floats) -> Floats:
    """(n, 3, 3) rotations about the vertical, from the frame of a tree to the world."""
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    zero, one = np.zeros_like(cos), np.ones_like(cos)
    return np.array([[cos, zero, sin], [zero, one, zero], [-sin, zero, cos]]).transpose(2, 0, 1)


def _placed(vertices_m: Floats, x_m: float, z_m: float, yaw_rad: float, scale: float) -> Floats:
    """Vertices scaled, turned about y and moved, as the viewer draws them."""
    return scale * vertices_m @ _turns(np.array([yaw_rad]))[0].T + np.array([x_m, 0.0, z_m])
