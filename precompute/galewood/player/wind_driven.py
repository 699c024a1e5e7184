"""Trees of one table in a wind field: computes the pressure at every tree and steps the chosen method."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from galewood.motion.wind import TreePressure, WindField
from galewood.options import Method
from galewood.player.modal_forest import ModalForest
from galewood.player.paper_search import PaperForest
from galewood.player.place_gusts import PlaceGusts
from galewood.table import Table
from galewood.util import Floats, Singles


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
        self.forest = forest_of(table, count, method, pose_easing)
        self.forest.set_trees(rows[:, 0], rows[:, 1], rows[:, 2], rows[:, 3])
        self.gusts = PlaceGusts(table.modal_place, table.streamlined_exponent, count)
        height_m = float(table.metadata["height_m"]) * rows[:, 3].astype(np.float64)
        modal = isinstance(self.forest, ModalForest)
        most_pa = float(table.modal_limits[2]) if modal else table.peak_pressure_pa
        self._most_pa = most_pa
        self.pressure = TreePressure(
            rows[:, 0], rows[:, 1], height_m, most_pa, table.streamlined_exponent, limited=not modal
        )

    @property
    def most_pa(self) -> float:
        """Strongest pressure of the table, Pa: stronger winds are compressed, or clamped (paper)."""
        return self._most_pa

    @property
    def q(self) -> Singles:
        """(n, r) modal coordinates q of the poses, m; the next step overwrites them."""
        return self.forest.q

    @property
    def steps(self) -> tuple[Floats, Floats, Floats]:
        """Poses (n, r) before and after the last step of each tree, and the share (n,) that is shown."""
        return self.forest.steps

    @property
    def period_s(self) -> Floats:
        """(n,) time of a step of each tree, s."""
        return self.forest.period_s

    @property
    def pressure_pa(self) -> Floats:
        """(n, 2) pressure on each tree along world x and z, in the last step."""
        return np.column_stack([self.pressure.x_pa, self.pressure.z_pa])

    def wind_m_s(self, field: WindField, time_s: float) -> Floats:
        """(n, 2) velocity of the wind at the top of each tree along world x and z."""
        return self.pressure.wind_m_s(field, time_s)

    @property
    def extrapolation_ratio(self) -> Singles:
        """(n,) sway or pressure over the largest sampled value; always 1 for the paper's state search."""
        forest = self.forest
        if not isinstance(forest, ModalForest):
            return np.ones(len(self.pressure.ratio), np.float32)
        return np.maximum(forest.extrapolation_ratio, self.pressure.ratio).astype(np.float32)

    def displace(self, tree: int, e: npt.ArrayLike, v: npt.ArrayLike) -> bool:
        """Add to the oscillators of a tree (``ModalForest.displace``); False: the paper's trees have none."""
        if not isinstance(self.forest, ModalForest):
            return False
        self.forest.displace(tree, e, v)
        return True

    def step(self, field: WindField, time_s: float, dt_s: float) -> None:
        """Advance by dt_s seconds in the wind at time_s, the end of the step."""
        self.pressure.advance(field, time_s)
        self.advance(field, time_s, dt_s)

    def advance(self, field: WindField, time_s: float, dt_s: float) -> None:
        """Advance by dt_s seconds under the pressure that was evaluated last, which is that at time_s."""
        pressure_pa = (self.pressure.x_pa, self.pressure.z_pa)
        if isinstance(self.forest, ModalForest):
            gusts = self.gusts.at(field, time_s, self.forest.standing, *pressure_pa)
            self.forest.advance(dt_s, *pressure_pa, gusts)
        else:
            self.forest.advance(dt_s, *pressure_pa)
