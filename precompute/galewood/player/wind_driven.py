"""Trees of one table in a wind field: computes the pressure at every tree and steps the chosen method."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from galewood.motion.wind import (
    Wind,
    WindField,
    compress_pressure,
    dynamic_pressure,
    height_factor,
    limit_pressure,
)
from galewood.options import Method
from galewood.player.modal_forest import ModalForest
from galewood.player.paper_search import PaperForest
from galewood.player.place_gusts import PlaceGusts
from galewood.table import Table
from galewood.util import Singles


def forest_of(
    table: Table, count: int, method: Method = "modal", pose_easing: float | None = None
) -> ModalForest | PaperForest:
    """Create ``count`` trees at rest; ``pose_easing`` (0..1, paper only) replaces the table's value."""
    if method == "modal":
        return ModalForest(table.modal, float(table.metadata["dt_s"]), table.mode_scale, count)
    return PaperForest(table, count, pose_easing=pose_easing)


class WindDrivenTrees:
    """Trees of one table at given places, driven by a wind field."""

    def __init__(
        self,
        table: Table,
        trees: npt.ArrayLike,
        method: Method = "modal",
        pose_easing: float | None = None,
    ) -> None:
        """Create trees at rest; ``trees`` (n, 4): x, z (m), yaw (rad), scale."""
        rows = np.asarray(trees, np.float32).reshape(-1, 4)
        count = len(rows)
        self._x_m, self._z_m = rows[:, 0].astype(np.float64), rows[:, 1].astype(np.float64)
        self._pressure_x, self._pressure_z = np.zeros(count), np.zeros(count)
        self._height_m = float(table.metadata["height_m"]) * rows[:, 3].astype(np.float64)
        self._most_pa, self._exponent = table.peak_pressure_pa, table.streamlined_exponent
        self._strength: tuple[float, ...] | None = None
        self._height_factor, self._peak_pa = np.ones(count), np.zeros(count)
        self._ratio = np.zeros(count)
        self._forest = forest_of(table, count, method, pose_easing)
        self._forest.set_trees(rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3])
        self._gusts = PlaceGusts(table.modal_place, table.streamlined_exponent, count)
        if isinstance(self._forest, ModalForest):
            self._most_pa = float(table.modal_limits[2])

    @property
    def q(self) -> Singles:
        """(n, r) modal coordinates q of the poses, m; the next step overwrites them."""
        return self._forest.q

    @property
    def extrapolation_ratio(self) -> Singles:
        """(n,) sway or pressure over the largest sampled value; always 1 for the paper's state search."""
        forest = self._forest
        if not isinstance(forest, ModalForest):
            return np.ones(len(self._x_m), np.float32)
        return np.maximum(forest.extrapolation_ratio, self._ratio).astype(np.float32)

    def displace(self, tree: int, e: npt.ArrayLike, v: npt.ArrayLike) -> bool:
        """Add to the oscillators of a tree (``ModalForest.displace``); False: the paper's trees have none."""
        if not isinstance(self._forest, ModalForest):
            return False
        self._forest.displace(tree, e, v)
        return True

    def step(self, field: WindField, time_s: float, dt_s: float) -> None:
        """Advance by dt_s seconds in the wind at time_s, the end of the step."""
        self._set_strength(field.at(time_s).wind)
        out = (self._pressure_x, self._pressure_z)
        field.pressure(self._x_m, self._z_m, time_s, *out, self._exponent, self._height_factor)
        if isinstance(self._forest, ModalForest):
            compress_pressure(*out, self._peak_pa, self._most_pa, self._ratio)
            gusts = self._gusts.at(field, time_s, self._forest.standing, *out)
            self._forest.advance(dt_s, *out, gusts)
        else:
            limit_pressure(*out, self._most_pa)
            self._forest.advance(dt_s, *out)

    def _set_strength(self, wind: Wind) -> None:
        """Update the height factors and the pressures of the strongest gusts if the wind has changed."""
        strength = (
            wind.height_exponent, wind.reference_height_m, wind.mean_speed_m_s, wind.gustiness,
        )  # fmt: skip
        if self._strength == strength:
            return
        self._strength = strength
        exponent, reference_height_m, mean_m_s, gustiness = strength
        self._height_factor = height_factor(self._height_m, exponent, reference_height_m)
        gust_m_s = mean_m_s * (1.0 + gustiness) * self._height_factor
        self._peak_pa = dynamic_pressure(gust_m_s, self._exponent)
