"""The gust layer of many trees: motion under gusts that differ within each crown."""

from __future__ import annotations

import numpy as np

from galewood.motion.modal import GustTensors, advance_gusts
from galewood.motion.wind import WindField, crown_carried, crown_field, write_gusts
from galewood.player.instances import Stepping
from galewood.util import Floats, Singles


class GustLayer:
    """State of the gust layer's oscillators of the trees of one table."""

    def __init__(self, tensors: GustTensors, count: int) -> None:
        """Create ``count`` trees at rest."""
        named = (tensors.place, tensors.step, tensors.load, tensors.drag)
        self._place, *float64_tensors = (np.ascontiguousarray(tensor, np.float64) for tensor in named)
        self._exponent = tensors.streamlined_exponent
        self._tensors = (*float64_tensors, self._exponent)
        self._gusts = np.zeros((count, 2 * len(self._place)))
        self._state = tuple(np.zeros((count, tensors.oscillators)) for _ in range(4))

    def advance(
        self,
        field: WindField,
        time_s: float,
        trees: Stepping,
        pressure_x: Floats,
        pressure_z: Floats,
        q: Singles,
    ) -> None:
        """Advance by one frame that ends at time_s; before the modal model, whose phase it shares.

        The pressures (count,), Pa, are those at the trees. Writes the output modes q (count, L), m.
        """
        if q.shape[1]:
            self.advance_under(
                self.gusts_at(field, time_s, trees, pressure_x, pressure_z), trees, pressure_x, pressure_z, q
            )

    def gusts_at(
        self, field: WindField, time_s: float, trees: Stepping, pressure_x: Floats, pressure_z: Floats
    ) -> Floats:
        """(count, 2G) pressures, Pa, at the places of each tree in addition to that at the tree.

        The next call overwrites them.
        """
        moment = field.at(time_s)
        write_gusts(
            crown_field(moment.crown.seed), crown_carried(moment), self._place, (trees.x_m, trees.z_m),
            trees.turn, trees.size, (pressure_x, pressure_z), self._exponent, self._gusts,
        )  # fmt: skip
        return self._gusts

    def advance_under(
        self, gusts: Floats, trees: Stepping, pressure_x: Floats, pressure_z: Floats, q: Singles
    ) -> None:
        """Advance by one frame under given pressures of ``gusts_at``."""
        pressure = (pressure_x, pressure_z)
        advance_gusts(self._tensors, trees.rate, trees.turn, trees.phase, pressure, gusts, self._state, q)
