"""Gusts at the places of the crowns of many trees, which drive the modal model beside the pressure."""

from __future__ import annotations

import numpy as np

from galewood.motion.wind import WindField, crown_carried, crown_field, write_gusts
from galewood.player.instances import Standing
from galewood.util import Floats, Singles


class PlaceGusts:
    """Computes the gusts at the places (G, 3), m, of ``count`` trees of one table.

    ``exponent`` is the streamlined one of the table.
    """

    def __init__(self, place_m: Singles, exponent: float, count: int) -> None:
        self._exponent = exponent
        self._place_m = np.ascontiguousarray(place_m, np.float64)
        self._gusts = np.zeros((count, 2 * len(self._place_m)))

    def at(
        self, field: WindField, time_s: float, trees: Standing, pressure_x: Floats, pressure_z: Floats
    ) -> Floats:
        """(count, 2G) relative gusts of ``write_gusts`` under the pressures at the trees (count,), Pa.

        The next call overwrites them.
        """
        moment = field.at(time_s)
        write_gusts(
            crown_field(moment.crown.seed), crown_carried(moment), self._place_m, (trees.x_m, trees.z_m),
            trees.turn, trees.size, (pressure_x, pressure_z), self._exponent, self._gusts,
        )  # fmt: skip
        return self._gusts
