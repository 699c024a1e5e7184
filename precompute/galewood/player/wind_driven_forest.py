"""The trees of several tables in one wind field.

The wind is evaluated at all of them in one call, and trees of tables with few trees are stepped in one call,
too: hundreds of calls would take longer than what they compute.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from galewood.motion.modal import LANE_COUNT, advance_each, sizes_of, tensors_of_each, working_room
from galewood.motion.wind import TreePressure, WindField, crown_carried, crown_field, write_gusts_of_each
from galewood.player.modal_forest import MODAL_ARRAYS, ModalForest
from galewood.player.wind_driven import WindDrivenTrees
from galewood.util import Floats, joined_array

FEWEST_BATCHED = 32
"""Trees of a table from which a product of matrices for all of them takes less time than one step of each."""


class WindDrivenForest:
    """Groups of trees, each of one table, that are stepped together; only it may step them."""

    def __init__(self, groups: Sequence[WindDrivenTrees]) -> None:
        """Take over groups, whose arrays become views of those of the forest."""
        modal = [(one, one.forest) for one in groups if isinstance(one.forest, ModalForest)]
        self._others = [one for one in groups if not isinstance(one.forest, ModalForest)]
        self._pressure = TreePressure.joined([one.pressure for one, _ in modal]) if modal else None
        stacks: dict[object, list[tuple[WindDrivenTrees, int]]] = {}
        self._batched: list[WindDrivenTrees] = []
        first = 0
        for one, forest in modal:
            if 0 < len(one.q) < FEWEST_BATCHED:
                key = (*sizes_of(forest.modal), forest.dt_s)
                stacks.setdefault(key, []).append((one, first))
            elif len(one.q):
                self._batched.append(one)
            first += len(one.q)
        self._stacks = [_Stack(stacked) for stacked in stacks.values()]

    def step(self, field: WindField, time_s: float, dt_s: float) -> None:
        """Advance all trees by dt_s seconds in the wind at time_s, the end of the step."""
        for one in self._others:
            one.step(field, time_s, dt_s)
        if self._pressure is None:
            return
        self._pressure.advance(field, time_s)
        for one in self._batched:
            one.advance(field, time_s, dt_s)
        for stack in self._stacks:
            stack.advance(field, time_s, dt_s, self._pressure)


class _Stack:
    """The trees of tables whose models have the same sizes."""

    def __init__(self, groups: Sequence[tuple[WindDrivenTrees, int]]) -> None:
        """Take groups and their first trees in the pressure of the forest."""
        forests = [one.forest for one, _ in groups if isinstance(one.forest, ModalForest)]
        models = [one.modal for one in forests]
        counts = [len(one.q) for one in forests]
        self._trees = {name: joined_array(forests, name) for name in MODAL_ARRAYS}
        table = np.repeat(np.arange(len(models)), counts)
        self._period_s, self._tensors = forests[0].dt_s, tensors_of_each([models[k] for k in table])
        self._batch = working_room(models[0], LANE_COUNT, sizes_of(models[0])[-1])
        place_m = np.stack([one.place for one in models])
        exponent = np.array([one.streamlined_exponent for one in models])
        self._places = (place_m, exponent, table)
        self._gusts = np.zeros((len(table), 2 * place_m.shape[1]))
        self._at = np.concatenate([first + np.arange(len(one.q)) for one, first in groups])

    def advance(self, field: WindField, time_s: float, dt_s: float, pressure: TreePressure) -> None:
        """Advance all trees by dt_s seconds under the pressure at the trees of the forest."""
        trees = self._trees
        wind = (pressure.x_pa[self._at], pressure.z_pa[self._at])
        gusts = self._gusts_at(field, time_s, wind)
        state = tuple(trees[name] for name in ("_e", "_v", "_turned", "_now", "_before"))
        np.divide(dt_s / self._period_s, trees["_size"], out=trees["_rate"])
        advance_each(
            self._tensors, self._period_s / 2, self._batch, trees["_rate"], trees["_turn"],
            (*wind, gusts), trees["_phase"], (*state, trees["extrapolation_ratio"]), trees["q"],
        )  # fmt: skip

    def _gusts_at(self, field: WindField, time_s: float, pressure_pa: tuple[Floats, Floats]) -> Floats:
        """(n, 2G) relative gusts of ``write_gusts`` under the pressures at the trees (n,), Pa."""
        moment, trees = field.at(time_s), self._trees
        write_gusts_of_each(
            crown_field(moment.crown.seed), crown_carried(moment), self._places, (trees["x_m"], trees["z_m"]),
            trees["_turn"], trees["_size"], pressure_pa, self._gusts,
        )  # fmt: skip
        return self._gusts
